#!/usr/bin/env python3
"""Record episodes of dm_control as checksums: `record.py SEED... > episodes.txt`.

    pip install dm-control==1.0.45 mujoco==3.12.0

Dog, humanoid_CMU and quadruped were recorded with `OPENBLAS_CORETYPE=Zen`, the others with `SkylakeX`.

A line is an id, a seed, and the CRC-32 of all that happened up to some steps: the observations' arrays in the order of their keys,
the reward, and whether the episode ended by the task or by its limit. Actions are `RandomState(seed).uniform(low, high)`.
`episodes.txt` has the seeds 1 and 2, and manipulator-insert_peg's 11, where the peg touches the slot up to rounding at the start.
"""
import sys
import zlib

import numpy as np
from dm_control import suite

DOMAINS = (
    "acrobot ball_in_cup cartpole cheetah dog finger fish hopper humanoid humanoid_CMU lqr manipulator pendulum point_mass quadruped reacher "
    "stacker swimmer walker"
).split()
MARKS = [0, 1, 10, 100, 200, 300]


def checksum(crc, timestep):
    for key in sorted(timestep.observation):
        crc = zlib.crc32(np.asarray(timestep.observation[key], np.float64).tobytes(), crc)
    return crc


for domain, task in suite.ALL_TASKS:
    for seed in map(int, sys.argv[1:]) if domain in DOMAINS else []:
        env = suite.load(domain, task, task_kwargs={"random": np.random.RandomState(seed)})
        # lqr's bounds are 1e10: small forces say more
        low, high = env.action_spec().minimum.clip(-1), env.action_spec().maximum.clip(None, 1)
        actions = np.random.RandomState(seed)
        crc = checksum(0, env.reset())
        line = [f"dm_control/{domain}-{task}-v0", str(seed), f"0:{crc:08x}"]
        for step in range(1, MARKS[-1] + 1):
            timestep = env.step(actions.uniform(low, high))
            crc = checksum(crc, timestep)
            crc = zlib.crc32(np.float64(timestep.reward).tobytes(), crc)
            last = timestep.last()
            crc = zlib.crc32(bytes([last and timestep.discount == 0, last and timestep.discount == 1]), crc)
            if last:
                crc = checksum(crc, env.reset())
            if step in MARKS:
                line.append(f"{step}:{crc:08x}")
        print(" ".join(line), flush=True)
