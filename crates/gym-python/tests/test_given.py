"""What a caller gives stays as it was."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import rustgym

#: Calls with arguments that can be changed.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "arguments": (
        lambda **given: rustgym.Env("FrozenLake-v1", **given),
        {"desc": ["SF", "FG"], "is_slippery": False, "reward_schedule": [2, -1, 0]},
    ),
    "vector": (
        lambda **given: rustgym.VectorEnv("CartPole-v1", 2, **given),
        {"arg_each": {"gravity": (9.0, 10.0), "length": [0.5, 0.6], "masspole": (0.1, 0.2)}, "seeds": [1, 2, 3, 4]},
    ),
    "pixels": (
        lambda **given: rustgym.VectorEnv("CartPole-v1", 2, render_mode="rgb_array", **given),
        {"render_size": [40, 30], "arg_each": {"gravity": [9.0, 10.0]}},
    ),
    "make_vec": (
        lambda **given: rustgym.make_vec("CartPole-v1", num_envs=2, vectorization_mode="sync", **given),
        {"vector_kwargs": {"autoreset_mode": AutoresetMode.SAME_STEP}},
    ),
    "reset": (
        lambda **given: rustgym.Env("CartPole-v1").reset(**given),
        {"seed": 3, "options": {"low": -0.1, "high": 0.1, "other": [1, {"a": 2}]}},
    ),
    "reset of a vector": (
        lambda **given: rustgym.VectorEnv("CartPole-v1", 2).reset(**given),
        {"seed": [3, None], "options": {"low": -0.1, "high": 0.1}},
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_what_a_caller_gives_stays(name: str) -> None:
    call, given = CALLS[name]
    before = copy.deepcopy(given)
    call(**given)
    assert given == before and repr(given) == repr(before)
    call(**given)


def test_states_and_actions_stay() -> None:
    env: Any = rustgym.Env("Pendulum-v1")
    env.reset(seed=1)
    state = env.get_state()
    kept, action = copy.deepcopy(state), np.array([0.5], np.float32)
    env.set_state(state)
    env.step(action)
    assert state == kept and action == np.float32(0.5)
