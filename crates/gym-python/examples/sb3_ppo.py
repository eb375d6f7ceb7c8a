#!/usr/bin/env python3
"""Stable-Baselines3: PPO learns to balance a pole, on a vector of this package.

    pip install ./crates/gym-python stable-baselines3
    python sb3_ppo.py [--steps 100000]
"""

import argparse

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

import rustgym.sb3

parser = argparse.ArgumentParser()
parser.add_argument("--steps", type=int, default=100_000)
steps = parser.parse_args().steps

torch.set_num_threads(1)  # one thread is faster for such a small network
# steps all eight in Rust; `make_vec_env("rustgym:rustgym/CartPole-v1", 8)` works as well, and steps them in Python
envs = VecMonitor(rustgym.sb3.VecEnv("CartPole-v1", num_envs=8))
model = PPO(
    "MlpPolicy",
    envs,
    n_steps=32,
    batch_size=256,
    n_epochs=20,
    gae_lambda=0.8,
    gamma=0.98,
    learning_rate=lambda left: left * 1e-3,
    clip_range=lambda left: left * 0.2,
    seed=0,
    device="cpu",
)
model.learn(steps)
mean, deviation = evaluate_policy(model, VecMonitor(rustgym.sb3.VecEnv("CartPole-v1")), n_eval_episodes=20)
print(f"return of 20 episodes after {steps} steps: {mean:.1f} ± {deviation:.1f}")
