"""Plays a policy that gym-ppo trained in Gymnasium's environment and in ours: every return must be the same to the last bit.

    python tests/peers/policy.py crates/gym-policies/networks/half-cheetah.json --episodes 100

It needs gymnasium, with MuJoCo for its tasks, and rustgym.
"""

import argparse
import json
import sys

import gymnasium
import numpy as np
import rustgym


def load(path):
    """Reads a policy file: the environment's spec, and a function from an observation to the best action."""
    with open(path, encoding="utf-8") as file:
        stored = json.load(file)
    moments = next(iter(stored["normalization"]["moments"].values()))
    mean, variance = np.array(moments["mean"]), np.array(moments["var"])
    numbers = [np.array(layer, dtype=np.float32) for layer in stored["network"]]
    layers = [(weights.reshape(-1, len(bias)), bias) for weights, bias in zip(numbers[::2], numbers[1::2])]

    def best(observation):
        x = ((observation - mean) / np.sqrt(variance + 1e-8)).astype(np.float32)
        for weights, bias in layers[:-1]:
            x = np.tanh(x @ weights + bias)
        weights, bias = layers[-1]
        return x @ weights + bias

    return stored["env"], best


def play(make, spec, best, seed):
    """The return of an episode."""
    env = gymnasium.wrappers.ClipAction(make(spec["id"], **spec["kwargs"]))
    observation, _ = env.reset(seed=seed)
    total, done = 0.0, False
    while not done:
        observation, reward, terminated, truncated, _ = env.step(best(observation))
        total, done = total + reward, terminated or truncated
    return total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policy")
    parser.add_argument("--episodes", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1_000_000)
    arguments = parser.parse_args()
    spec, best = load(arguments.policy)
    returns, unequal = [], 0
    for seed in range(arguments.seed, arguments.seed + arguments.episodes):
        theirs, ours = (play(make, spec, best, seed) for make in (gymnasium.make, rustgym.make))
        if theirs != ours:
            print(f"seed {seed}: {theirs} in Gymnasium, {ours} here")
            unequal += 1
        returns.append(ours)
    print(
        f"{spec['id']}: mean return {np.mean(returns):.1f}, standard deviation {np.std(returns):.1f}, "
        f"over {len(returns)} episodes, {unequal} of them unequal"
    )
    return 1 if unequal else 0


if __name__ == "__main__":
    sys.exit(main())
