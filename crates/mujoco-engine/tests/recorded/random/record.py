#!/usr/bin/env python3
"""Record random models of `tests/peers/random_models.py`, and digests of their episodes, for the test `random`.

    pip install mujoco==4.0.0         draws models: python record.py --models NUMBER > models.txt
    pip install mujoco==3.12.0        python record.py > 3.12.txt; repeat with 3.17.0 and 4.0.0

A line of `models.txt` is a model. A line of the others is the digest of the positions, velocities, activations and sensors of 25 steps of that
model; `-` if MuJoCo refuses the model or its motion diverges, because a diverging motion amplifies differences in the last bit.
"""
import os
import pathlib
import sys
import tempfile

import mujoco
import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parent), str(FOLDER.parents[4] / "tests/peers")]
from digests import added, of_lines, of_numbers, state
from random_models import Writer, is_calm, steps

STEPS = 25


def digest(text):
    try:
        model = mujoco.MjModel.from_xml_string(text)
        data, digest = mujoco.MjData(model), of_numbers(())
        for _ in steps(model, data, 0, STEPS):
            digest = added(digest, state(data))
    except (ValueError, mujoco.FatalError):
        return "-"
    return f"{digest:016x}" if is_calm(data) else "-"


def draw(number):
    random, seen = np.random.RandomState(7), 0
    while seen < number:
        text = Writer(random).model()
        if digest(text) != "-":
            seen += 1
            print(text)


def main():
    if "--models" in sys.argv:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)  # MuJoCo writes its warnings to the current folder
            draw(int(sys.argv[-1]))
    else:
        of_lines(FOLDER / "models.txt", digest)


if __name__ == "__main__":
    main()
