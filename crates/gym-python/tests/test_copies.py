"""Copies and pickles that are made during an episode continue as the original does."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import gymnasium
import pytest
from conftest import IDS, assert_same

import rustgym

WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
}


def go_on(env: Any, actions: list[Any]) -> list[Any]:
    results = [env.step(action) for action in actions]
    return [*results, env.reset(), env.step(actions[0])]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("env_id", IDS)
def test_environments(env_id: str, way: str) -> None:
    env = rustgym.make(env_id).unwrapped
    env.action_space.seed(0)
    env.reset(seed=3)
    for _ in range(7):
        env.step(env.action_space.sample())
    actions = [env.action_space.sample() for _ in range(10)]
    twin = WAYS[way](env)
    assert type(twin) is type(env)
    assert_same(go_on(twin, actions), go_on(env, actions))


@pytest.mark.parametrize("way", WAYS)
def test_before_the_first_reset(way: str) -> None:
    twin = WAYS[way](rustgym.Env("LunarLander-v3", continuous=True))
    assert twin.continuous is True
    with pytest.raises(Exception, match="reset"):
        twin.step([0.0, 0.0])
    twin.reset(seed=1)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("kind", ["sync", "async", "native"])
@pytest.mark.parametrize("env_id", ["CartPole-v1", "Taxi-v4", "LunarLander-v3"])
def test_vectors(env_id: str, kind: str, mode: str) -> None:
    envs = rustgym.VectorEnv(env_id, 5, kind=kind, autoreset_mode=mode, max_episode_steps=15)
    envs.action_space.seed(0)
    envs.reset(seed=3)
    for _ in range(20):
        envs.step(envs.action_space.sample())
    for way in ("deepcopy", "pickle"):
        twin = WAYS[way](envs)
        assert twin.kind == kind and twin.num_envs == 5
        actions = [envs.action_space.sample() for _ in range(20)]
        for action in actions:
            assert_same(twin.step(action), envs.step(action))
        assert_same(twin.reset(), envs.reset())


def test_in_another_process() -> None:
    env = rustgym.make("BipedalWalker-v3")
    env.action_space.seed(0)
    env.reset(seed=3)
    env.step(env.action_space.sample())
    action = env.action_space.sample()
    stored = pickle.dumps((env, action))
    code = "import pickle, sys; e, a = pickle.load(sys.stdin.buffer); sys.stdout.buffer.write(pickle.dumps(e.step(a)))"
    result = subprocess.run([sys.executable, "-c", code], input=stored, capture_output=True, check=True, timeout=60)
    assert_same(pickle.loads(result.stdout), env.step(action))


@pytest.mark.parametrize("way", WAYS)
def test_a_copy_of_what_was_never_reset_is_not_running(way: str) -> None:
    twin = WAYS[way](rustgym.Env("CartPole-v1"))
    assert not twin._native.is_running()
    with pytest.raises(gymnasium.error.ResetNeeded):
        twin.step(0)
