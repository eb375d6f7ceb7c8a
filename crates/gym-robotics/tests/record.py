"""Record checksums of episodes of Gymnasium-Robotics: the lines of episodes.txt, and with --robots those of robots.txt.

    pip install gymnasium-robotics==1.4.2 gymnasium==1.4.0 mujoco==4.0.0
    python record.py --seeds 1 --steps 60 [--only PointMaze] [--kwargs '{"reset_target":true}'] >> episodes.txt
    OPENBLAS_CORETYPE=Zen python record.py --robots --seeds 1 --steps 60 >> robots.txt

A line is the id, its arguments (`options` are those of the first reset), the version of MuJoCo and the seed, then `step:checksum` for some steps: the CRC-32 of all observations, rewards and
ends up to that step. Last is the checksum of the rewards of eight goals, for tasks with goals. Actions are
`numpy.random.RandomState(seed).uniform(low, high)`.
"""

import argparse
import json
import types
import zlib

import gymnasium
import gymnasium_robotics
import mujoco
import numpy as np
from gymnasium_robotics.utils import mujoco_utils

MARKS = (0, 1, 10, 60, 200, 500)


def arrays(observation):
    if isinstance(observation, dict):
        return [array for key in sorted(observation) for array in arrays(observation[key])]
    return [observation]


def mend():
    """Lets the package compare the model's numbers with enumerations, which since MuJoCo 3.12 equal no numbers."""
    names = {"mjtJoint", "mjtObj", "mjtEq", "mjtTrn"}
    plain = {name: types.SimpleNamespace(**{k: int(v) for k, v in getattr(mujoco, name).__members__.items()}) for name in names}
    everything = {name: getattr(mujoco, name) for name in dir(mujoco) if not name.startswith("__")}
    mujoco_utils.mujoco = types.SimpleNamespace(**everything | plain)


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
    if isinstance(observation, dict) and not isinstance(observation["achieved_goal"], dict):
        noise = np.random.RandomState(seed + 1).normal(0, 0.1, (8, len(observation["achieved_goal"])))
        goals = np.repeat(observation["desired_goal"][None], 8, 0)
        crc = 0
        # near the goal, where sparse rewards differ
        put(np.asarray(env.unwrapped.compute_reward(goals + 4 * noise, goals, {}), "<f8"))
        marks.append(f"goals:{crc:08x}")
    version = mujoco.__version__.removesuffix(".0")
    return " ".join([id, kwargs, version, str(seed), *marks])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", default="1")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--only", default="")
    parser.add_argument("--kwargs", default="{}")
    parser.add_argument("--robots", action="store_true")
    asked = parser.parse_args()
    gymnasium.register_envs(gymnasium_robotics)
    mend()
    kinds = ("Fetch", "HandReach", "HandManipulate", "FrankaKitchen") if asked.robots else ("PointMaze", "AntMaze", "AdroitHand")
    for id in sorted(gymnasium.registry):
        of_older_bindings = "MujocoPy" in str(gymnasium.registry[id].entry_point)
        if id.startswith(kinds) and not of_older_bindings and asked.only in id:
            for seed in asked.seeds.split(","):
                print(record(id, asked.kwargs, int(seed), asked.steps), flush=True)


if __name__ == "__main__":
    main()
