#!/usr/bin/env python3
"""Print a digest of the triangles that faces of OBJ files are cut into, as `tests/it/polygons.rs` has it.

    pip install mujoco==3.12.0        repeat with 3.17.0, 4.0.0 and 4.0.1
"""
import math

import mujoco
import numpy as np

MODEL = """<mujoco><asset><mesh name="m" file="{}" inertia="shell"/></asset><worldbody><body>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


def lines(seed):
    random = np.random.RandomState(seed)
    n, side = 4 + int(random.uniform(0, 5)), 2 + math.floor(random.uniform(0, 4))
    for _ in range(n):
        x, y = math.floor(random.uniform(0, side)), math.floor(random.uniform(0, side))
        yield f"v {x} {y} {x + 2 * y}"
    yield from ["v 0 0 -9", "v 5 0 9", "v 0 5 9", "v -5 -5 9"]
    yield " ".join(["f", *map(str, range(1, n + 1))])
    for face in [(1, 2, 3), (1, 4, 2), (1, 3, 4), (2, 4, 3)]:
        yield "f {} {} {}".format(*(n + k for k in face))


digest = 0xCBF29CE484222325
for seed in range(400):
    # libmujoco keeps meshes by their names
    name = f"{seed}.obj"
    model = mujoco.MjModel.from_xml_string(MODEL.format(name), {name: "\n".join(lines(seed)).encode()})
    triangles = model.mesh_face.ravel().tolist()
    for word in [len(triangles), *triangles]:
        digest = (digest ^ word) * 0x100000001B3 % 2**64
print(mujoco.__version__, f"0x{digest:016x}")
