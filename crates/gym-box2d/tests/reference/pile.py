"""Bodies of every shape that fall upon each other, as pybox2d 2.3.10 moves them: writes `pile.json` beside this file.

Needs `pip install box2d==2.3.10`; the test `a_pile_falls_as_box2ds` compares with it.
"""

import json
import struct
from pathlib import Path

import Box2D


def bits(x: float) -> int:
    return struct.unpack("<I", struct.pack("<f", x))[0]


world = Box2D.b2World(gravity=(0.0, -10.0))
ground = world.CreateStaticBody(position=(0.0, 0.0))
for ends in [((-4.0, 2.0), (0.0, 0.0)), ((0.0, 0.0), (4.0, 2.0))]:
    ground.CreateFixture(shape=Box2D.b2EdgeShape(vertices=list(ends)), friction=0.4)
bodies = []
for i in range(12):
    position = ((i % 4) * 0.9 - 1.3 + 0.07 * i, 1.5 + (i // 4) * 1.1)
    body = world.CreateDynamicBody(position=position, angle=0.2 * i)
    shape = [
        Box2D.b2PolygonShape(box=(0.3 + 0.02 * i, 0.25)),
        Box2D.b2CircleShape(radius=0.3),
        Box2D.b2PolygonShape(vertices=[(-0.35, -0.25), (0.35, -0.3), (0.05, 0.4)]),
    ][i % 3]
    body.CreateFixture(shape=shape, density=1.0 + 0.5 * i, friction=0.1 * i, restitution=0.05 * i)
    body.linearVelocity = (0.5 * i - 2.0, -0.3 * i)
    bodies.append(body)
for a, b in [(4, 5), (8, 9)]:
    world.CreateRevoluteJoint(
        bodyA=bodies[a], bodyB=bodies[b], localAnchorA=(0.45, 0.0), localAnchorB=(-0.45, 0.0), enableLimit=True,
        lowerAngle=-0.5, upperAngle=0.7, enableMotor=True, motorSpeed=2.0, maxMotorTorque=1.5, collideConnected=a == 8,
    )
steps = []
for step in range(1, 301):
    world.Step(0.02, 8, 3)
    if step % 10 == 0 or step <= 20:
        steps.append([step, [[bits(x) for x in (*b.position, b.angle, *b.linearVelocity, b.angularVelocity)] for b in bodies]])
Path(__file__).with_suffix(".json").write_text(json.dumps(steps, separators=(",", ":")) + "\n")
print(sum(not b.awake for b in bodies), "asleep")
