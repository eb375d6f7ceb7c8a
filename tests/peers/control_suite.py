"""Times the Control Suite here, in dm_control and in EnvPool, in turn, by CPU time: `control_suite.py make|vector|pixels [WORD]`.

`make`: one environment of `rustgym` beside dm_control's. `vector`: 64 in a native vector beside EnvPool's on one thread. `pixels`: steps of
which each gives the last three pictures of 84x84, beside dm_control's with EGL in software. All from Python, on one core. Needs
dm-control==1.0.45, mujoco==3.12.0, what `requirements.txt` names, and rustgym, built as docs/python/README.md says.
"""

import os

os.environ |= {"MUJOCO_GL": "egl", "LP_NUM_THREADS": "0"}

import itertools
import sys
import warnings
from collections import deque

from timing import best, many, one, shown

import numpy as np
import rustgym

warnings.filterwarnings("ignore")

AT_ONCE = 64
FRAMES = 3
DRAWN = "ball_in_cup-catch cartpole-swingup cheetah-run finger-spin humanoid-run manipulator-bring_ball reacher-easy walker-walk".split()
VECTORS = DRAWN + "fish-swim hopper-hop pendulum-swingup swimmer-swimmer6".split()


def id(task):
    return f"dm_control/{task}-v0"


def actions(space, *shape):
    low, high = np.clip(space.low, -1, 1), np.clip(space.high, -1, 1)
    return np.random.default_rng(0).uniform(low, high, (100, *shape, *low.shape))


def stacked(see):
    frames = deque(maxlen=FRAMES)

    def step():
        frames.append(see())
        if len(frames) == FRAMES:
            np.concatenate(frames, -1)

    return step


def ours(task, **kwargs):
    env = rustgym.make(id(task), mujoco="3.12", **kwargs)
    return one(env, actions(env.action_space))


def theirs(task, drawn=False):
    from dm_control import suite

    env = suite.load(*task.split("-", 1), task_kwargs={"random": 0})
    env.reset()
    acts = itertools.cycle(actions(rustgym.make(id(task)).action_space))

    def step():
        if env.step(next(acts)).last():
            env.reset()
        return env.physics.render(84, 84, camera_id=0) if drawn else None

    return step


def pair(kind, task):
    if kind == "make":
        return ours(task), theirs(task), 1
    if kind == "pixels":
        return stacked(ours(task, pixels=84)), stacked(theirs(task, True)), 1
    import envpool

    name = "".join(word.capitalize() for word in task.replace("-", "_").split("_")) + "-v1"
    acts = actions(rustgym.make(id(task)).action_space, AT_ONCE)
    envs = rustgym.make_vec(id(task), num_envs=AT_ONCE, vectorization_mode="vector_entry_point", mujoco="3.12")
    return many(envs, acts), many(envpool.make_gymnasium(name, num_envs=AT_ONCE, num_threads=1, seed=0), acts), AT_ONCE


def main():
    kind, word = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
    every = sorted(id.removeprefix("dm_control/")[:-3] for id in rustgym.registry if id.startswith("dm_control/"))
    tasks = {"make": every, "vector": VECTORS, "pixels": DRAWN}[kind]
    print(f"| task | rustgym | {'EnvPool' if kind == 'vector' else 'dm_control'} |\n|---|---|---|")
    logs = []
    for task in filter(lambda task: word in task, tasks):
        own, other, at_once = pair(kind, task)
        here, there = best([(own, at_once), (other, at_once)], seconds=0.2, calls=5)
        logs.append(np.log(here / there))
        print(f"| {task} | {shown(here)} | {shown(there)} ({here / there:.1f}x) |", flush=True)
    print(f"\nGeometric mean: {np.exp(np.mean(logs)):.1f}x")


main()
