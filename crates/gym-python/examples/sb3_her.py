#!/usr/bin/env python3
"""Stable-Baselines3: SAC with hindsight replay learns to reach goals, with a ball in a maze or with an arm.

    pip install ./crates/gym-python stable-baselines3
    python sb3_her.py [--seconds 600]
    python sb3_her.py --env FetchReach-v4               # the arm's models are in gymnasium-robotics==1.4.2, which is installed
    python sb3_her.py --package gymnasium_robotics      # the same on the package's own environment

An episode is a success if the goal is reached in any of its steps. Stops at the time, or at a success rate of 0.9 in the last
50 episodes; then plays 100 others without noise.
"""

import argparse
import time
from collections import deque
from importlib import import_module
from types import SimpleNamespace

import gymnasium
import numpy as np
import torch
from stable_baselines3 import SAC, HerReplayBuffer
from stable_baselines3.common.callbacks import BaseCallback

parser = argparse.ArgumentParser()
parser.add_argument("--env", default="PointMaze_UMaze-v3")
parser.add_argument("--package", choices=["rustgym", "gymnasium_robotics"], default="rustgym")
parser.add_argument("--seconds", type=float, default=600.0)
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--episodes", type=int, default=100, help="that are played in the end")
arguments = parser.parse_args()

torch.set_num_threads(1)


def make():
    package = import_module(arguments.package)
    if arguments.package == "rustgym":
        return package.make(arguments.env)
    mend()
    gymnasium.register_envs(package)
    return gymnasium.make(arguments.env)


def mend():
    """Gives Gymnasium-Robotics numbers in place of MuJoCo's enumerations, which later releases compare with nothing else."""
    import mujoco
    from gymnasium_robotics.utils import mujoco_utils

    names = {name: getattr(mujoco, name) for name in dir(mujoco) if not name.startswith("__")}
    for name in ["mjtJoint", "mjtObj", "mjtEq", "mjtTrn"]:
        names[name] = SimpleNamespace(**{key: int(value) for key, value in names[name].__members__.items()})
    mujoco_utils.mujoco = SimpleNamespace(**names)


def succeeds(info):
    return bool(info.get("is_success", info.get("success")))


class Watch(BaseCallback):
    """Counts successes and seconds, and ends the training."""

    def __init__(self):
        super().__init__()
        self.recent, self.episodes, self.reached = deque(maxlen=50), 0, False
        self.start = time.perf_counter()

    def _on_step(self):
        self.reached |= succeeds(self.locals["infos"][0])
        if self.locals["dones"][0]:
            self.recent.append(self.reached)
            self.episodes, self.reached = self.episodes + 1, False
            if self.episodes % 20 == 0 or self.is_over():
                print(f"{time.perf_counter() - self.start:5.0f} s, {self.num_timesteps} steps: success rate {np.mean(self.recent):.2f}", flush=True)
        return not self.is_over()

    def is_over(self):
        has_learned = len(self.recent) == 50 and np.mean(self.recent) >= 0.9
        return has_learned or time.perf_counter() - self.start > arguments.seconds


env = make()
model = SAC(
    "MultiInputPolicy",
    env,
    replay_buffer_class=HerReplayBuffer,
    replay_buffer_kwargs={"n_sampled_goal": 4, "goal_selection_strategy": "future"},
    learning_starts=1_000,
    learning_rate=1e-3,
    gamma=0.98,
    batch_size=256,
    train_freq=8,
    gradient_steps=4,
    policy_kwargs={"net_arch": [64, 64]},
    seed=arguments.seed,
    device="cpu",
)
model.learn(10_000_000, callback=Watch())

reached = []
for episode in range(arguments.episodes):
    observation, info = env.reset(seed=10_000 + episode)
    done = success = False
    while not done:
        action, _ = model.predict(observation, deterministic=True)
        observation, _, terminated, truncated, info = env.step(action)
        success |= succeeds(info)
        done = terminated or truncated or success
    reached.append(success)
print(f"{arguments.package}: success rate {np.mean(reached):.2f} in {arguments.episodes} episodes, after {model.num_timesteps} steps")
