"""Times MuJoCo's tasks here, in Gymnasium and in EnvPool, in turn, by CPU time: `mujoco_tasks.py [ID...]`.

All from Python, on one core: one environment from `make` of `rustgym` and of Gymnasium, and vectors of 64 of `rustgym` and of EnvPool on
one thread. The actions are random. Needs what `requirements.txt` names, and rustgym, built as docs/python/README.md says.
"""

import sys
import warnings

from timing import best, many, one, shown

import envpool
import gymnasium
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["InvertedPendulum", "InvertedDoublePendulum", "Reacher", "Swimmer", "HalfCheetah", "Hopper", "Walker2d", "Ant", "Pusher"]
TASKS += ["Humanoid", "HumanoidStandup"]
AT_ONCE = 64

print("| task | `make` of rustgym | Gymnasium | vector of 64 of rustgym | EnvPool |\n|---|---|---|---|---|")
for task in sys.argv[1:] or [f"{task}-v5" for task in TASKS]:
    vector = rustgym.make_vec(task, num_envs=AT_ONCE)
    pool = envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=1, seed=0)
    space = vector.single_action_space
    space.seed(0)
    actions = [space.sample() for _ in range(1000)]
    rows = np.random.default_rng(0).uniform(space.low, space.high, (100, AT_ONCE, *space.shape)).astype(space.dtype)
    works = [(one(library.make(task), actions), 1) for library in (rustgym, gymnasium)]
    works += [(many(envs, rows), AT_ONCE) for envs in (vector, pool)]
    here, there, many_here, many_there = best(works)
    cells = [shown(here), f"{shown(there)} ({here / there:.1f}x)"]
    cells += [shown(many_here), f"{shown(many_there)} ({many_here / many_there:.1f}x)"]
    print(f"| {task} | {' | '.join(cells)} |", flush=True)
