#!/usr/bin/env python3
"""Print digests of the positions and velocities over 200 steps, as `tests/it/sparse.rs` has them: `sparse.py [DENSE]`.

    pip install mujoco==3.12.0        repeat with 4.0.0 and 4.0.1
"""
import re
import struct
import sys
from pathlib import Path

import mujoco
import numpy as np

text = re.search(r'r#"(<mujoco>.*?)"#', (Path(__file__).parent.parent / "it/sparse.rs").read_text(), re.S)[1]
for options in (
    "",
    'cone="elliptic"',
    'solver="CG"',
    'solver="CG" cone="elliptic"',
    'solver="PGS"',
    'solver="PGS" cone="elliptic"',
    'noslip_iterations="4"',
    'noslip_iterations="4" cone="elliptic" impratio="5"',
):
    weld = options in ('cone="elliptic"', 'solver="PGS"')
    changed = text.replace("{options}", options).replace("{weld}", str(weld).lower())
    if len(sys.argv) > 1:
        changed = changed.replace('jacobian="sparse"', "")
    model = mujoco.MjModel.from_xml_string(changed)
    data, random = mujoco.MjData(model), np.random.RandomState(0)
    digest, kinds, rows = 0xCBF29CE484222325, set(), 0
    for _ in range(200):
        data.ctrl[:] = [random.uniform(-1, 1) for _ in range(model.nu)]
        mujoco.mj_step(model, data)
        rows = max(rows, data.nefc)
        kinds |= set(data.efc_type.tolist())
        for number in np.concatenate([data.qpos, data.qvel]):
            digest = (digest ^ struct.unpack("<Q", struct.pack("<d", number))[0]) * 0x100000001B3 % 2**64
    print(mujoco.__version__, options, weld, f"{digest:016x}", rows, sorted(kinds), data.nisland)
