"""Looking changes nothing: whatever is read of an environment, its episodes are those of a twin that nobody reads."""

from __future__ import annotations

import inspect
from typing import Any

import gymnasium
import pytest
from conftest import IDS, assert_same, go_on

import rustgym

#: An id of each base.
ONE_OF_EACH = {type(rustgym.make(env_id).unwrapped).__mro__[1]: env_id for env_id in reversed(IDS)}.values()


def attributes(env: Any) -> list[str]:
    """The names of what is public and no method."""
    found = [(name, inspect.getattr_static(type(env), name, None)) for name in dir(type(env)) if not name.startswith("_")]
    return [name for name, value in found if not inspect.isroutine(value) and not isinstance(value, type)]


def is_read(env: Any, name: str) -> bool:
    try:
        repr(getattr(env, name))
    except (AttributeError, TypeError, gymnasium.error.Error):
        return False  # it is not there yet, or never
    return True


def twins(env_id: str) -> tuple[Any, Any, list[Any]]:
    """Two environments, and actions."""
    env, other = (rustgym.Env(env_id) for _ in range(2))
    other.action_space.seed(1)
    return env, other, [other.action_space.sample() for _ in range(40)]


@pytest.mark.parametrize("env_id", ONE_OF_EACH)
@pytest.mark.parametrize("steps", [0, 3])
def test_an_episode_goes_on_after_it_was_read(env_id: str, steps: int) -> None:
    env, other, actions = twins(env_id)
    for e in (env, other):
        e.reset(seed=3)
        go_on(e, actions[:steps])
    assert sum([is_read(env, name) for name in attributes(env)]) > 5 and repr(env) and str(env)
    assert_same(go_on(env, actions), go_on(other, actions), env_id)


@pytest.mark.parametrize("env_id", ONE_OF_EACH)
def test_what_is_read_before_the_first_reset_begins_nothing(env_id: str) -> None:
    _, other, actions = twins(env_id)
    expected = [other.reset(seed=3), go_on(other, actions[:2])]
    for name in attributes(other):
        env: Any = rustgym.Env(env_id)
        is_read(env, name)
        # (minigrid's own step, which may have been opened, fails in its own way)
        with pytest.raises((gymnasium.error.ResetNeeded, AttributeError, TypeError)):
            env.step(actions[0])
        assert_same([env.reset(seed=3), go_on(env, actions[:2])], expected, f"{env_id}: {name}")
