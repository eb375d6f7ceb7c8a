"""Record checksums of episodes of Gymnasium-Robotics: the lines of episodes.txt.

    pip install gymnasium-robotics==1.4.2 gymnasium==1.4.0 mujoco==4.0.0
    python record.py --seeds 1 --steps 60 [--only PointMaze] [--kwargs '{"reset_target":true}'] >> episodes.txt

A line is the id, its arguments (`options` are those of the first reset), the version of MuJoCo and the seed, then `step:checksum` for some steps: the CRC-32 of all observations, rewards and
ends up to that step. Last is the checksum of the rewards of eight goals, for tasks with goals. Actions are
`numpy.random.RandomState(seed).uniform(low, high)`.
"""

import argparse
import json
import zlib

import gymnasium
import gymnasium_robotics
import mujoco
import numpy as np

MARKS = (0, 1, 10, 60, 200, 500)


def arrays(observation):
    if isinstance(observation, dict):
        return [observation[key] for key in sorted(observation)]
    return [observation]


def record(id, kwargs, seed, steps):
    arguments = json.loads(kwargs)
    options = arguments.pop("options", None)
    for name, part in (options or {}).get("initial_state_dict", {}).items():
        options["initial_state_dict"][name] = np.array(part, float)
    env = gymnasium.make(id, **arguments)
    actions = np.random.RandomState(seed)
    crc = 0

    def put(numbers):
        nonlocal crc
        crc = zlib.crc32(np.ascontiguousarray(numbers).tobytes(), crc)

    observation = env.reset(seed=seed, options=options)[0]
    [put(array) for array in arrays(observation)]
    marks = [f"0:{crc:08x}"]
    for step in range(1, steps + 1):
        action = actions.uniform(env.action_space.low, env.action_space.high).astype(env.action_space.dtype)
        observation, reward, terminated, truncated, _ = env.step(action)
        [put(array) for array in arrays(observation)]
        put(np.array([reward], "<f8"))
        put(np.array([terminated, truncated], "u1"))
        if terminated or truncated:
            observation = env.reset()[0]
            [put(array) for array in arrays(observation)]
        if step in MARKS or step == steps:
            marks.append(f"{step}:{crc:08x}")
    if isinstance(observation, dict):
        noise = np.random.RandomState(seed + 1).normal(0, 0.1, (8, len(observation["achieved_goal"])))
        goals = np.repeat(observation["desired_goal"][None], 8, 0)
        crc = 0
        # near the goal, where sparse rewards differ
        put(env.unwrapped.compute_reward(goals + 4 * noise, goals, {}))
        marks.append(f"goals:{crc:08x}")
    version = mujoco.__version__.removesuffix(".0")
    return " ".join([id, kwargs, version, str(seed), *marks])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", default="1")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--only", default="")
    parser.add_argument("--kwargs", default="{}")
    asked = parser.parse_args()
    gymnasium.register_envs(gymnasium_robotics)
    for id in sorted(gymnasium.registry):
        if id.startswith(("PointMaze", "AntMaze", "AdroitHand")) and asked.only in id:
            for seed in asked.seeds.split(","):
                print(record(id, asked.kwargs, int(seed), asked.steps), flush=True)


if __name__ == "__main__":
    main()
