"""Times games of the Atari 2600 here and in ale-py, in turn, by CPU time: `atari.py [GAME...]`.

Frames: ale-py's `act`, no picture taken. Steps: 84x84 in gray, a skip of 4 frames, 4 stacked, by Gymnasium's `AtariPreprocessing` and
`FrameStackObservation`. Needs ale-py, opencv-python-headless, and

    cargo build --release --package gym-atari --examples
"""

import os
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import ale_py
import cv2
import gymnasium

EXAMPLES = Path(__file__).parents[2] / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / "examples"
ROMS = Path(ale_py.__file__).parent / "roms"
GAMES = ["breakout", "pong", "seaquest", "space_invaders", "qbert", "enduro", "beam_rider", "ms_pacman"]
PAIRS = 5


def actions(n, count):
    """Iterates over `n` random actions: the same actions as in the Rust examples."""
    random = 1
    for _ in range(n):
        random = (random * 1664525 + 1013904223) & 0xFFFFFFFF
        yield (random >> 16) % count


def ours(what, game, n):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "ALE_ROMS_DIR": str(ROMS)}
    subprocess.run([EXAMPLES / "speed", what, str(n), game], check=True, stdout=subprocess.DEVNULL, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return n / (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def frames(game, n):
    ale = ale_py.ALEInterface()
    ale.setFloat("repeat_action_probability", 0.0)
    ale.loadROM(str(ROMS / f"{game}.bin"))
    ale.reset_game()
    minimal = ale.getMinimalActionSet()
    chosen = [minimal[action] for action in actions(n, len(minimal))]
    start = time.process_time()
    for action in chosen:
        if ale.game_over():
            ale.reset_game()
        ale.act(action)
    return n / (time.process_time() - start)


def steps(game, n):
    title = "".join(word.capitalize() for word in game.split("_"))
    env = gymnasium.make(f"ALE/{title}-v5", frameskip=1, repeat_action_probability=0.0)
    env = gymnasium.wrappers.FrameStackObservation(gymnasium.wrappers.AtariPreprocessing(env), 4)
    env.reset(seed=1)
    start = time.process_time()
    for action in actions(n, env.action_space.n):
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
    return n / (time.process_time() - start)


def main():
    ale_py.ALEInterface.setLoggerMode(ale_py.LoggerMode.Error)
    gymnasium.register_envs(ale_py)
    cv2.setNumThreads(1)
    for what, theirs, n, their_n in [("frames", frames, 5000, 5000), ("steps", steps, 5000, 1500)]:
        ratios = []
        for game in sys.argv[1:] or GAMES:
            pairs = [(ours(what, game, n), theirs(game, their_n)) for _ in range(PAIRS)]
            ratios.append(statistics.median(a / b for a, b in pairs))
            a, b = (max(column) for column in zip(*pairs))
            print(f"{game:16} {what}: {a:8,.0f} here, {b:8,.0f} there, {ratios[-1]:.2f} times in the median pair", flush=True)
        print(f"{what}: {min(ratios):.2f} to {max(ratios):.2f} times, {statistics.geometric_mean(ratios):.2f} in the geometric mean")


if __name__ == "__main__":
    main()
