#!/usr/bin/env python3
"""Record episodes of minigrid as checksums, for the test `episodes`.

    pip install minigrid==3.2.0 gymnasium==1.4.0
    python record.py SEEDS STEPS [--all] [WORD] > episodes.txt

A line is an id, a seed, and `step:checksum` after some steps (after all of them with `--all`); `f` before a step marks a picture.
A checksum is the CRC-32 of all that happened so far: direction, picture of cells, mission, reward and flags of each step. An episode
that ended is reset without a seed. Actions come from a linear congruential generator that starts with the seed.
"""
import sys
import warnings
import zlib

import gymnasium
import minigrid  # noqa: F401
import numpy as np

warnings.filterwarnings("ignore")
MARKS = (0, 1, 2, 5, 10, 20, 40, 80)


def record(id, seed, steps, every):
    env = gymnasium.make(id, render_mode="rgb_array")
    crc, state, marks = 0, seed, []

    def see(observation):
        nonlocal crc
        crc = zlib.crc32(int(observation["direction"]).to_bytes(8, "little"), crc)
        crc = zlib.crc32(np.ascontiguousarray(observation["image"]).tobytes(), crc)
        crc = zlib.crc32(observation["mission"].encode(), crc)

    def mark(step):
        if every or step in MARKS or step == steps:
            marks.append(f"{step}:{crc:08x}")
        if step in (0, 1, 10):
            marks.append(f"f{step}:{zlib.crc32(np.ascontiguousarray(env.render()).tobytes()):08x}")

    see(env.reset(seed=seed)[0])
    mark(0)
    for step in range(1, steps + 1):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        observation, reward, terminated, truncated, _ = env.step((state >> 33) % int(env.action_space.n))
        see(observation)
        crc = zlib.crc32(np.float64(reward).tobytes() + bytes([terminated, truncated]), crc)
        if terminated or truncated:
            see(env.reset()[0])
        mark(step)
    return " ".join([id, str(seed), *marks])


def main():
    every = "--all" in sys.argv
    seeds, steps, *words = [word for word in sys.argv[1:] if word != "--all"]
    ids = [id for id in sorted(gymnasium.registry) if id.startswith(("MiniGrid-", "BabyAI-")) and "-WFC-" not in id]
    stdout, sys.stdout = sys.stdout, sys.stderr  # minigrid prints
    for seed in map(int, seeds.split(",")):
        for id in ids:
            if not words or words[0] in id:
                print(record(id, seed, int(steps), every), file=stdout, flush=True)


if __name__ == "__main__":
    main()
