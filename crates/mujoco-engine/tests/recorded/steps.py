#!/usr/bin/env python3
"""Print a digest of the positions, velocities and sensors over 300 steps of each model of `tests/it/steps.rs`.

    pip install mujoco==3.12.0        repeat with 4.0.0
"""
import re
import struct
from pathlib import Path

import mujoco
import numpy as np

source = (Path(__file__).parent.parent / "it/steps.rs").read_text()
for name, text in re.findall(r'const (\w+): &str = r#"(<mujoco>.*?)"#', source, re.S):
    model = mujoco.MjModel.from_xml_string(text)
    data, random = mujoco.MjData(model), np.random.RandomState(0)
    digest, kinds = 0xCBF29CE484222325, set()
    for _ in range(300):
        data.ctrl[:] = [random.uniform(-1, 1) for _ in range(model.nu)]
        mujoco.mj_step(model, data)
        kinds |= {tuple(sorted(int(model.geom_type[g]) for g in contact.geom)) for contact in data.contact}
        for number in np.concatenate([data.qpos, data.qvel, data.sensordata]):
            digest = (digest ^ struct.unpack("<Q", struct.pack("<d", number))[0]) * 0x100000001B3 % 2**64
    print(mujoco.__version__, name, f"{digest:016x}", sorted(kinds), data.ncon)
