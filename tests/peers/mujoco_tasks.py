"""Times MuJoCo's tasks here, in Gymnasium and in EnvPool, in turn, by CPU time: `mujoco_tasks.py [ID...]`.

All from Python, on one core: one environment from `make` of `rustgym` and of Gymnasium, and vectors of 64 of `rustgym` and of EnvPool on
one thread. The actions are random. Needs what `requirements.txt` names, and rustgym, built as docs/python/README.md says.
"""

import os

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
os.environ["OMP_NUM_THREADS"] = "1"

import sys
import time
import warnings

import envpool
import gymnasium
import numpy as np
import rustgym

warnings.filterwarnings("ignore")
gymnasium.logger.min_level = gymnasium.logger.ERROR

TASKS = ["InvertedPendulum", "InvertedDoublePendulum", "Reacher", "Swimmer", "HalfCheetah", "Hopper", "Walker2d", "Ant", "Pusher"]
TASKS += ["Humanoid", "HumanoidStandup"]
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
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(1000)]
    steps = 0

    def step():
        nonlocal steps
        steps += 1
        _, _, terminated, truncated, _ = env.step(actions[steps % 1000])
        if terminated or truncated:
            env.reset()

    return step


def many(envs, space):
    envs.reset()
    actions = np.random.default_rng(0).uniform(space.low, space.high, (100, AT_ONCE, *space.shape)).astype(space.dtype)
    steps = 0

    def step():
        nonlocal steps
        steps += 1
        envs.step(actions[steps % 100])

    return step


def shown(rate):
    return f"{rate / 1000:.{0 if rate >= 10_000 else 1}f} k"


print("| task | `make` of rustgym | Gymnasium | vector of 64 of rustgym | EnvPool |\n|---|---|---|---|---|")
for task in sys.argv[1:] or [f"{task}-v5" for task in TASKS]:
    envs = rustgym.make_vec(task, num_envs=AT_ONCE)
    space = envs.single_action_space
    pool = envpool.make_gymnasium(task, num_envs=AT_ONCE, num_threads=1, seed=0)
    works = [(one(rustgym, task), 1), (one(gymnasium, task), 1), (many(envs, space), AT_ONCE), (many(pool, space), AT_ONCE)]
    one_here, one_there, many_here, many_there = map(max, zip(*[[rate(*work) for work in works] for _ in range(ROUNDS)]))
    cells = [shown(one_here), f"{shown(one_there)} ({one_here / one_there:.1f}x)"]
    cells += [shown(many_here), f"{shown(many_there)} ({many_here / many_there:.1f}x)"]
    print(f"| {task} | {' | '.join(cells)} |", flush=True)
