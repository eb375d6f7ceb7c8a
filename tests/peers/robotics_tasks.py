"""Times Gymnasium-Robotics' tasks here and in the package, in turn, by CPU time: `robotics_tasks.py [ID...]`.

From Python, on one core, with random actions. Needs gymnasium-robotics 1.4.2 with mujoco 3.12.0, and rustgym, built as
docs/python/README.md says. Fetch, the Shadow hand and the kitchen are made here from the package's own models.
"""

import sys
import types
import warnings

from timing import best, one, shown

import gymnasium
import gymnasium_robotics
import mujoco
import numpy as np
import rustgym
from gymnasium_robotics.utils import mujoco_utils

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["PointMaze_UMaze-v3", "AntMaze_UMaze-v5"]
TASKS += [f"AdroitHand{task}-v1" for task in ("Door", "Hammer", "Pen", "Relocate")]
TASKS += ["FetchReach-v4", "FetchPickAndPlace-v4", "HandReach-v3", "HandManipulateBlock-v1", "FrankaKitchen-v1"]

# the package compares MuJoCo's enumerations with numbers, which they do not equal
names = {name: getattr(mujoco, name) for name in dir(mujoco) if not name.startswith("__")}
for name in ["mjtJoint", "mjtObj", "mjtEq", "mjtTrn"]:
    names[name] = types.SimpleNamespace(**{key: int(value) for key, value in names[name].__members__.items()})
mujoco_utils.mujoco = types.SimpleNamespace(**names)
gymnasium.register_envs(gymnasium_robotics)

print("| task | rustgym | Gymnasium-Robotics |\n|---|---|---|")
for task in sys.argv[1:] or TASKS:
    ours, theirs = rustgym.make(task, mujoco="3.12"), gymnasium.make(task)
    space = ours.action_space
    actions = np.random.default_rng(0).uniform(space.low, space.high, (100, *space.shape)).astype(space.dtype)
    here, there = best([(one(env, actions), 1) for env in (ours, theirs)], calls=5)
    print(f"| {task} | {shown(here)} | {shown(there)} ({here / there:.1f}x) |", flush=True)
