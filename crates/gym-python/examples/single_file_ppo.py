#!/usr/bin/env python3
"""PPO in a single file, in the manner of CleanRL: the whole learner is on this page, on a vector of this package.

    pip install ./crates/gym-python torch
    python single_file_ppo.py [--env CartPole-v1] [--steps 150000]

A step after the end of an episode starts the next one and ignores its action (autoreset "NextStep"); such steps are left
out of the loss.
"""

import argparse
import time

import gymnasium
import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical

import rustgym

parser = argparse.ArgumentParser()
parser.add_argument("--env", default="CartPole-v1")
parser.add_argument("--steps", type=int, default=150_000)
parser.add_argument("--num-envs", type=int, default=8)
parser.add_argument("--seed", type=int, default=0)
args = parser.parse_args()

ROLLOUT, EPOCHS, MINIBATCHES = 64, 8, 4
GAMMA, LAMBDA, CLIP, LEARNING_RATE = 0.98, 0.9, 0.2, 1e-3

torch.set_num_threads(1)
torch.manual_seed(args.seed)
envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(rustgym.make_vec(args.env, args.num_envs))
assert isinstance(envs.single_action_space, gymnasium.spaces.Discrete), "this learner has a few actions to choose from"
inputs, choices = envs.single_observation_space.shape[0], int(envs.single_action_space.n)


def network(outputs, scale):
    last = nn.Linear(64, outputs)
    nn.init.orthogonal_(last.weight, scale)
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), last)


actor, critic = network(choices, 0.01), network(1, 1.0)
optimizer = torch.optim.Adam([*actor.parameters(), *critic.parameters()], lr=LEARNING_RATE, eps=1e-5)

shape = (ROLLOUT, args.num_envs)
observations = torch.zeros((*shape, inputs))
actions, log_probs, rewards, values = (torch.zeros(shape) for _ in range(4))
ended, terminals = torch.zeros(shape), torch.zeros(shape)

observation, _ = envs.reset(seed=args.seed)
done = np.zeros(args.num_envs, bool)
updates = args.steps // (ROLLOUT * args.num_envs)
returns, in_envs, start = [], 0.0, time.perf_counter()

for update in range(updates):
    optimizer.param_groups[0]["lr"] = LEARNING_RATE * (1 - update / updates)
    for t in range(ROLLOUT):
        observations[t] = torch.from_numpy(observation)
        ended[t] = torch.from_numpy(done)  # the next step of this environment only starts an episode
        with torch.no_grad():
            policy = Categorical(logits=actor(observations[t]))
            action = policy.sample()
            log_probs[t], values[t], actions[t] = policy.log_prob(action), critic(observations[t])[:, 0], action
        before = time.perf_counter()
        observation, reward, terminated, truncated, infos = envs.step(action.numpy())
        in_envs += time.perf_counter() - before
        rewards[t], terminals[t] = torch.from_numpy(reward), torch.from_numpy(terminated)
        done = terminated | truncated
        if "episode" in infos:
            returns += infos["episode"]["r"][infos["_episode"]].tolist()

    # generalised advantage estimation: the last state of an episode has a value only if the episode was truncated
    with torch.no_grad():
        advantages, advantage = torch.zeros(shape), torch.zeros(args.num_envs)
        for t in reversed(range(ROLLOUT)):
            last = t == ROLLOUT - 1
            following = critic(torch.from_numpy(observation))[:, 0] if last else values[t + 1]
            goes_on = 1 - (torch.from_numpy(done).float() if last else ended[t + 1])
            delta = rewards[t] + GAMMA * following * (1 - terminals[t]) - values[t]
            advantage = delta + GAMMA * LAMBDA * goes_on * advantage
            advantages[t] = advantage
    targets = advantages + values

    flat = torch.nonzero(ended.flatten() == 0)[:, 0]
    x, a, old = observations.flatten(0, 1), actions.flatten(), log_probs.flatten()
    adv, target = advantages.flatten(), targets.flatten()
    for _ in range(EPOCHS):
        for rows in flat[torch.randperm(len(flat))].chunk(MINIBATCHES):
            policy = Categorical(logits=actor(x[rows]))
            ratio = (policy.log_prob(a[rows]) - old[rows]).exp()
            scaled = (adv[rows] - adv[rows].mean()) / (adv[rows].std() + 1e-8)
            surrogate = torch.min(ratio * scaled, ratio.clamp(1 - CLIP, 1 + CLIP) * scaled).mean()
            value_loss = (critic(x[rows])[:, 0] - target[rows]).square().mean()
            loss = -surrogate + 0.5 * value_loss - 0.005 * policy.entropy().mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_([*actor.parameters(), *critic.parameters()], 0.5)
            optimizer.step()
    if update % 20 == 19 or update == updates - 1:
        steps = (update + 1) * ROLLOUT * args.num_envs
        print(f"{steps:8} steps, return of the last 50 episodes {np.mean(returns[-50:]):7.1f}")

wall = time.perf_counter() - start
print(f"{wall:.1f} s, {in_envs:.1f} s of it in the environments")
