#!/usr/bin/env python3
"""Print a digest of the frames of geoms and sites in random configurations, as `tests/it/frames.rs` has it.

    pip install mujoco==3.12.0        repeat with 4.0.0
"""
import re
import struct
from pathlib import Path

import mujoco
import numpy as np

text = re.search(r'r#"(<mujoco>.*?)"#', (Path(__file__).parent.parent / "it/frames.rs").read_text(), re.S)[1]
model = mujoco.MjModel.from_xml_string(text)
data, random = mujoco.MjData(model), np.random.RandomState(0)
digest = 0xCBF29CE484222325
for _ in range(50):
    data.qpos[:] = [random.uniform(-1, 1) for _ in range(model.nq)]
    mujoco.mj_kinematics(model, data)
    for number in np.concatenate([data.geom_xpos.ravel(), data.geom_xmat.ravel(), data.site_xpos.ravel(), data.site_xmat.ravel()]):
        word = struct.unpack("<Q", struct.pack("<d", number))[0]
        digest = (digest ^ word) * 0x100000001B3 % 2**64
print(mujoco.__version__, f"{digest:016x}", sorted(set(model.geom_sameframe)), sorted(set(model.site_sameframe)))
