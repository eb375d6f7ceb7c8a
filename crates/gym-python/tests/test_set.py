"""Attributes that are set: before the first reset, one after the other, in each environment of a vector."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same
from test_live import WAYS

import rustgym


OF_BOX2D = ["CarRacing-v3", "BipedalWalker-v3", "LunarLander-v3"]


@pytest.mark.parametrize("env_id", [*OF_BOX2D, "CartPole-v1", "Taxi-v4", "Blackjack-v1"])
def test_what_is_set_before_the_first_reset_is_overwritten_where_gymnasium_overwrites_it(env_id: str) -> None:
    if env_id in OF_BOX2D:
        pytest.importorskip("Box2D")

    def seen(env: Any, name: str) -> Any:
        value = getattr(env, name, "absent")
        return value if isinstance(value, bool | int | float | str | None) else type(value)

    early = rustgym.Env(env_id)
    values = {name: getattr(early, name, "absent") for name in dir(type(early)) if not name.startswith("_")}
    for name in [name for name, value in values.items() if isinstance(value, bool | float | None)]:
        results = []
        for module in (rustgym, gymnasium):
            env = module.make(env_id, disable_env_checker=True).unwrapped
            try:
                setattr(env, name, not values[name] if isinstance(values[name], bool) else 2.5)
            except (AttributeError, TypeError, ValueError):
                break  # ours refuses it
            before = seen(env, name)
            env.reset(seed=3)
            results.append((before, seen(env, name)))
        assert len(results) < 2 or results[0] == results[1], name


TUNABLE = ["Acrobot-v1", "CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "LunarLander-v3"]


@pytest.mark.parametrize("env_id", TUNABLE)
def test_arguments_are_those_that_were_set(env_id: str) -> None:
    arguments = rustgym.Env(env_id).arguments
    for name in arguments.keys() - rustgym.Env(env_id)._constants:
        value = arguments[name]
        if isinstance(value, list | tuple | float):
            env: Any = rustgym.Env(env_id)
            env.reset(seed=1)
            other = value * 0.5 if isinstance(value, float) else [part * 0.5 for part in value]
            setattr(env, name, other)
            for twin in (env, *(WAYS[way](env) for way in WAYS)):
                assert_same([twin.arguments[name], getattr(twin, name)], [other, other], name)


def test_a_changed_table_needs_a_reset_too() -> None:
    for env_id in ("FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"):
        env: Any = rustgym.Env(env_id)
        env.P[0] = {action: [(1.0, 1, 5.0, False)] for action in env.P[0]}
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(0)


def test_a_taxi_points_where_it_was_driven_by_a_changed_table() -> None:
    results = []
    for module in (rustgym, gymnasium):
        env = module.make("Taxi-v4", render_mode="rgb_array", disable_env_checker=True).unwrapped
        env.reset(seed=3)
        env.render()
        for state in range(500):
            env.P[state] = {action: [(1.0, (state + 20) % 500, 0.5, False)] for action in range(6)}
        results.append([])
        for action in (0, 3, 1, 2, 5, 4, 0):
            results[-1].append([*env.step(action)[:4]])
            env.render()
            results[-1].append(env.taxi_orientation)
    assert_same(*results)


@pytest.mark.parametrize("kind", ["sync", "async"])
@pytest.mark.parametrize("way", ["deep copy", "pickle"])
@pytest.mark.parametrize(
    ("env_id", "name"),
    [
        ("Acrobot-v1", "LINK_MASS_1"),
        ("CartPole-v1", "gravity"),
        ("MountainCar-v0", "gravity"),
        ("MountainCarContinuous-v0", "power"),
        ("Pendulum-v1", "g"),
    ],
)
def test_arguments_of_each_environment_of_a_vector_are_copied(env_id: str, name: str, way: str, kind: str) -> None:
    envs = rustgym.VectorEnv(env_id, 2, kind=kind)
    envs.reset(seed=1)
    values = [1.25 * value for value in envs.get_attr(name)]
    values[1] *= 1.25
    envs.set_attr(name, values)
    twin = WAYS[way](envs)
    assert list(twin.get_attr(name)) == list(envs.get_attr(name)) == values
    for _ in range(2):
        action = envs.action_space.sample()
        assert_same(twin.step(action)[:4], envs.step(action)[:4])
        twin = WAYS[way](twin)
    assert_same(twin.reset()[0], envs.reset()[0])


def test_flags_that_are_set_one_after_the_other_hold_together() -> None:
    for order in (("natural", "sab"), ("sab", "natural")):
        made: Any = rustgym.Env("Blackjack-v1", natural=True, sab=True)
        env: Any = rustgym.Env("Blackjack-v1")
        for e in (made, env):
            e.reset(seed=5)
        for name in order:
            setattr(env, name, True)
        assert env._native.arguments() == made._native.arguments() and env.arguments == made.arguments
        for seed in range(20):
            assert_same(env.reset(seed=seed), made.reset(seed=seed))
            assert_same(env.step(1), made.step(1))


def test_colours_that_are_set_are_those_that_are_changed_in_place() -> None:
    colour = np.array([10, 20, 30])
    for name in ("bg_color", "grass_color", "road_color"):
        env, other = (rustgym.make("CarRacing-v3").unwrapped for _ in range(2))
        for e in (env, other):
            e.reset(seed=1)
        setattr(env, name, colour.copy())
        getattr(other, name)[:] = colour
        assert_same(env.reset(seed=1)[0], other.reset(seed=1)[0], name)
        assert_same(getattr(env, name), colour, name)
