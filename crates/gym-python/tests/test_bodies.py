"""What bodies, joints and wheels say, beside those of Box2D itself in Gymnasium's environments."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest

import rustgym


def parts(env: Any) -> dict[str, Any]:
    """All bodies and joints of an environment, by name."""
    env = env.unwrapped
    if hasattr(env, "lander"):
        found = {"lander": env.lander, **{f"leg {i}": leg for i, leg in enumerate(env.legs)}}
    elif hasattr(env, "car"):
        found = {"hull": env.car.hull, **{f"wheel {i}": wheel for i, wheel in enumerate(env.car.wheels)}}
        found.update({f"joint {i}": wheel.joint for i, wheel in enumerate(env.car.wheels)})
    else:
        found = {"hull": env.hull, **{f"leg {i}": leg for i, leg in enumerate(env.legs)}}
        found.update({f"joint {i}": joint for i, joint in enumerate(env.joints)})
    return {**found, "world": env.world}


def properties(part: Any) -> list[str]:
    # (Box2D's package does not read the torque: the last test is for it)
    unread = ("joint", "maxMotorTorque")
    return [name for name in dir(type(part)) if isinstance(getattr(type(part), name), property) and name not in unread]


@pytest.mark.parametrize("env_id", ["LunarLander-v3", "LunarLanderContinuous-v3", "BipedalWalker-v3", "CarRacing-v3"])
def test_every_property_of_every_part_is_box2ds(env_id: str) -> None:
    pytest.importorskip("Box2D")
    ours, theirs = rustgym.make(env_id), gymnasium.make(env_id)
    seen: dict[str, set[Any]] = {}
    for seed in (0,) if env_id.startswith("Car") else (0, 5):
        ours.reset(seed=seed), theirs.reset(seed=seed)
        ours.action_space.seed(seed)
        for step in range(20 if env_id.startswith("Car") else 70):
            if step % 4 == 0:
                own, real = parts(ours), parts(theirs)
                assert own.keys() == real.keys()
                for name, part in own.items():
                    for word in properties(part):
                        found, expected = getattr(part, word), getattr(real[name], word)
                        found = tuple(found) if isinstance(found, tuple) else found
                        assert np.array_equal(found, np.asarray(expected)), f"{word} of {name} in step {step}: {found}, not {expected}"
                        seen.setdefault(f"{name}.{word}", set()).add(found)
            action = ours.action_space.sample()
            if any((ours.step(action)[2], theirs.step(action)[2])):
                break
    assert len(seen) > 20 and sum(len(values) > 4 for values in seen.values()) > 10
    ours.close(), theirs.close()


def test_motors_have_the_torques_that_gymnasium_sets() -> None:
    walker: Any = rustgym.make("BipedalWalker-v3").unwrapped
    walker.reset(seed=0)
    assert [joint.maxMotorTorque for joint in walker.joints] == [0.0] * 4, "a reset takes a step without forces"
    for action in (np.array([0.25, -0.5, 1.0, 0.0], np.float32), np.array([-1.0, 0.75, 0.0, 0.125], np.float32)):
        walker.step(action)
        assert [joint.maxMotorTorque for joint in walker.joints] == [80 * abs(float(part)) for part in action]
    racing: Any = rustgym.make("CarRacing-v3").unwrapped
    racing.reset(seed=0)
    assert [wheel.joint.maxMotorTorque for wheel in racing.car.wheels] == [float(np.float32(180 * 900 * 0.02 * 0.02))] * 4


CALLS = {
    "velocity": lambda body, x: setattr(body, "linearVelocity", (x, 0.0)),
    "angular velocity": lambda body, x: setattr(body, "angularVelocity", x),
    "force": lambda body, x: body.ApplyForceToCenter((x, 2.0 * x), True),
    "force asleep": lambda body, x: body.ApplyForceToCenter((x, 2.0 * x), False),
    "torque": lambda body, x: body.ApplyTorque(x, True),
    "torque asleep": lambda body, x: body.ApplyTorque(x, False),
    "impulse": lambda body, x: body.ApplyLinearImpulse((x, -x), (1.0, 2.0), True),
    "impulse asleep": lambda body, x: body.ApplyLinearImpulse((x, -x), (1.0, 2.0), False),
    "angular impulse": lambda body, x: body.ApplyAngularImpulse(x, True),
    "angular impulse asleep": lambda body, x: body.ApplyAngularImpulse(x, False),
}


@pytest.mark.parametrize("awake", [True, False])
@pytest.mark.parametrize("call", CALLS)
def test_a_push_wakes_a_body_where_box2d_wakes_it(call: str, awake: bool) -> None:
    pytest.importorskip("Box2D")
    for x in (0.0, 0.25, -3.0):
        ours, theirs = (module.make("LunarLander-v3").unwrapped for module in (rustgym, gymnasium))
        for env in (ours, theirs):
            env.reset(seed=2)
            env.step(0)
        if not awake:
            theirs.lander.awake = False
            # sleep stops a body
            ours.lander._move(wake=False, awake=False, velocity=[0.0, 0.0], angular_velocity=0.0)
        for body in (ours.lander, theirs.lander):
            CALLS[call](body, x)
        for word in ("awake", "linearVelocity", "angularVelocity"):
            assert np.array_equal(np.asarray(getattr(ours.lander, word)), np.asarray(getattr(theirs.lander, word))), (word, x)
        for results in zip(ours.step(0)[:4], theirs.step(0)[:4], strict=True):
            assert np.array_equal(*results), x


@pytest.mark.parametrize("env_id", ["BipedalWalker-v3", "BipedalWalkerHardcore-v3"])
def test_the_ground_has_gymnasiums_colours(env_id: str) -> None:
    pytest.importorskip("Box2D")
    ours, theirs = (module.make(env_id).unwrapped for module in (rustgym, gymnasium))
    for seed in (0, 1):
        for env in (ours, theirs):
            env.reset(seed=seed)
        colours = [[(piece.color1, piece.color2) for piece in env.terrain] for env in (ours, theirs)]
        assert colours[0] == colours[1] and len(set(colours[0])) > 1
