#!/usr/bin/env python3
"""Ray over several nodes: a seed gives the same samples, whatever runner plays it.

    pip install ./crates/gym-python "ray[rllib]" torch    # on each node
    python ray_nodes.py                       # two nodes on this machine
    python ray_nodes.py --address auto        # the nodes of a cluster that runs

Plays the same seeds with one, two and four runners and in the processes of Gymnasium's `AsyncVectorEnv`, compares all of it,
and then trains with RLlib's runners on the nodes. Each runner imports rustgym, so it is installed where a runner may start.
"""

import argparse
import hashlib
import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import gymnasium
import numpy as np
import ray
from ray.cluster_utils import Cluster
from ray.rllib.algorithms.ppo import PPOConfig
from ray.tune.registry import register_env

ENV = "CartPole-v1"
SEEDS = list(range(100, 116))
STEPS = 300

parser = argparse.ArgumentParser()
parser.add_argument("--address", help="of a cluster that runs; without it two nodes are started here")
parser.add_argument("--iterations", type=int, default=3)
arguments = parser.parse_args()


def play(envs, seeds):
    """A digest of each seed's samples, under a policy that depends only on the observation."""
    digests = [hashlib.sha256() for _ in seeds]
    observations, _ = envs.reset(seed=seeds)
    for _ in range(STEPS):
        actions = (observations[:, 2] + 0.5 * observations[:, 3] > 0).astype(np.int64)
        observations, rewards, terminated, truncated, _ = envs.step(actions)
        for i, digest in enumerate(digests):
            digest.update(observations[i].tobytes() + rewards[i].tobytes() + terminated[i].tobytes() + truncated[i].tobytes())
    envs.close()
    return {seed: digest.hexdigest() for seed, digest in zip(seeds, digests, strict=True)}


@ray.remote(num_cpus=1, scheduling_strategy="SPREAD")
class Runner:
    """Plays seeds on the node that Ray chooses."""

    def play(self, seeds):
        """The digest of each seed, the node that played it, and the seconds."""
        import rustgym

        envs = rustgym.make_vec(ENV, num_envs=len(seeds))
        start = time.perf_counter()
        return play(envs, seeds), ray.get_runtime_context().get_node_id(), time.perf_counter() - start


def sample(count):
    """The digest of each seed, where `count` runners share the seeds, the number of nodes, and the samples per second."""
    runners = [Runner.remote() for _ in range(count)]
    shares = [SEEDS[i::count] for i in range(count)]
    answers = ray.get([runner.play.remote(share) for runner, share in zip(runners, shares, strict=True)])
    for runner in runners:
        ray.kill(runner)
    digests = {seed: digest for share, _, _ in answers for seed, digest in share.items()}
    return digests, len({node for _, node, _ in answers}), len(SEEDS) * STEPS / max(seconds for _, _, seconds in answers)


def make(config=None):
    """One environment; the import happens in the process that makes the environment."""
    import rustgym

    return rustgym.make(ENV)


def train():
    """Trains with two of RLlib's runners, and tells on how many nodes they are."""
    register_env("pole", make)
    config = (
        PPOConfig()
        .environment("pole")
        .env_runners(num_env_runners=2, num_envs_per_env_runner=4)
        .training(train_batch_size_per_learner=1000, minibatch_size=250, num_epochs=4, lr=2e-3)
        .debugging(seed=0)
    )
    algorithm = config.build_algo()
    nodes = algorithm.env_runner_group.foreach_env_runner(
        lambda _: ray.get_runtime_context().get_node_id(), local_env_runner=False
    )
    print(f"RLlib's runners are on {len(set(nodes))} nodes")
    for iteration in range(arguments.iterations):
        result = algorithm.train()
        print(f"iteration {iteration + 1}: return {result['env_runners'].get('episode_return_mean', float('nan')):.1f}")
    algorithm.stop()


if __name__ == "__main__":
    cluster = None
    if arguments.address is None:
        node = {"num_cpus": 2, "include_dashboard": False}
        cluster = Cluster(initialize_head=True, head_node_args=node)
        cluster.add_node(num_cpus=2)
        arguments.address = cluster.address
    ray.init(address=arguments.address)

    processes = play(gymnasium.vector.AsyncVectorEnv([make] * len(SEEDS)), SEEDS)
    for count in (1, 2, 4):
        digests, nodes, rate = sample(count)
        assert digests == processes, "a seed gave other samples"
        print(f"{count} runners on {nodes} nodes: {rate:.0f} samples per second, of each seed those of Gymnasium's processes")
    train()
    ray.shutdown()
    if cluster is not None:
        cluster.shutdown()
