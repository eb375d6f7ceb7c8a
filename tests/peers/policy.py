"""Plays a policy that gym-ppo trained in Gymnasium's environment: its returns must be those of `gym-ppo evaluate`.

    python tests/peers/policy.py crates/gym-mujoco/policies/half-cheetah.json --episodes 100
"""

import argparse
import json

import gymnasium
import numpy as np


def load(path):
    """The policy of a file: its environment's spec, and a function from an observation to the best action."""
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policy")
    parser.add_argument("--episodes", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1_000_000)
    arguments = parser.parse_args()
    spec, best = load(arguments.policy)
    env = gymnasium.wrappers.ClipAction(gymnasium.make(spec["id"], **spec["kwargs"]))
    returns = []
    for episode in range(arguments.episodes):
        observation, _ = env.reset(seed=arguments.seed + episode)
        total, done = 0.0, False
        while not done:
            observation, reward, terminated, truncated, _ = env.step(best(observation))
            total, done = total + reward, terminated or truncated
        print(f"episode {episode}: return {total}")
        returns.append(total)
    print(
        f"{spec['id']}: mean return {np.mean(returns):.1f}, standard deviation {np.std(returns):.1f}, "
        f"over {len(returns)} episodes"
    )


if __name__ == "__main__":
    main()
