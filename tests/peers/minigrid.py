"""Times MiniGrid's and BabyAI's tasks here, in minigrid and in EnvPool, in turn, by CPU time: `minigrid.py [ID...]`.

All from Python, on one core: one environment from `make` of `rustgym` and of Gymnasium with minigrid, and vectors of 64 of `rustgym` and
of EnvPool on one thread. The actions are random, and resets are part of the time. Needs what `requirements.txt` names and
rustgym, built as docs/python/README.md says.
"""

import os

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import sys
import time
import warnings

sys.path.pop(0)  # this file has the name of the package
import envpool
import gymnasium
import minigrid  # registers its tasks
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["MiniGrid-Empty-5x5-v0", "MiniGrid-Empty-8x8-v0", "MiniGrid-DoorKey-5x5-v0", "MiniGrid-DoorKey-8x8-v0"]
TASKS += ["MiniGrid-FourRooms-v0", "MiniGrid-MultiRoom-N6-v0", "MiniGrid-KeyCorridorS3R3-v0", "BabyAI-GoToLocal-v0", "BabyAI-GoTo-v0"]
AT_ONCE = 64
ROUNDS = 6
SECONDS = 0.5  # of each slice


def rate(step, at_once):
    """Steps per CPU second in one slice."""
    done, start = 0, time.process_time()
    while (elapsed := time.process_time() - start) < SECONDS:
        for _ in range(20):
            step()
        done += 20 * at_once
    return done / elapsed


def one(library, task):
    env = library.make(task)
    env.reset(seed=0)
    actions = np.random.default_rng(0).integers(env.action_space.n, size=1000).tolist()
    steps = 0

    def step():
        nonlocal steps
        steps += 1
        _, _, terminated, truncated, _ = env.step(actions[steps % 1000])
        if terminated or truncated:
            env.reset()

    return step


def many(envs, actions):
    envs.reset()
    actions = np.random.default_rng(0).integers(actions, size=(100, AT_ONCE))
    steps = 0

    def step():
        nonlocal steps
        steps += 1
        envs.step(actions[steps % 100])

    return step


def main():
    print("| task | `make`, steps per second | minigrid | times | vector of 64 | EnvPool | times |\n|---|---|---|---|---|---|---|")
    for task in sys.argv[1:] or TASKS:
        vector = rustgym.make_vec(task, num_envs=AT_ONCE)
        actions = int(vector.single_action_space.n)
        works = [(one(rustgym, task), 1), (one(gymnasium, task), 1), (many(vector, actions), AT_ONCE)]
        works.append((many(envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=1, seed=0), actions), AT_ONCE))
        best = [0.0] * len(works)
        for _ in range(ROUNDS):
            best = [max(old, rate(*work)) for old, work in zip(best, works)]
        ours, minigrid_, lanes, pool = best
        print(f"| {task} | {ours:,.0f} | {minigrid_:,.0f} | {ours / minigrid_:.1f} | {lanes:,.0f} | {pool:,.0f} | {lanes / pool:.1f} |", flush=True)


if __name__ == "__main__":
    main()
