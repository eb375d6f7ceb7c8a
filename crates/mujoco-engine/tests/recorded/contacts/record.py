#!/usr/bin/env python3
"""Record the contacts of two bodies in random poses, in most of which they touch: `record.py SEEDS [POSES] > NAME.txt`.

    pip install mujoco==3.12.0        repeat with 3.17.0, 4.0.0 and 4.0.1, and write their lines to other files

`SEEDS` is the number of seeds, counted from 0; each seed has `POSES` poses (50 by default). A line has the name and the text of a model; or
the name of a model, MuJoCo's version, a seed, the number of poses, and a digest of the contacts' geoms, distances, positions and frames.
In a pose, one body has a random place and orientation. The other is beside it, at a distance that is a sum of lengths of geoms, so that
sides touch up to rounding.
"""
import itertools
import math
import struct
import sys

import mujoco
import numpy as np

HALF = 0.7071067811865476
TURNS = [(1, 0, 0, 0), (HALF, HALF, 0, 0), (HALF, 0, HALF, 0), (HALF, 0, 0, HALF), (0, 1, 0, 0), (0.5, 0.5, 0.5, 0.5)]
LENGTHS = [0, 0.05, 0.1, 0.125, 0.2, 0.07]
BOX = '<geom type="box" size=".1 .125 .2"/>'
CAPSULE = '<geom type="capsule" size=".05 .2"/>'
SHAPES = {
    "sphere": '<geom type="sphere" size=".05"/>',
    "capsule": CAPSULE,
    "ellipsoid": '<geom type="ellipsoid" size=".05 .1 .125"/>',
    "cylinder": '<geom type="cylinder" size=".05 .2"/>',
    "box": '<geom type="box" size=".05 .1 .125"/>',
}


def corners(points):
    return " ".join(f"{x:.4g}" for point in points for x in point)


def pebble(count):
    """Points on an ellipsoid."""
    random = np.random.RandomState(1)
    for _ in range(count):
        x, y, z = (random.uniform(-1, 1) for _ in range(3))
        length = math.sqrt(x * x + y * y + z * z)
        yield 0.1 * x / length, 0.08 * y / length, 0.13 * z / length


def models():
    def two(first, second, world=""):
        bodies = "".join(f"<body><freejoint/>{geoms}</body>" for geoms in (first, second))
        return f"<mujoco><worldbody>{world}{bodies}</worldbody></mujoco>"

    yield "capsule-box-alone", two(BOX, CAPSULE)
    # the box has a neighbour, so that boxes around geoms are compared
    beside = '<geom type="sphere" size=".01" pos="0 0 2"/>'
    for name, shape in SHAPES.items():
        yield f"{name}-box", two(BOX + beside, shape)
    round_ones = ("sphere", "capsule", "ellipsoid", "cylinder")
    for first, second in itertools.combinations_with_replacement(round_ones, 2):
        for margin in ("0", ".01"):
            shapes = [SHAPES[name].replace("/>", f' margin="{margin}"/>') for name in (first, second)]
            yield f"{first}-{second}-{margin}", two(*shapes)
    peg = CAPSULE + '<geom type="capsule" size=".05 .07" pos="0 0 .2" quat="1 0 1 0"/>'
    slot = '<geom type="box" size=".1 .05 .2" pos=".2 0 0"/><geom type="box" size=".1 .05 .2" pos="-.2 0 0"/>'
    yield "peg-slot", two(slot, peg)
    floor = '<geom type="plane" size="5 5 .1" pos="0 0 .07" euler="{}"/>'
    meshes = {
        "tetrahedron": "0 0 0 .2 0 0 0 .2 0 0 0 .2",
        "block": corners((x, y, z) for x in (-0.1, 0.1) for y in (-0.125, 0.125) for z in (-0.2, 0.2)),
        "prism": corners((0.125 * math.cos(k * math.pi / 3), 0.125 * math.sin(k * math.pi / 3), z) for z in (-0.1, 0.1) for k in range(6)),
        "pebble": corners(pebble(40)),
    }
    # on a tip, four faces look down alike
    level = {**meshes, "octahedron": ".1 0 0 -.1 0 0 0 .1 0 0 -.1 0 0 0 .1 0 0 -.1"}

    def with_meshes(first, second, world="", option=""):
        heavy = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        bodies = "".join(f"<body><freejoint/>{heavy}{geoms}</body>" for geoms in (first, second))
        used = {name: vertices for name, vertices in level.items() if f'mesh="{name}"' in bodies}
        asset = "".join(f'<mesh name="{name}" inertia="shell" vertex="{vertices}"/>' for name, vertices in used.items())
        return f"<mujoco>{option}<asset>{asset}</asset><worldbody>{world}{bodies}</worldbody></mujoco>"

    def mesh(name, more=""):
        return f'<geom type="mesh" mesh="{name}"{more}/>'

    for name in meshes:
        for shape in SHAPES:
            yield f"{shape}-{name}", with_meshes(SHAPES[shape], mesh(name))
        yield f"floor-{name}", with_meshes(beside, mesh(name), floor.format("30 20 10"))
        yield f"pebble-{name}", with_meshes(mesh("pebble") + beside, mesh(name))
    yield "block-prism", with_meshes(mesh("block"), mesh("prism"))
    yield "block-prism-margin", with_meshes(mesh("block", ' margin=".01"'), mesh("prism", ' margin=".01" gap=".005"'))
    yield "block-prism-single", with_meshes(mesh("block"), mesh("prism"), option='<option><flag multiccd="disable"/></option>')
    field = '<hfield name="field" nrow="5" ncol="6" size=".7 .6 .2 .1" elevation="{}"/>'
    field = field.format(" ".join(f"{(7 * k * k + 3 * k) % 11}" for k in range(30)))
    ground = '<geom type="hfield" hfield="field" pos="0 0 -.1" euler="5 10 20"{}/>'
    for name, geom in [*SHAPES.items(), *((name, mesh(name)) for name in ("block", "pebble"))]:
        for margin in ("", ' margin=".02" gap=".01"'):
            text = with_meshes(beside, geom, ground.format(margin))
            yield f"field-{name}{'-margin' if margin else ''}", text.replace("<worldbody>", f"<asset>{field}</asset><worldbody>")
    for name in level:
        yield f"{name}-level", with_meshes(beside, mesh(name), floor.format("0 0 0"))
    for name, shape in SHAPES.items():
        yield f"{name}-floor", two(beside, shape, floor.format("0 0 0"))
        yield f"{name}-slope", two(beside, shape, floor.format("30 20 10"))


def turn(random):
    kind = random.uniform(0, 1)
    if kind < 0.7:
        return [float(x) for x in TURNS[int(random.uniform(0, len(TURNS)))]]
    quat = [random.uniform(-1, 1) for _ in range(4)]
    length = math.sqrt(quat[0] * quat[0] + quat[1] * quat[1] + quat[2] * quat[2] + quat[3] * quat[3])
    return [x / length for x in quat]


def place(random):
    """A sum or difference of two lengths, sometimes with noise."""
    first = LENGTHS[int(random.uniform(0, len(LENGTHS)))]
    second = LENGTHS[int(random.uniform(0, len(LENGTHS)))]
    if random.uniform(0, 1) < 0.5:
        first = -first
    if random.uniform(0, 1) < 0.5:
        second = -second
    noise = random.uniform(-0.1, 0.1) if random.uniform(0, 1) < 0.3 else 0.0
    return first + second + noise


def turned(quat, v):
    """The vector `v`, rotated by the quaternion `quat`."""
    w, x, y, z = quat
    tx, ty, tz = 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])
    return [v[0] + w * tx + (y * tz - z * ty), v[1] + w * ty + (z * tx - x * tz), v[2] + w * tz + (x * ty - y * tx)]


def product(p, q):
    return [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]


def pose(random):
    quat = turn(random)
    spot = [random.uniform(-1, 1) for _ in range(3)]
    centre = spot if random.uniform(0, 1) < 0.5 else [0.0] * 3
    away = turned(quat, [place(random) for _ in range(3)])
    other = product(quat, turn(random))
    return centre + quat + [centre[k] + away[k] for k in range(3)] + other


def words(d):
    yield d.ncon
    for contact in d.contact:
        yield from map(int, contact.geom)
        for x in [contact.dist, *contact.pos, *contact.frame]:
            yield struct.unpack("<Q", struct.pack("<d", float(x) + 0.0))[0]


def main():
    seeds, poses = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 50
    for name, text in models():
        m = mujoco.MjModel.from_xml_string(text)
        d = mujoco.MjData(m)
        print(name, text)
        for seed in range(seeds):
            random, digest = np.random.RandomState(seed), 0xCBF29CE484222325
            for _ in range(poses):
                d.qpos[:] = pose(random)
                mujoco.mj_fwdPosition(m, d)
                for word in words(d):
                    digest = (digest ^ word) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
            print(name, mujoco.__version__, seed, poses, f"{digest:016x}", flush=True)


main()
