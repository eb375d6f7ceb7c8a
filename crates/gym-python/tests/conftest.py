"""Fixtures and helpers for all tests."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# makes numpy's norms round as on the CPUs that recorded MuJoCo's numbers; OpenBLAS reads the variable when it is loaded
CPU = Path("/proc/cpuinfo")
if CPU.exists() and "avx512f" in CPU.read_text():
    os.environ["OPENBLAS_CORETYPE"] = "SkylakeX"

import gymnasium
import numpy as np
import pytest

import rustgym

gymnasium.logger.min_level = gymnasium.logger.ERROR


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skips tasks whose rewards or infos contain a norm, on CPUs where its last bit differs."""
    if np.linalg.norm([0.1, 0.47619047619047616]) == 0.4865771980010083:
        return
    for item in items:
        params = item.callspec.params if hasattr(item, "callspec") else {}
        if str(params.get("env_id")).startswith(("Pusher", "Reacher", "Swimmer")):
            item.add_marker(pytest.mark.skip(reason="numpy's norms round otherwise on this CPU"))


@pytest.fixture
def without_mujoco(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The package of MuJoCo cannot be imported. What was looked up without it is forgotten afterwards."""
    monkeypatch.setitem(sys.modules, "mujoco", None)
    yield
    rustgym._opened.package_of.cache_clear()


def is_complete(env_id: str) -> bool:
    """Whether an environment can be made: the ROMs of Atari may be missing."""
    try:
        rustgym.make(env_id).close()
    except ValueError as error:
        return "no ROMs were found" not in str(error)
    return True


def is_tested(env_id: str) -> bool:
    """Whether tests over all ids include this id; two games of Atari are enough."""
    if env_id == "BabyAI-SynthS5R2-v0":
        return False  # in some of its resets, minigrid searches for a level forever
    if env_id.startswith(("Fetch", "Hand", "Franka")):
        return False  # they need the models of gymnasium-robotics: test_robotics.py
    of_atari = rustgym._specs.spec_of(env_id)["crate"] == "gym-atari"
    return env_id in ("Pong-v4", "BreakoutNoFrameskip-v4") if of_atari else "/" not in env_id


#: The ids of Gymnasium, and of its former releases, that can be made here.
IDS = [env_id for env_id in rustgym.ids() if is_tested(env_id) and is_complete(env_id)]
assert len(IDS) >= 57, IDS


def assert_same(ours: Any, theirs: Any, where: str = "") -> None:
    """Asserts equal values, keys, shapes and dtypes; numbers that are not arrays may differ in type."""
    if isinstance(theirs, dict):
        assert ours.keys() == theirs.keys(), where
        for key in theirs:
            assert_same(ours[key], theirs[key], f"{where}[{key!r}]")
    elif isinstance(theirs, tuple | list):
        assert len(ours) == len(theirs), where
        for i, (a, b) in enumerate(zip(ours, theirs, strict=True)):
            assert_same(a, b, f"{where}[{i}]")
    elif isinstance(theirs, np.ndarray) and theirs.dtype == object:
        assert ours.dtype == object, where
        assert_same(tuple(ours), tuple(theirs), where)
    elif isinstance(theirs, np.ndarray):
        assert isinstance(ours, np.ndarray) and ours.dtype == theirs.dtype, where
        is_same = np.array_equal(ours, theirs, equal_nan=theirs.dtype.kind == "f")
        assert ours.shape == theirs.shape and is_same, f"{where}: {ours} is not {theirs}"
    else:
        assert ours == theirs, f"{where}: {ours} is not {theirs}"


def go_on(env: Any, actions: Any) -> list[Any]:
    """The results of steps, and of a reset after each end."""
    results = []
    for action in actions:
        results.append(env.step(action))
        if results[-1][2] or results[-1][3]:
            results.append(env.reset())
    return results


@pytest.fixture(params=IDS)
def env_id(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def faults() -> str:
    """The id of an environment that panics on request; it exists only in a build with the feature `faults`."""
    name = "faults/Panics-v0"
    if name not in rustgym.ids():
        pytest.skip("this build has no faulty environment: maturin build --features faults")
    return name


@pytest.fixture(autouse=True)
def quiet() -> Any:
    """Hides warnings of ids that are out of date."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*out of date.*")
        yield
