#!/usr/bin/env python3
"""Ray RLlib: PPO learns to balance a pole, with environments in processes of their own.

    pip install ./crates/gym-python "ray[rllib]" torch
    python rllib_ppo.py [--way name|creator|vector] [--iterations 5]

Ray's workers start without what the main program has registered. Each way of naming the environment therefore imports
rustgym in the worker.
"""

import argparse
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import gymnasium
import ray
from ray.rllib.algorithms.ppo import PPOConfig
from ray.tune.registry import register_env

parser = argparse.ArgumentParser()
parser.add_argument("--way", choices=["name", "creator", "vector"], default="vector")
parser.add_argument("--iterations", type=int, default=5)
arguments = parser.parse_args()


def one(config):
    """One environment; the import happens in the worker process."""
    import rustgym

    return rustgym.make("CartPole-v1")


def many(config):
    """A whole vector, stepped in Rust."""
    import rustgym

    return rustgym.make_vec("CartPole-v1", config["num_envs"], vectorization_mode="vector_entry_point")


register_env("one", one)
register_env("many", many)
name = {"name": "rustgym:rustgym/CartPole-v1", "creator": "one", "vector": "many"}[arguments.way]
mode = gymnasium.VectorizeMode.VECTOR_ENTRY_POINT if arguments.way == "vector" else gymnasium.VectorizeMode.SYNC

ray.init(num_cpus=3, include_dashboard=False)
config = (
    PPOConfig()
    .environment(name)
    .env_runners(num_env_runners=2, num_envs_per_env_runner=4, gym_env_vectorize_mode=mode)
    .training(train_batch_size_per_learner=2000, minibatch_size=250, num_epochs=6, lr=2e-3)
    .debugging(seed=0)
)
algorithm = config.build_algo()
for iteration in range(arguments.iterations):
    result = algorithm.train()
    print(f"iteration {iteration + 1}: return {result['env_runners'].get('episode_return_mean', float('nan')):.1f}")
algorithm.stop()
ray.shutdown()
