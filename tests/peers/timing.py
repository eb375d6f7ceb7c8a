"""Rates by CPU time on one core, for the scripts in this folder. Import it before numpy, to disable threads."""

import os

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
os.environ["OMP_NUM_THREADS"] = "1"

import itertools
import time


def rate(step, at_once, seconds=0.5, calls=20, clock=time.process_time):
    """The steps per CPU second in one slice of time. A call of `step` takes `at_once` steps."""
    done, start = 0, clock()
    while (elapsed := clock() - start) < seconds:
        for _ in range(calls):
            step()
        done += calls * at_once
    return done / elapsed


def best(works, rounds=6, **slices):
    """The best rate of each work, a pair of `step` and `at_once`. In each round, every work runs once."""
    rounds = [[rate(*work, **slices) for work in works] for _ in range(rounds)]
    return list(map(max, zip(*rounds)))


def one(env, actions):
    """Returns a function that steps an environment, or resets it after the end of an episode."""
    env.reset(seed=0)
    actions = itertools.cycle(actions)

    def step():
        observation, _, terminated, truncated, _ = env.step(next(actions))
        return env.reset()[0] if terminated or truncated else observation

    return step


def many(envs, actions):
    """Returns a function that steps a vector."""
    envs.reset()
    actions = itertools.cycle(actions)
    return lambda: envs.step(next(actions))


def shown(rate):
    """A rate as text, such as `12 k`, `1.2 k` or `120`."""
    return f"{rate / 1000:.{0 if rate >= 10_000 else 1}f} k" if rate >= 1000 else f"{rate:.0f}"
