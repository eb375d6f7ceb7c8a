"""Bodies that bounce in slots, are wedged in, turn and fall fast, as pybox2d 2.3.10 moves them: writes `tight.json` beside this file.

Needs `pip install box2d==2.3.10`; the test `bodies_in_tight_places_move_as_box2ds` compares with it.
"""

import json
import struct
from pathlib import Path

import Box2D


def bits(x: float) -> int:
    return struct.unpack("<I", struct.pack("<f", x))[0]


world = Box2D.b2World(gravity=(0.0, -10.0))
ground = world.CreateStaticBody(position=(0.0, 0.0))
bodies = []
# each in a slot of its own, from a wide one to one that is narrower than the body
for i in range(10):
    x, width = 8.0 * i, 0.95 + 0.03 * (i - 3)
    for ends in [
        ((x - 0.5 * width, 0.0), (x - 0.5 * width, 6.0)),
        ((x + 0.5 * width, 0.0), (x + 0.5 * width, 6.0)),
        ((x - 3.0, 0.0), (x + 3.0, 0.0)),
        ((x - 3.0, 6.0), (x + 3.0, 6.0)),
    ]:
        ground.CreateFixture(shape=Box2D.b2EdgeShape(vertices=list(ends)), friction=0.05 * i)
    body = world.CreateDynamicBody(position=(x, 2.0 if i % 3 else 0.45))
    if i % 2 == 0:
        shape = Box2D.b2CircleShape(radius=0.45)
    else:
        shape = Box2D.b2PolygonShape(box=(0.45, 0.4))
    body.CreateFixture(shape=shape, density=1.0, friction=0.1, restitution=1.0 if i < 8 else 0.0)
    if i < 8:
        body.linearVelocity = (37.0 * i, 5.0 - 20.0 * i)
        body.angularVelocity = 0.0 if i < 4 else 60.0 * i
    bodies.append(body)
steps = []
for step in range(1, 201):
    world.Step(0.02, 8, 3)
    if step % 10 == 0 or step <= 20:
        numbers = [(*b.position, b.angle, *b.linearVelocity, b.angularVelocity) for b in bodies]
        steps.append([step, [[bits(x) for x in of] for of in numbers], [b.awake for b in bodies]])
Path(__file__).with_suffix(".json").write_text(json.dumps(steps, separators=(",", ":")) + "\n")
