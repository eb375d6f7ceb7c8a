"""The environments return the same numbers as Gymnasium's, in the same types."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from conftest import IDS, assert_same
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import rustgym

FAMILIES = ("gymnasium.envs.classic_control", "gymnasium.envs.toy_text", "gymnasium.envs.box2d")
THEIRS = [i for i in IDS if i in gymnasium.registry and str(gymnasium.registry[i].entry_point).startswith(FAMILIES)]


def their(env_id: str, **kwargs: object) -> gymnasium.Env:
    if env_id not in gymnasium.registry:
        pytest.skip(f"gymnasium {gymnasium.__version__} has no {env_id}")
    if ".box2d" in str(gymnasium.registry[env_id].entry_point):
        pytest.importorskip("Box2D")
    return gymnasium.make(env_id, **kwargs)


@pytest.mark.parametrize("env_id", THEIRS)
def test_description(env_id: str) -> None:
    theirs, ours = their(env_id), rustgym.make(env_id)
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    assert ours.metadata == theirs.metadata
    for name in ("kwargs", "reward_threshold", "max_episode_steps", "nondeterministic", "order_enforce"):
        assert getattr(ours.spec, name) == getattr(theirs.spec, name), name


@pytest.mark.parametrize("env_id", THEIRS)
@pytest.mark.parametrize("seed", [0, 12345678901234567890123])
def test_episodes(env_id: str, seed: int) -> None:
    if "CarRacing" in env_id:
        pytest.skip("its picture needs pygame on Gymnasium's side, and its dynamics are tested in Rust")
    theirs, ours = their(env_id), rustgym.make(env_id)
    theirs.action_space.seed(7)
    assert_same(ours.reset(seed=seed), theirs.reset(seed=seed))
    for _ in range(300):
        action = theirs.action_space.sample()
        result, expected = ours.step(action), theirs.step(action)
        assert_same(result, expected)
        assert [type(x) for x in result[1:4]] == [type(x) for x in expected[1:4]]
        if result[2] or result[3]:
            if "Bipedal" in env_id:  # Gymnasium's numbers after a reset depend on earlier episodes
                return
            assert_same(ours.reset(), theirs.reset())


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("kind", ["sync", "async"])
@pytest.mark.parametrize("env_id", ["CartPole-v1", "Pendulum-v1", "Taxi-v4", "Blackjack-v1", "FrozenLake-v1"])
def test_vectors(env_id: str, kind: str, mode: AutoresetMode) -> None:
    theirs = SyncVectorEnv([lambda: their(env_id, max_episode_steps=20)] * 5, autoreset_mode=mode)
    ours = rustgym.VectorEnv(env_id, 5, kind=kind, autoreset_mode=mode, max_episode_steps=20)
    theirs.action_space.seed(1)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert_same(ours.reset(seed=3), theirs.reset(seed=3))
    for _ in range(80):
        actions = theirs.action_space.sample()
        result, expected = ours.step(actions), theirs.step(actions)
        assert_same(result, expected)
        mask = result[2] | result[3]
        if mode is AutoresetMode.DISABLED and mask.any():
            # each vector gets its own dict, because Gymnasium's removes the key
            assert_same(
                ours.reset(options={"reset_mask": mask}), theirs.reset(options={"reset_mask": mask.copy()})
            )


NATIVE = ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "Acrobot-v1", "Taxi-v4", "FrozenLake-v1"]
NATIVE += ["LunarLander-v3", "LunarLanderContinuous-v3", "BipedalWalker-v3"]


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("env_id", NATIVE)
def test_native_vectors(env_id: str, mode: AutoresetMode) -> None:
    native = rustgym.VectorEnv(env_id, 40, kind="native", max_episode_steps=50, autoreset_mode=mode)
    sync = rustgym.VectorEnv(env_id, 40, kind="sync", max_episode_steps=50, autoreset_mode=mode)
    native.action_space.seed(0)
    assert_same(native.reset(seed=1), sync.reset(seed=1))
    for _ in range(120):
        actions = native.action_space.sample()
        assert_same(native.step(actions), sync.step(actions))


def test_random_maps() -> None:
    from gymnasium.envs.toy_text.frozen_lake import generate_random_map

    for seed in range(5):
        assert rustgym.envs.generate_random_map(8, 0.7, seed) == generate_random_map(8, 0.7, seed)


@pytest.mark.parametrize("env_id", ["FrozenLake-v1", "CliffWalking-v1", "CliffWalkingSlippery-v1", "Taxi-v4"])
def test_tables(env_id: str) -> None:
    theirs, ours = their(env_id).unwrapped, rustgym.make(env_id).unwrapped
    assert np.array_equal(ours.initial_state_distrib, theirs.initial_state_distrib)
    assert ours.P.keys() == theirs.P.keys()
    for state in theirs.P:
        for action, outcomes in theirs.P[state].items():
            assert_same(ours.P[state][int(action)], outcomes)


def test_taxis_masks() -> None:
    theirs, ours = their("Taxi-v4").unwrapped, rustgym.make("Taxi-v4").unwrapped
    for state in ours.P:
        assert_same(ours.action_mask(state), theirs.action_mask(state))
        assert ours.decode(state) == tuple(theirs.decode(state)) and ours.encode(*ours.decode(state)) == state


@pytest.mark.parametrize("env_id", ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "Acrobot-v1"])
def test_states_can_be_set(env_id: str) -> None:
    theirs, ours = gymnasium.make(env_id), rustgym.make(env_id)
    theirs.reset(seed=0), ours.reset(seed=0)
    action = theirs.action_space.sample()
    state = np.asarray(theirs.unwrapped.state, np.float64) * 1.5
    theirs.unwrapped.state = state.copy()
    ours.unwrapped.state = state
    assert np.array_equal(ours.unwrapped.state, state)
    assert_same(ours.step(action), theirs.step(action))
    assert np.array_equal(ours.unwrapped.state, np.asarray(theirs.unwrapped.state, np.float64))
    with pytest.raises(ValueError, match="state of"):
        ours.unwrapped.state = [0.0] * 7
