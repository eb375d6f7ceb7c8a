"""Times Gymnasium-Robotics' tasks here and elsewhere, in turn, by CPU time: `robotics_tasks.py make|vector [ID...]`.

From Python, on one core, with random actions: `make` beside the package, for which it needs gymnasium-robotics 1.4.2 with
mujoco 3.12.0; `vector`, 64 environments beside EnvPool's, for which it needs what `requirements-pools.txt` names. Both need rustgym,
built as docs/python/README.md says. Fetch, the Shadow hand and the kitchen are made here from the package's own models.
"""

import sys
import types
import warnings

from timing import best, many, one, shown

import gymnasium
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["PointMaze_UMaze-v3", "AntMaze_UMaze-v5"]
TASKS += [f"AdroitHand{task}-v1" for task in ("Door", "Hammer", "Pen", "Relocate")]
TASKS += ["FetchReach-v4", "FetchPickAndPlace-v4", "HandReach-v3", "HandManipulateBlock-v1", "FrankaKitchen-v1"]
AT_ONCE = 64


def package():
    """Returns a function that makes an environment of the package, mended for mujoco 3.12.0."""
    import gymnasium_robotics
    import mujoco
    from gymnasium_robotics.utils import mujoco_utils

    # the package compares MuJoCo's enumerations with numbers, which they do not equal
    names = {name: getattr(mujoco, name) for name in dir(mujoco) if not name.startswith("__")}
    for name in ["mjtJoint", "mjtObj", "mjtEq", "mjtTrn"]:
        names[name] = types.SimpleNamespace(**{key: int(value) for key, value in names[name].__members__.items()})
    mujoco_utils.mujoco = types.SimpleNamespace(**names)
    gymnasium.register_envs(gymnasium_robotics)
    return gymnasium.make


def actions(space):
    return np.random.default_rng(0).uniform(space.low, space.high, (100, *space.shape)).astype(space.dtype)


def main():
    kind, names = sys.argv[1], sys.argv[2:]
    if kind == "vector":
        import envpool

        known = set(envpool.list_all_envs())
        print("| task | rustgym | EnvPool |\n|---|---|---|")
    else:
        make = package()
        print("| task | rustgym | Gymnasium-Robotics |\n|---|---|---|")
    for task in names or TASKS:
        if kind == "make":
            envs = rustgym.make(task, mujoco="3.12"), make(task)
            works = [(one(env, actions(envs[0].action_space)), 1) for env in envs]
        elif task in known:
            envs = rustgym.make_vec(task, num_envs=AT_ONCE), envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=1, seed=0)
            works = [(many(vector, actions(envs[0].action_space)), AT_ONCE) for vector in envs]
        else:
            continue
        here, there = best(works, calls=5 if kind == "make" else 1)
        print(f"| {task} | {shown(here)} | {shown(there)} ({here / there:.1f}x) |", flush=True)


main()
