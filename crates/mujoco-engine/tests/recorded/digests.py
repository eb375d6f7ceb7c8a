"""What the recorders of steps share."""
import os
import pathlib
import struct
import sys
import tempfile


def added(digest, numbers):
    """A digest with more numbers: FNV-1a, with a word in place of a byte."""
    for number in numbers:
        digest = (digest ^ struct.unpack("<Q", struct.pack("<d", number))[0]) * 0x100000001B3 % 2**64
    return digest


def of_numbers(numbers):
    return added(0xCBF29CE484222325, numbers)


def state(data):
    """The positions, velocities, activations and sensors."""
    return [*data.qpos, *data.qvel, *data.act, *data.sensordata]


def of_steps(text, steps, start, drive):
    """The digest of the states of some steps of a model: ``start`` sets its first state, ``drive`` the controls of each; ``-`` if MuJoCo refuses it."""
    import mujoco
    import numpy as np

    random = np.random.RandomState(0)
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        print(text[:80], error, file=sys.stderr)
        return "-"
    data, digest = mujoco.MjData(model), of_numbers(())
    start(model, data, random)
    for _ in range(steps):
        drive(model, data, random)
        mujoco.mj_step(model, data)
        digest = added(digest, state(data))
    return f"{digest:016x}"


def of_lines(models, digest):
    """Prints the digest of each line of a file."""
    of_texts(pathlib.Path(models).read_text().splitlines(), digest)


def of_texts(texts, digest):
    """Prints the digest of each text."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # MuJoCo writes its warnings to the current folder
        print(*map(digest, texts), sep="\n")
