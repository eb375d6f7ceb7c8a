"""Times vectors of 16 Atari games here and in EnvPool, in turn, by CPU time, from Python on one thread: `atari_vectors.py [TITLE...]`.

Both preprocess as DQN does: 84x84 in gray, a skip of 4 frames, 4 stacked. Needs what `requirements.txt` names, ale-py for its ROMs, and
rustgym, built as docs/python/README.md says.
"""

import statistics
import sys

from timing import many, rate

import envpool
import numpy as np
import rustgym

GAMES = ["Breakout", "Pong", "Seaquest", "SpaceInvaders", "Qbert", "Enduro", "BeamRider", "MsPacman"]
AT_ONCE = 16
ROUNDS = 7

ratios = []
print("| game | rustgym | EnvPool |\n|---|---|---|")
for game in sys.argv[1:] or GAMES:
    ours = rustgym.make_vec(f"ALE/{game}-v5", AT_ONCE, kind="sync", preprocessing=True)
    theirs = envpool.make_gymnasium(f"{game}-v5", num_envs=AT_ONCE, num_threads=1, seed=0)
    assert ours.single_observation_space.shape == theirs.observation_space.shape == (4, 84, 84)
    count = min(int(ours.single_action_space.n), int(theirs.action_space.n))
    actions = np.random.default_rng(0).integers(count, size=(1000, AT_ONCE), dtype=np.int32)
    steps = [many(envs, actions) for envs in (ours, theirs)]
    pairs = [[rate(step, AT_ONCE, calls=10) for step in steps] for _ in range(ROUNDS)]
    ratios.append(statistics.median(a / b for a, b in pairs))
    a, b = (max(column) for column in zip(*pairs))
    print(f"| {game} | {a / 1000:.1f} k | {b / 1000:.1f} k ({ratios[-1]:.1f}x) |", flush=True)
print(f"{statistics.geometric_mean(ratios):.2f} times in the geometric mean")
