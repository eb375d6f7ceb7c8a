"""`np_random` is the environment's own generator."""

from __future__ import annotations

import copy
import pickle

import gymnasium
import numpy as np
import pytest

import rustgym


def test_it_is_seeded_as_numpys() -> None:
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=7)
    expected = np.random.default_rng(7)
    expected.uniform(-0.05, 0.05, 4)
    assert env.np_random.bit_generator.state == expected.bit_generator.state
    assert env.np_random_seed == 7


def test_it_follows_the_environment_and_leads_it() -> None:
    env, twin = rustgym.Env("FrozenLake-v1"), gymnasium.make("FrozenLake-v1").unwrapped
    env.reset(seed=1), twin.reset(seed=1)
    for step in range(200):
        if step % 3 == 0:
            assert env.np_random.random() == twin.np_random.random()
        if step % 7 == 0:
            assert env.np_random.integers(100, dtype=np.uint32) == twin.np_random.integers(100, dtype=np.uint32)
        ours, theirs = env.step(step % 4), twin.step(step % 4)
        assert ours[:4] == theirs[:4]
        if ours[2]:
            assert env.reset()[0] == twin.reset()[0]
    assert env.np_random.bit_generator.state == twin.np_random.bit_generator.state


@pytest.mark.parametrize("is_used", [False, True])
def test_it_can_be_set(is_used: bool) -> None:
    env = rustgym.Env("CartPole-v1")
    if is_used:
        env.reset(seed=0)
    env.np_random = np.random.default_rng(99)
    assert env.np_random_seed == -1
    expected = np.random.default_rng(99).uniform(-0.05, 0.05, 4).astype(np.float32)
    assert np.array_equal(env.reset()[0], expected)


def test_other_bit_generators_are_refused() -> None:
    with pytest.raises(ValueError, match="PCG64, not MT19937"):
        rustgym.Env("CartPole-v1").np_random = np.random.Generator(np.random.MT19937(1))


def test_it_is_there_before_the_first_reset() -> None:
    env = rustgym.Env("CartPole-v1")
    assert isinstance(env.np_random, np.random.Generator) and env.np_random_seed >= 0
    env = rustgym.Env("CartPole-v1")
    env.reset()
    assert env.np_random_seed >= 0
    first = env.np_random.random()
    assert first != rustgym.Env("CartPole-v1").np_random.random()


def test_copies_have_one_each() -> None:
    env = rustgym.Env("CartPole-v1")
    env.reset(seed=0)
    _ = env.np_random
    for twin in (copy.copy(env), copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert twin.np_random is not env.np_random
        assert twin.np_random.bit_generator.state == env.np_random.bit_generator.state
        state = env.np_random.bit_generator.state
        twin.np_random.random(), twin.reset()
        assert env.np_random.bit_generator.state == state


def test_wrappers_draw_from_it() -> None:
    ours = gymnasium.wrappers.StickyAction(rustgym.make("MountainCar-v0"), 0.5)
    theirs = gymnasium.wrappers.StickyAction(gymnasium.make("MountainCar-v0"), 0.5)
    ours.reset(seed=5), theirs.reset(seed=5)
    for step in range(50):
        assert np.array_equal(ours.step(step % 3)[0], theirs.step(step % 3)[0])


def test_a_generator_starts_no_episode() -> None:
    env = rustgym.Env("CartPole-v1")
    env.np_random = np.random.default_rng(5)
    assert not env._native.is_running()
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(0)
    twin = rustgym.Env("CartPole-v1")
    twin.np_random = np.random.default_rng(5)
    assert np.array_equal(env.reset()[0], twin.reset()[0])
