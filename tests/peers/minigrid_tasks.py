"""Times MiniGrid's and BabyAI's tasks here, in minigrid and in EnvPool, in turn, by CPU time: `minigrid_tasks.py [ID...]`.

All from Python, on one core: one environment from `make` of `rustgym` and of Gymnasium with minigrid, and vectors of 64 of `rustgym` and
of EnvPool on one thread. The actions are random, and resets are part of the time. Needs what `requirements.txt` names and
rustgym, built as docs/python/README.md says.
"""

import sys
import warnings

from timing import best, many, one

import envpool
import gymnasium
import minigrid  # the import registers minigrid's tasks
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["MiniGrid-Empty-5x5-v0", "MiniGrid-Empty-8x8-v0", "MiniGrid-DoorKey-5x5-v0", "MiniGrid-DoorKey-8x8-v0"]
TASKS += ["MiniGrid-FourRooms-v0", "MiniGrid-MultiRoom-N6-v0", "MiniGrid-KeyCorridorS3R3-v0", "BabyAI-GoToLocal-v0", "BabyAI-GoTo-v0"]
AT_ONCE = 64

print("| task | `make`, steps per second | minigrid | times | vector of 64 | EnvPool | times |\n|---|---|---|---|---|---|---|")
for task in sys.argv[1:] or TASKS:
    vector = rustgym.make_vec(task, num_envs=AT_ONCE)
    pool = envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=1, seed=0)
    count = int(vector.single_action_space.n)
    actions = np.random.default_rng(0).integers(count, size=1000).tolist()
    rows = np.random.default_rng(0).integers(count, size=(100, AT_ONCE))
    works = [(one(library.make(task), actions), 1) for library in (rustgym, gymnasium)]
    works += [(many(envs, rows), AT_ONCE) for envs in (vector, pool)]
    here, there, many_here, many_there = best(works)
    cells = [f"{here:,.0f}", f"{there:,.0f}", f"{here / there:.1f}"]
    cells += [f"{many_here:,.0f}", f"{many_there:,.0f}", f"{many_here / many_there:.1f}"]
    print(f"| {task} | {' | '.join(cells)} |", flush=True)
