"""Times 64 worlds of MuJoCo's tasks here and in pools of threads over libmujoco, in turn: `pools.py THREADS [ID...]`.

A vector of `rustgym` (native on one thread, async on more) and one of EnvPool do the same work. mjbatch and `mujoco.rollout` only step the
model of Gymnasium by random controls: no observations, rewards or ends of episodes, but a reset after as many steps as our episodes have,
at most 100. A call of rollout makes all these steps. Rates are by wall time, so nothing else should run. Needs Python 3.12 or later, what
`requirements-pools.txt` names, and rustgym, built as docs/python/README.md says.
"""

import os
import sys

THREADS, NAMES = int(sys.argv[1]), sys.argv[2:]
CORES = sorted(os.sched_getaffinity(0))[:THREADS]

import functools
import itertools
import time
import warnings

from timing import best, many, shown

os.sched_setaffinity(0, CORES)

import envpool
import gymnasium
import mjbatch
import mujoco
import mujoco.rollout
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["InvertedPendulum", "InvertedDoublePendulum", "Reacher", "Swimmer", "HalfCheetah", "Hopper", "Walker2d", "Ant", "Pusher"]
TASKS += ["Humanoid", "HumanoidStandup"]
AT_ONCE = 64


def length(envs, rows):
    """The mean length of an episode, at most 100."""
    envs.reset(seed=0)
    ends = 1 + sum(int((step[2] | step[3]).sum()) for step in map(envs.step, itertools.islice(itertools.cycle(rows), 200)))
    return max(1, min(100, 200 * AT_ONCE // ends))


def batch(model, skip, rows, steps):
    sims = mjbatch.Batch(model, AT_ONCE, num_threads=THREADS)
    ctrl, rows, count = sims.bind("ctrl"), itertools.cycle(rows), itertools.cycle(range(steps))

    def step():
        if next(count) == 0:
            sims.reset()
        ctrl[:] = next(rows)
        sims.step(nstep=skip)

    return step


def rollout(model, skip, rows, steps):
    data = [mujoco.MjData(model) for _ in range(THREADS)]
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data[0], start, kind)
    control = np.stack([row for row in itertools.islice(itertools.cycle(rows), steps) for _ in range(skip)], 1)
    pool = mujoco.rollout.Rollout(nthread=THREADS if THREADS > 1 else 0)
    return functools.partial(pool.rollout, model, data, np.tile(start, (AT_ONCE, 1)), control)


print(f"On {THREADS} thread(s), steps per second:\n")
print("| task | rustgym | EnvPool | mjbatch | rollout |\n|---|---|---|---|---|")
logs = []
for task in NAMES or [f"{task}-v5" for task in TASKS]:
    vector = rustgym.make_vec(task, num_envs=AT_ONCE, **{"kind": "async", "threads": THREADS} if THREADS > 1 else {})
    pool = envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=THREADS, seed=0)
    space = vector.single_action_space
    rows = np.random.default_rng(0).uniform(space.low, space.high, (100, AT_ONCE, *space.shape)).astype(space.dtype)
    env = gymnasium.make(task).unwrapped
    steps = length(vector, rows)
    same = env.model, env.frame_skip, rows, steps
    works = [(many(vector, rows), AT_ONCE), (many(pool, rows), AT_ONCE), (batch(*same), AT_ONCE), (rollout(*same), AT_ONCE * steps)]
    here, *others = best(works, seconds=0.4, calls=1, clock=time.perf_counter)
    logs.append([np.log(here / there) for there in others])
    print(f"| {task} | {shown(here)} | {' | '.join(f'{shown(there)} ({here / there:.1f}x)' for there in others)} |", flush=True)
means = [f"{name} {mean:.1f}x" for name, mean in zip(["EnvPool", "mjbatch", "rollout"], np.exp(np.mean(logs, 0)))]
print(f"\nGeometric means: {', '.join(means)}")
