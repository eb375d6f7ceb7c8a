"""Which objects are actions, and as which: of each kind of environment, and of vectors; the whole refusal of the others.

After an intended change, read what differs, and store it with `GYM_UPDATE_KEPT=1 pytest test_actions.py`.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym
from rustgym._json import brief

KEPT = Path(__file__).with_name("actions.txt")

# environments with each check of actions, and how many numbers an action has
ENVS = {
    "CartPole-v1": 1,
    "Blackjack-v1": 1,
    "Taxi-v4": 1,
    "MiniGrid-Empty-5x5-v0": 1,
    "MiniGrid-Dynamic-Obstacles-5x5-v0": 1,
    "Pendulum-v1": 1,
    "MountainCarContinuous-v0": 1,
    "Hopper-v5": 3,
    "PointMaze_UMaze-v3": 2,
    "dm_control/point_mass-easy-v0": 2,
}


class Odd:
    def __repr__(self) -> str:
        return "odd"


def objects(n: int) -> dict[str, Any]:
    """Objects by their names, some of which are actions of ``n`` numbers."""
    ones = [1.0, -0.5, 0.25][:n]
    return {
        "None": None,
        "True": True,
        "1": 1,
        "-1": -1,
        "7": 7,
        "10**30": 10**30,
        "1.0": 1.0,
        "0.5": 0.5,
        "nan": float("nan"),
        "text": "1",
        "bytes": b"1",
        "odd": Odd(),
        "empty": [],
        "list": ones,
        "tuple": tuple(ones),
        "one more": [*ones, 0.5],
        "nested": [ones],
        "ragged": [ones, 0.5],
        "int32": np.array(1, np.int32),
        "uint8": np.array(1, np.uint8),
        "bool": np.array(True),
        "float of an int": np.array(1.0),
        "an array of one": np.array([1]),
        "float32": np.array(ones, np.float32),
        "float64": np.array(ones),
        "int64": np.array([1] * n),
        "reversed": np.array(ones[::-1], np.float32)[::-1],
        "big endian": np.array(ones, ">f4"),
        "inf in float64": np.array([*ones[:-1], np.inf]),
        "nan in float32": np.array([*ones[:-1], np.nan], np.float32),
        "beyond": np.array([*ones[:-1], 9.5], np.float32),
        "complex": np.array(ones, np.complex64),
        "object": np.array(ones, object),
        "a row more": np.ones((2, n), np.float32),
    }


#: Reasons in the package's own words; others are Python's and numpy's, which differ by version.
OWN = ("its shape is", "numbers must be finite")


def told(step: Any, candidates: dict[str, Any], action: Any, space: Any) -> str:
    """As which of the candidates an action is taken, or why it is refused."""
    try:
        result = step(action)
    except Exception as error:
        text = str(error).replace(f"invalid action {brief(action)}: ", "invalid action: ", 1)
        start, mark, reason = text.partition(f"the action space is {space} (")
        text = text if reason.startswith(OWN) else start + mark + ("...)" if mark else "")
        return f"{type(error).__name__}: {text}".replace("\n", " ")
    for name, candidate in candidates.items():
        if np.array_equal(result, step(candidate), equal_nan=True):
            return f"as {name}"
    return "as another action"


def grouped(whose: str, answers: dict[str, str]) -> list[str]:
    """A line for each answer, with the names of the actions that have it."""
    lines: dict[str, list[str]] = {}
    for name, answer in answers.items():
        lines.setdefault(answer, []).append(name)
    return [f"{whose}: {answer}: {'; '.join(names)}" for answer, names in lines.items()]


def of_environment(env_id: str) -> list[str]:
    env = rustgym.Env(env_id)
    n = ENVS[env_id]
    env.reset(seed=3)
    start = env.get_state()

    def step(action: Any) -> Any:
        env.set_state(start)
        observation, reward, *_ = env.step(action)
        parts = observation.values() if isinstance(observation, dict) else observation if isinstance(observation, tuple) else [observation]
        return np.concatenate([[reward], *(np.ravel(part).astype(float) for part in parts if not isinstance(part, str))])

    discrete = hasattr(env.action_space, "n")
    numbers = np.array([1.0, -0.5, 0.25][:n])
    boxed = {"the numbers": numbers, "the numbers in single precision": numbers.astype(np.float32)}
    candidates: dict[str, Any] = {str(k): k for k in range(env.action_space.n)} if discrete else boxed
    return grouped(env_id, {name: told(step, candidates, action, env.action_space) for name, action in objects(n).items()})


def of_vector(env_id: str, kind: str) -> list[str]:
    envs = rustgym.VectorEnv(env_id, 2, kind=kind)
    n = ENVS[env_id]
    discrete = hasattr(envs.single_action_space, "n")

    def step(actions: Any) -> Any:
        envs.reset(seed=3)
        return envs.step(actions)[0]

    rows = {f"two of {name}": [action, action] for name, action in objects(n).items() if name not in ("odd",)}
    arrays = {f"rows of {name}": np.stack([action, action]) for name, action in objects(n).items() if isinstance(action, np.ndarray)}
    candidates: dict[str, Any] = {str(k): [k, k] for k in range(2)} if discrete else {"ones": np.ones((2, n), np.float32)}
    second = [0, 7] if discrete else [[0.5] * n, [float("nan")] * n]
    batches = {**rows, **arrays, "one": objects(n)["list"][:1], "a text": "11", "nothing": None, "the second wrong": second}
    return grouped(f"{env_id}, {kind}", {name: told(step, candidates, actions, envs.action_space) for name, actions in batches.items()})


def test_actions_are_taken_and_refused_as_kept() -> None:
    lines = [line for env_id in ENVS for line in of_environment(env_id)]
    lines += [line for env_id in ("CartPole-v1", "Pendulum-v1") for kind in ("sync", "native") for line in of_vector(env_id, kind)]
    if "GYM_UPDATE_KEPT" in os.environ:
        KEPT.write_text("\n".join(lines) + "\n")
    for found, kept in zip(lines, KEPT.read_text().splitlines(), strict=True):
        assert found == kept


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Taxi-v4", "Pendulum-v1"])
def test_a_refused_action_changes_nothing(env_id: str) -> None:
    env, twin = rustgym.Env(env_id), rustgym.Env(env_id)
    for e in (env, twin):
        e.reset(seed=3)
    with pytest.raises(Exception, match="action"):
        env.step("left")
    action = twin.action_space.sample()
    assert np.array_equal(env.step(action)[0], twin.step(action)[0])


#: Forms of the number 1 or 0.3, which numpy computes with in different precisions.
FORMS: dict[str, Any] = {
    "ints": [1],
    "a tuple of ints": (1,),
    "bools": [True],
    "floats": [0.3],
    "a tuple of floats": (0.3,),
    "int64": [np.int64(1)],
    "float32 in a list": [np.float32(0.3)],
    "float64 in a list": [np.float64(0.3)],
    "an array of int64": np.array([1]),
    "an array of float32": np.array([0.3], np.float32),
    "an array of float64": np.array([0.3]),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("env_id", ["Pendulum-v1", "MountainCarContinuous-v0"])
def test_numbers_are_computed_with_as_gymnasium_computes_with_them(env_id: str, form: str) -> None:
    results = []
    for module in (gymnasium, rustgym):
        env = module.make(env_id, disable_env_checker=True).unwrapped
        env.reset(seed=3)
        results.append([env.step(FORMS[form])[:4] for _ in range(5)])
    assert_same(results[1], results[0], form)
    assert [type(step[1]) for step in results[0]] == [type(step[1]) for step in results[1]]


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Blackjack-v1", "Taxi-v4", "MiniGrid-Empty-5x5-v0"])
def test_an_invalid_action_is_each_error_that_gymnasiums_environments_raise(env_id: str) -> None:
    env = rustgym.Env(env_id)
    env.reset(seed=3)
    for kind in (gymnasium.error.InvalidAction, AssertionError, KeyError, IndexError, TypeError, ValueError):
        with pytest.raises(kind):
            env.step("left")
