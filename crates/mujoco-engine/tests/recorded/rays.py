#!/usr/bin/env python3
"""Print a digest of the distances of random rays, as `tests/it/rays.rs` has it.

    pip install mujoco==3.12.0        repeat with 4.0.0
"""
import re
import struct
from pathlib import Path

import mujoco
import numpy as np

text = re.search(r'r#"(<mujoco>.*?)"#', (Path(__file__).parent.parent / "it/rays.rs").read_text(), re.S)[1]
model = mujoco.MjModel.from_xml_string(text)
data, random = mujoco.MjData(model), np.random.RandomState(0)
mujoco.mj_forward(model, data)
digest, geoms, geom = 0xCBF29CE484222325, [0] * (model.ngeom + 1), np.zeros(1, np.int32)
for _ in range(2000):
    point = np.array([random.uniform(-1.5, 1.5) for _ in range(3)])
    along = np.array([random.uniform(-1, 1) for _ in range(3)])
    if random.uniform(0, 1) < 0.3:
        along[int(random.uniform(0, 3))] = 0
    distance = mujoco.mj_ray(model, data, point, along, None, 1, -1, geom)
    geoms[geom[0]] += 1
    for word in (struct.unpack("<Q", struct.pack("<d", distance))[0], int(geom[0]) % 2**64):
        digest = (digest ^ word) * 0x100000001B3 % 2**64
print(mujoco.__version__, f"{digest:016x}", geoms, data.sensordata.tolist())
