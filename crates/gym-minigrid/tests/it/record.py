#!/usr/bin/env python3
"""Record episodes of minigrid as checksums, for the test `episodes`.

    pip install minigrid==3.2.0 gymnasium==1.4.0
    python record.py SEEDS STEPS [--all] [WORD] > episodes.txt
    python record.py --pictures > pictures.txt
    python record.py --limits > limits.txt
    NPY_DISABLE_CPU_FEATURES="X86_V4 AVX512_ICL AVX512_SPR" python record.py --wrappers > wrappers.txt

numpy's `arctan2` has another last bit on CPUs with AVX-512; without, it is the C library's.

A line is an id, a seed, and `step:checksum` after some steps (after all of them with `--all`); `f` before a step marks a picture.
A checksum is the CRC-32 of all that happened so far: direction, picture of cells, mission, reward and flags of each step. An episode
that ended is reset without a seed. Actions come from a linear congruential generator that starts with the seed.

A line of `limits.txt` is an id and its limits of steps after resets with the seeds 0, 1 and 2.
A line of `pictures.txt` is an id, a tile size, `highlight` and `agent_pov` as 0 or 1, and the CRC-32 of the picture after ten steps.
A line of `wrappers.txt` is an id, a wrapper, its arguments, and the CRC-32 of observations (the arrays in the order of sorted keys), rewards
and flags of 60 steps.
"""
import json
import sys
import warnings
import zlib

import gymnasium
import minigrid.wrappers
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


def pictures():
    for id in ("MiniGrid-Playground-v0", "MiniGrid-LavaGapS7-v0", "MiniGrid-LockedRoom-v0", "BabyAI-PutNextS5N2Carrying-v0"):
        for size in (1, 2, 3, 5, 8, 13, 16, 20, 31, 32, 48):
            for highlight, agent_pov in ((True, False), (False, False), (True, True)):
                env = gymnasium.make(id, render_mode="rgb_array", tile_size=size, highlight=highlight, agent_pov=agent_pov)
                env.reset(seed=size)
                state = size
                for _ in range(10):
                    state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
                    if any(env.step((state >> 33) % int(env.action_space.n))[2:4]):
                        env.reset()
                crc = zlib.crc32(np.ascontiguousarray(env.render()).tobytes())
                print(id, size, int(highlight), int(agent_pov), f"{crc:08x}")


def wrappers():
    wrapped = [
        ("ImgObsWrapper", {}),
        ("OneHotPartialObsWrapper", {}),
        ("FlatObsWrapper", {}),
        ("DictObservationSpaceWrapper", {}),
        ("FullyObsWrapper", {}),
        ("SymbolicObsWrapper", {}),
        ("ViewSizeWrapper", {"agent_view_size": 5}),
        ("RGBImgObsWrapper", {"tile_size": 6}),
        ("RGBImgPartialObsWrapper", {}),
        ("DirectionObsWrapper", {"type": "slope"}),
        ("DirectionObsWrapper", {"type": "angle"}),
        ("DirectionObsWrapper", {"type": "angle_atan2"}),
        ("ActionBonus", {}),
        ("PositionBonus", {"scale": 0.5}),
        ("NoDeath", {"no_death_types": ["lava"], "death_cost": -0.5}),
        ("StochasticActionWrapper", {"prob": 0.6}),
        ("StochasticActionWrapper", {"prob": 0.6, "random_action": 2}),
        ("ReseedWrapper", {"seeds": [3, 4], "seed_idx": 1}),
    ]
    for id in ("MiniGrid-LavaCrossingS9N2-v0", "MiniGrid-DoorKey-6x6-v0", "MiniGrid-MultiRoom-N2-S4-v0", "MiniGrid-Fetch-8x8-N3-v0"):
        for name, kwargs in wrapped:
            if id.startswith("MiniGrid-Fetch") and name == "DirectionObsWrapper":
                continue  # there is no goal
            env = getattr(minigrid.wrappers, name)(gymnasium.make(id), **kwargs)
            crc, state = 0, 9

            def see(observation):
                nonlocal crc
                parts = [observation[key] for key in sorted(observation)] if isinstance(observation, dict) else [observation]
                for part in parts:
                    data = part.encode() if isinstance(part, str) else np.ascontiguousarray(part).tobytes()
                    crc = zlib.crc32(data, crc)

            see(env.reset(seed=9)[0])
            for _ in range(60):
                state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
                observation, reward, terminated, truncated, _ = env.step((state >> 33) % int(env.action_space.n))
                see(observation)
                crc = zlib.crc32(np.float64(reward).tobytes() + bytes([terminated, truncated]), crc)
                if terminated or truncated:
                    see(env.reset()[0])
            print(id, name, json.dumps(kwargs, separators=(",", ":")), f"{crc:08x}")


def limits(id):
    env = gymnasium.make(id).unwrapped
    found = [id]
    for seed in range(3):
        env.reset(seed=seed)
        found.append(str(env.max_steps))
    return " ".join(found)


def main():
    if "--pictures" in sys.argv:
        return pictures()
    if "--wrappers" in sys.argv:
        return wrappers()
    ids = [id for id in sorted(gymnasium.registry) if id.startswith(("MiniGrid-", "BabyAI-")) and "-WFC-" not in id]
    stdout, sys.stdout = sys.stdout, sys.stderr  # minigrid prints
    if "--limits" in sys.argv:
        for id in ids:
            print(limits(id), file=stdout)
        return None
    every = "--all" in sys.argv
    seeds, steps, *words = [word for word in sys.argv[1:] if word != "--all"]
    for seed in map(int, seeds.split(",")):
        for id in ids:
            if not words or words[0] in id:
                print(record(id, seed, int(steps), every), file=stdout, flush=True)


if __name__ == "__main__":
    main()
