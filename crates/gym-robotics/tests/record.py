"""Record checksums of episodes of Gymnasium-Robotics: the lines of episodes.txt, with --robots those of robots.txt, and with --own
those of own.txt, on the small models in `own`.

    pip install gymnasium-robotics==1.4.2 gymnasium==1.4.0 mujoco==4.0.0
    python record.py --seeds 1 --steps 60 [--only PointMaze] [--kwargs '{"reset_target":true}'] >> episodes.txt
    OPENBLAS_CORETYPE=Zen python record.py --robots --seeds 1 --steps 60 >> robots.txt
    OPENBLAS_CORETYPE=Zen python record.py --own --steps 60 >> own.txt

A line is the id, its arguments (`options` are those of the first reset), the version of MuJoCo and the seed, then `step:checksum` for some steps: the CRC-32 of all observations, rewards and
ends up to that step. Last is the checksum of the rewards of eight goals, for tasks with goals. Actions are
`numpy.random.RandomState(seed).uniform(low, high)`.
"""

import argparse
import json
import pathlib
import tempfile
import types
import zlib

import gymnasium
import gymnasium_robotics
import mujoco
import numpy as np
from gymnasium_robotics.envs import robot_env
from gymnasium_robotics.envs.franka_kitchen import franka_env
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


# ids, arguments (without spaces, which end a word of a line) and seeds on the models in `own`
OWN = [
    ("FetchReach-v4", "{}", 1),
    ("FetchReachDense-v4", "{}", 2),
    ("FetchPush-v4", "{}", 3),
    ("FetchPushDense-v4", "{}", 4),
    ("FetchSlide-v4", "{}", 5),
    ("FetchSlideDense-v4", "{}", 6),
    ("FetchPickAndPlace-v4", "{}", 7),
    ("FetchPickAndPlaceDense-v4", "{}", 8),
    ("HandReach-v3", "{}", 1),
    ("HandReachDense-v3", '{"distance_threshold":0.2}', 2),
    ("HandReach-v3", '{"distance_threshold":0.2,"initial_qpos":{"robot0:FFJ2":0.5,"robot0:THJ3":0.2}}', 3),
    ("HandManipulateBlockRotateZ-v1", "{}", 1),
    ("HandManipulateBlockRotateParallelDense-v1", "{}", 2),
    ("HandManipulateBlockRotateXYZ-v1", '{"rotation_threshold":1.5}', 3),
    ("HandManipulateBlockFullDense-v1", "{}", 4),
    ("HandManipulateBlock-v1", '{"target_position":"fixed","distance_threshold":0.03,"rotation_threshold":2.0}', 5),
    ("HandManipulateBlockDense-v1", '{"randomize_initial_position":false,"randomize_initial_rotation":false}', 6),
    ("HandManipulatePenRotate-v1", '{"rotation_threshold":1.0}', 7),
    ("HandManipulatePenDense-v1", "{}", 8),
    ("HandManipulateEgg_BooleanTouchSensors-v1", "{}", 9),
    ("HandManipulateEgg_ContinuousTouchSensorsDense-v1", "{}", 10),
    ("HandManipulateEggRotate_ContinuousTouchSensors-v1", '{"touch_get_obs":"log"}', 11),
    ("HandManipulateEggRotate_ContinuousTouchSensors-v1", '{"touch_get_obs":"off"}', 12),
    ("FrankaKitchen-v1", "{}", 1),
    ("FrankaKitchen-v1", '{"tasks_to_complete":["slide\\u0020cabinet"],"robot_noise_ratio":0.1}', 2),
    ("FrankaKitchen-v1", '{"tasks_to_complete":["slide\\u0020cabinet"],"terminate_on_tasks_completed":false}', 3),
    (
        "FrankaKitchen-v1",
        '{"tasks_to_complete":["microwave","slide\\u0020cabinet"],"remove_task_when_completed":false,"object_noise_ratio":0.01}',
        4,
    ),
]


def own_models(place):
    """Lets the package load the models in `own`, and its own limits of the arm in the kitchen."""
    of_package = pathlib.Path(franka_env.__file__).parents[1] / "assets/kitchen_franka/franka_assets"
    own = pathlib.Path(__file__).parent.absolute() / "own"
    kitchen = place / "assets/kitchen_franka"
    kitchen.mkdir(parents=True)
    (place / "franka_kitchen").mkdir()
    for folder in ("fetch", "hand", "kitchen_franka/kitchen_assets"):
        (place / "assets" / folder).symlink_to(own / folder)
    (kitchen / "franka_assets").symlink_to(of_package)
    robot_env.__file__ = str(place / "robot_env.py")
    franka_env.__file__ = str(place / "franka_kitchen/franka_env.py")


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
    parser.add_argument("--own", action="store_true")
    asked = parser.parse_args()
    gymnasium.register_envs(gymnasium_robotics)
    mend()
    if asked.own:
        with tempfile.TemporaryDirectory() as place:
            own_models(pathlib.Path(place))
            for id, kwargs, seed in OWN:
                print(record(id, kwargs, seed, asked.steps), flush=True)
        return
    kinds = ("Fetch", "HandReach", "HandManipulate", "FrankaKitchen") if asked.robots else ("PointMaze", "AntMaze", "AdroitHand")
    for id in sorted(gymnasium.registry):
        of_older_bindings = "MujocoPy" in str(gymnasium.registry[id].entry_point)
        if id.startswith(kinds) and not of_older_bindings and asked.only in id:
            for seed in asked.seeds.split(","):
                print(record(id, asked.kwargs, int(seed), asked.steps), flush=True)


if __name__ == "__main__":
    main()
