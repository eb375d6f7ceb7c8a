"""Actions keep their precision: the results equal Gymnasium's for each dtype of array and for lists."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same
from gymnasium.vector import SyncVectorEnv
from gymnasium.wrappers import ClipAction, RescaleAction

import rustgym

CLASSIC = ["MountainCarContinuous-v0", "Pendulum-v1"]
BOX2D = ["LunarLanderContinuous-v3", "BipedalWalker-v3"]
MUJOCO = ["HalfCheetah-v5", "Reacher-v5", "Swimmer-v4"]

FORMS: dict[str, Callable[[Any], Any]] = {
    "float64": lambda numbers: np.asarray(numbers, np.float64),
    "float32": lambda numbers: np.asarray(numbers, np.float32),
    "integers": lambda numbers: np.rint(numbers).astype(np.int16),
    "list": lambda numbers: np.asarray(numbers).tolist(),
    "list of numpy's": lambda numbers: list(np.asarray(numbers, np.float32)),
    "list of whole numbers": lambda numbers: np.rint(numbers).astype(int).tolist(),
    "view": lambda numbers: np.repeat(np.asarray(numbers, np.float64), 2, axis=-1)[..., ::2],
}


def pair(env_id: str) -> tuple[gymnasium.Env, gymnasium.Env]:
    if env_id not in CLASSIC:
        pytest.importorskip("Box2D" if env_id in BOX2D else "mujoco")
    # the installed version of MuJoCo, which Gymnasium uses
    kwargs = {"mujoco": import_module("mujoco").__version__} if env_id in MUJOCO else {}
    return rustgym.make(env_id, **kwargs), gymnasium.make(env_id)


def numbers(space: gymnasium.spaces.Box, rng: np.random.Generator) -> Any:
    """Random numbers that single precision cannot represent, some of them beyond the bounds."""
    return rng.uniform(1.4 * space.low.astype(float), 1.4 * space.high.astype(float), space.shape)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("env_id", CLASSIC + BOX2D + MUJOCO)
def test_environments(env_id: str, form: str) -> None:
    ours, theirs = pair(env_id)
    if env_id in MUJOCO and form == "list of numpy's":
        pytest.skip("MuJoCo's tasks take no such list")
    rng = np.random.default_rng(0)
    for seed in range(3):
        assert_same(ours.reset(seed=seed), theirs.reset(seed=seed))
        for _ in range(60):
            action = FORMS[form](numbers(theirs.action_space, rng))
            result, expected = ours.step(action), theirs.step(action)
            assert_same(result, expected)
            if result[2] or result[3]:
                break
        if "Bipedal" in env_id:  # Gymnasium's numbers after a reset depend on earlier episodes
            theirs = gymnasium.make(env_id)


@pytest.mark.parametrize("env_id", CLASSIC + BOX2D[:1])
def test_wrappers(env_id: str) -> None:
    rng = np.random.default_rng(0)
    for wrap in (ClipAction, lambda env: RescaleAction(env, np.float32(-3.0), np.float32(1.0))):
        ours, theirs = (wrap(env) for env in pair(env_id))
        ours.reset(seed=1), theirs.reset(seed=1)
        for _ in range(30):
            action = numbers(theirs.action_space, rng) if np.isfinite(theirs.action_space.low).all() else rng.uniform(-3, 3, 1)
            action = np.broadcast_to(action, theirs.action_space.shape).copy()
            assert_same(ours.step(action), theirs.step(action))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("kind", ["sync", "async", "native"])
@pytest.mark.parametrize("env_id", CLASSIC + BOX2D[:1])
def test_vectors(env_id: str, kind: str, form: str) -> None:
    if kind == "native" and env_id in BOX2D:
        pytest.skip("its native vector is in lockstep, as the async one")
    if env_id in BOX2D:
        pytest.importorskip("Box2D")
    n = 40
    theirs = SyncVectorEnv([lambda: gymnasium.make(env_id)] * n)
    ours = rustgym.VectorEnv(env_id, n, kind=kind)
    rng = np.random.default_rng(0)
    assert_same(ours.reset(seed=3), theirs.reset(seed=3))
    for _ in range(30):
        action = FORMS[form](numbers(theirs.action_space, rng))
        assert_same(ours.step(action), theirs.step(action))


def test_what_is_no_action_is_refused() -> None:
    env = rustgym.make("Pendulum-v1")
    env.reset(seed=0)
    for action in (["a"], [None], [[0.1]], [], 0.1, None, "a", [float("nan")], np.array([np.inf]), [1j]):
        with pytest.raises(gymnasium.error.InvalidAction):
            env.step(action)
    envs = rustgym.make_vec("Pendulum-v1", 2)
    envs.reset(seed=0)
    for actions in (["a", "b"], [[0.1]], [0.1, 0.2], [[0.1], [float("nan")]], [[0.1], ["a"]], None):
        with pytest.raises(gymnasium.error.InvalidAction):
            envs.step(actions)
