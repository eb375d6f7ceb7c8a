"""What no environment can take: each is refused in a few words that name the fault, and changes nothing."""

from __future__ import annotations

import base64
import itertools
import json
import re
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym


class Nested:
    """A list of itself, made anew at each look."""

    def __iter__(self) -> Any:
        return iter([self])


def deep(levels: int) -> list[Any]:
    value: list[Any] = []
    for _ in range(levels):
        value = [value]
    return value


@pytest.mark.parametrize(
    ("value", "wrong"),
    [
        (b"\xff", "UTF-8"),
        ("\ud800", "UTF-8"),
        (itertools.count(), "at most 1000000 items"),
        (Nested(), "must not contain itself"),
        (deep(5000), "nested too deeply"),
        (deep(300), "nested"),
        (10**400, "beyond 1.8e308"),
        (float("nan"), "finite"),
    ],
    ids=["bytes", "half a pair", "endless", "of itself", "deep", "less deep", "huge", "nan"],
)
def test_an_argument_that_cannot_be_sent_is_refused_in_words(value: Any, wrong: str) -> None:
    for give in (
        lambda: rustgym.Env("PointMaze_UMaze-v3", camera_name=value),
        lambda: rustgym.VectorEnv("PointMaze_UMaze-v3", 2, camera_name=value),
        lambda: rustgym.Env("CartPole-v1").reset(seed=0, options={"low": value, "high": 0.1}),
    ):
        with pytest.raises(ValueError, match=wrong) as raised:
            give()
        text = str(raised.value)
        assert " column " not in text and len(text) < 300, text


@pytest.mark.parametrize(
    "value", ["x" * 100_000, deep(5000), np.zeros((900, 900)), list(range(10_000))], ids=["text", "deep", "array", "list"]
)
def test_no_message_repeats_a_long_value(value: Any) -> None:
    env: Any = rustgym.make("CartPole-v1").unwrapped
    vector: Any = rustgym.VectorEnv
    env.reset(seed=0)
    for give in (
        lambda: env.reset(seed=value),
        lambda: env.reset(options=[value]),
        lambda: env.set_state([value]),
        lambda: env.step(value),
        lambda: vector("CartPole-v1", 2).step(value),
        lambda: vector("CartPole-v1", value),
        lambda: vector("CartPole-v1", 2, kind=[value]),
        lambda: vector("CartPole-v1", 2, autoreset_mode=value),
        lambda: vector("CartPole-v1", 2, render_size=value),
        lambda: vector("CartPole-v1", 2, arg_each=[value]),
        lambda: vector("CartPole-v1", 2).reset(seed=[value, 0]),
        lambda: setattr(rustgym.Env("CartPole-v1"), "gravity", value),
    ):
        with pytest.raises((TypeError, ValueError, AttributeError, gymnasium.error.Error)) as raised:
            give()
        assert len(str(raised.value)) < 500, str(raised.value)[:600]


@pytest.mark.parametrize(("name", "value"), [("gray", "no"), ("seeds", 3), ("render_size", 5), ("render_size", (1, 2, 3))])
def test_a_setting_of_a_vector_of_the_wrong_kind_is_named(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=f"^{name} is {re.escape(repr(value))}: it must be "):
        rustgym.VectorEnv("CartPole-v1", 2, **{name: value})


AT_LEAST = [("num_envs", 1), ("threads", 1), ("affinity", 0), ("max_episode_steps", -1), ("frame_stack", 0), ("render_size", 1)]


@pytest.mark.parametrize(("name", "least"), AT_LEAST)
def test_whole_settings_of_a_vector_have_a_least(name: str, least: int) -> None:
    def refused(number: Any) -> str:
        given = {"num_envs": 2, "kind": "async" if name in ("threads", "affinity") else None, name: number}
        with pytest.raises((ValueError, TypeError)) as raised:
            rustgym.VectorEnv("CartPole-v1", **given)
        return str(raised.value)

    pair = name == "render_size"
    for number in (least - 1, least - 7):
        for given in [(number, 8), (8, number)] if pair else [number]:
            assert refused(given) == f"{name} is {number}: it must be at least {least}"
    for number in (2.5, "2", [2]):
        assert refused((8, number) if pair else number) == f"{name} is {number!r}: it must be a whole number"
    assert refused((8, 1 << 63) if pair else 1 << 63) == f"{name} is {1 << 63}: that is too many"
    rustgym.VectorEnv("CartPole-v1", **{"num_envs": 2, "kind": "async", name: (least, least) if pair else least})


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"copy": 1}, "copy is 1: it must be True or False"),
        ({"gray": "yes"}, "gray is 'yes': it must be True or False"),
        ({"kind": 3}, "kind is 3: it must be a text or None"),
        ({"render_mode": 3}, "render_mode is 3: it must be a text or None"),
        ({"autoreset_mode": "Next"}, "autoreset_mode is 'Next': it must be one of NextStep, SameStep, Disabled"),
        ({"arg_each": 3}, "arg_each must be a dict of arguments, not 3"),
        ({"arg_each": {"gravity": 3.0}}, "arg_each has 3.0 for gravity: it takes a list with a value for each environment, or a pair (low, high)"),
        ({"arg_each": {"gravity": "ab"}}, "arg_each has 'ab' for gravity: it takes a list with a value for each environment, or a pair (low, high)"),
        ({"arg_each": {"foo": [1, 2]}}, "arg_each has the key 'foo', which is not an argument of CartPole-v1"),
        ({"arg_each": {"tau": [0.1], "gravity": [1.0, 2.0]}}, "invalid argument for tau: there are 1 values for 2 environments"),
        ({"max_episode_steps": 0}, "invalid argument for `CartPole-v1`: max_episode_steps is 0: it must be at least 1, or -1 for no limit"),
        ({"gray": True, "render_mode": "human"}, "observations of pixels need render_mode=\"rgb_array\", not 'human'"),
        ({"preprocessing": True}, "preprocessing needs an Atari game, and CartPole-v1 is not one"),
        ({"kind": "fast"}, "invalid argument for kind: unknown kind of vector `fast`: the kinds are sync, async, native"),
    ],
)
def test_a_setting_of_a_vector_that_cannot_be_is_refused_in_full(given: dict[str, Any], text: str) -> None:
    with pytest.raises((ValueError, TypeError, gymnasium.error.Error)) as raised:
        rustgym.VectorEnv("CartPole-v1", 2, **given)
    assert str(raised.value) == text


@pytest.mark.parametrize(("env_id", "name", "value"), [("CartPole-v1", "steps_beyond_terminated", 3), ("Pendulum-v1", "last_u", 0.5)])
def test_a_part_of_a_state_is_not_set_before_there_is_one(env_id: str, name: str, value: Any) -> None:
    env = rustgym.Env(env_id)
    with pytest.raises(AttributeError, match=f"^{env_id} has no state before the first reset$"):
        setattr(env, name, value)
    env.reset(seed=0)
    setattr(env, name, value)
    assert getattr(env, name) == value


def test_a_kitchen_counts_the_tasks_that_are_left() -> None:
    reward = rustgym.envs.KitchenEnv.compute_reward
    goal = {"kettle": np.array([0.0, 1.0]), "microwave": np.array([0.5]), "light switch": np.array([1.0])}
    near = {"kettle": np.array([0.0, 1.29]), "microwave": np.array([0.5]), "light switch": np.array([1.31])}
    for tasks, expected in ((["kettle", "microwave", "light switch"], 2.0), (["kettle"], 1.0), (["light switch"], 0.0), ([], 0.0)):
        found = reward(None, near, goal, {"tasks_to_complete": tasks})  # type: ignore[arg-type]
        assert found == expected and type(found) is float
    assert reward(None, {"kettle": np.array([0.3])}, {"kettle": np.array([0.0])}, {"tasks_to_complete": ["kettle"]}) == 0.0  # type: ignore[arg-type]


def test_the_id_of_an_environment_stays() -> None:
    env: Any = rustgym.Env("MiniGrid-Empty-5x5-v0")
    env.reset(seed=0)
    with pytest.raises(AttributeError, match="^env_id of MiniGrid-Empty-5x5-v0 is '.*' and cannot be set$"):
        env.env_id = "CartPole-v1"
    del env.env_id
    with pytest.raises(AttributeError, match="has lost its env_id"):
        _ = env.nothing


def test_a_step_after_an_end_without_autoreset_names_the_call() -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 2, max_episode_steps=1, autoreset_mode="Disabled")
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    with pytest.raises(gymnasium.error.Error, match="call `reset` with the option `reset_mask`$"):
        envs.step(envs.action_space.sample())
    envs.reset(options={"reset_mask": np.array([True, True])})
    envs.step(envs.action_space.sample())


def test_numbers_beyond_their_type_are_told_the_largest() -> None:
    with pytest.raises(ValueError, match="`max_steps`.*expected at most 4294967295$"):
        rustgym.Env("MiniGrid-Empty-5x5-v0", max_steps=10**12)
    with pytest.raises(ValueError, match="`render_mode`|`dtype`.*expected a text$"):
        rustgym.Env("dm_control/cartpole-balance-v0", dtype=256)
    with pytest.raises(ValueError, match="`default_camera_config`.*expected a map$"):
        rustgym.Env("Hopper-v5", default_camera_config=3)


@pytest.mark.parametrize(
    ("env_id", "part", "name", "value", "wrong"),
    [
        ("LunarLander-v3", "lander", "linearVelocity", (float("nan"), 0.0), r"^velocity\[0\] is nan: every number"),
        ("BipedalWalker-v3", "hull", "angularVelocity", float("inf"), "^angular_velocity is inf: every number"),
        ("LunarLander-v3", "lander", "linearVelocity", (1e38, 0.0), "^LunarLander-v3 cannot go on from what was set: "),
    ],
)
def test_a_body_that_cannot_be_is_refused_by_its_name(env_id: str, part: str, name: str, value: Any, wrong: str) -> None:
    env, other = rustgym.Env(env_id), rustgym.Env(env_id)
    for e in (env, other):
        e.reset(seed=3)
    with pytest.raises(ValueError, match=wrong):
        setattr(getattr(env, part), name, value)
    action = other.action_space.sample()
    assert_same(env.step(action)[:4], other.step(action)[:4])


def test_data_that_is_not_finite_is_refused_by_its_name() -> None:
    for value, wrong in ((float("nan"), r"^qvel\[0\] is nan: every number"), (1e300, "cannot go on from what was set")):
        env: Any = rustgym.Env("Hopper-v5")
        env.reset(seed=1)
        env.data.qvel[0] = value
        with pytest.raises(ValueError, match=wrong):
            env.step(env.action_space.sample())


def test_a_damaged_state_of_mujocos_package_changes_nothing() -> None:
    mujoco = pytest.importorskip("mujoco")
    version = ".".join(mujoco.__version__.split(".")[:2])

    def handed(env_id: str) -> Any:
        env: Any = rustgym.Env(env_id, mujoco=version)
        env.reset(seed=1)
        env.model.body_mass[1] *= 2.0
        env.step(np.zeros(env.action_space.shape, np.float32))
        return env

    env = handed("Hopper-v5")
    sound, other = json.loads(env.get_state()), json.loads(handed("Ant-v5").get_state())
    parts = sound["mujoco"]
    damaged: list[tuple[Any, str]] = [
        ('{"config":', "EOF|column"),
        ({"mujoco": {}, "native": sound["native"]}, "damaged"),
        ({"mujoco": None, "native": None}, "damaged"),
        ({"mujoco": {**parts, "model": "xx"}, "native": sound["native"]}, "damaged"),
        ({"mujoco": {**parts, "state": parts["state"][:16]}, "native": sound["native"]}, "damaged"),
        ({"mujoco": {**parts, "arrays": {"nothing": "AAAA"}}, "native": sound["native"]}, "damaged"),
        ({"mujoco": other["mujoco"], "native": sound["native"]}, "another model"),
        ({"mujoco": parts, "native": other["native"]}, "Hopper|other arguments"),
        ({"mujoco": parts}, "expected a map"),
    ]
    for state, wrong in damaged:
        fresh: Any = rustgym.Env("Hopper-v5", mujoco=version)
        twin = rustgym.Env("Hopper-v5", mujoco=version)
        for e in (fresh, twin):
            e.reset(seed=2)
        with pytest.raises(ValueError, match=wrong) as raised:
            fresh.set_state(state if isinstance(state, str) else json.dumps(state))
        assert str(raised.value).startswith("cannot restore this snapshot: ")
        assert not fresh._is_handed
        action = np.full(3, 0.5, np.float32)
        assert_same(fresh.step(action)[:4], twin.step(action)[:4])
    fresh.set_state(json.dumps(sound))
    action = np.full(3, 0.25, np.float32)
    assert_same(fresh.step(action)[:4], env.step(action)[:4])
    assert base64.b64decode(parts["model"])


def test_what_has_diverged_in_mujocos_package_is_stored() -> None:
    mujoco = pytest.importorskip("mujoco")
    version = ".".join(mujoco.__version__.split(".")[:2])
    env: Any = rustgym.Env("Hopper-v5", mujoco=version)
    env.reset(seed=1)
    env.model.body_mass[1] *= 2.0
    env.step(env.action_space.sample())
    env.data.qvel[:] = np.nan
    twin: Any = rustgym.Env("Hopper-v5", mujoco=version)
    twin.set_state(env.get_state())
    assert np.isnan(twin.data.qvel).all()
    action = np.full(3, 0.5, np.float32)
    assert_same(twin.step(action)[:4], env.step(action)[:4])


REFUSED_RESETS: list[tuple[str, dict[str, Any]]] = [
    ("CartPole-v1", {"low": 0.5, "high": -0.5}),
    ("CartPole-v1", {"low": "a"}),
    ("Pendulum-v1", {"x_init": "a"}),
    ("MountainCar-v0", {"low": 0.5, "high": -0.5}),
    ("PointMaze_UMaze-v3", {"goal_cell": [0, 0]}),
]


@pytest.mark.parametrize(("env_id", "options"), REFUSED_RESETS)
def test_after_a_reset_that_was_refused_there_is_no_episode(env_id: str, options: dict[str, Any]) -> None:
    env, twin = rustgym.Env(env_id), rustgym.Env(env_id)
    for e in (env, twin):
        e.reset(seed=1)
    with pytest.raises(Exception):  # noqa: B017 - of Gymnasium's kind
        env.reset(options=options)
    action = env.action_space.sample()
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(action)
    for e in (env, twin):
        e.reset(seed=2)
    assert_same(env.step(action), twin.step(action))
