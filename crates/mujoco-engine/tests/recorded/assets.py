#!/usr/bin/env python3
"""Print digests of the arrays of compiled models with meshes, as `tests/it/assets.rs` has them.

    pip install mujoco==3.12.0        repeat with 4.0.0
"""
import re
import struct
from pathlib import Path

import mujoco
import numpy as np

source = (Path(__file__).parent.parent / "it/assets.rs").read_text()
text = re.search(r'r#"(<mujoco>.*?)"#', source, re.S)[1]
groups = re.search(r"ARRAYS: .*? = \[(.*?)\];", source, re.S)[1].replace("\\\n", "")
for bounds in ["false", "true"]:
    model = mujoco.MjModel.from_xml_string(text.replace('fitaabb="false"', f'fitaabb="{bounds}"'))
    digests = []
    for group in re.findall(r'"(.*?)"', groups, re.S):
        digest = 0xCBF29CE484222325
        for name in group.split():
            numbers = np.asarray(getattr(model, name)).ravel()
            whole = np.issubdtype(numbers.dtype, np.integer)
            for number in numbers:
                word = int(number) % 2**64 if whole else struct.unpack("<Q", struct.pack("<d", number))[0]
                digest = (digest ^ word) * 0x100000001B3 % 2**64
        digests.append(f"0x{digest:016x}")
    print(mujoco.__version__, bounds, *digests)
