"""Vectors: shapes of results, resets, errors, `send` and `recv`."""

from __future__ import annotations

import re
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import rustgym

KINDS = ["sync", "async", "native"]


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Taxi-v3", "Acrobot-v1", "MiniGrid-Empty-5x5-v0"])
def test_an_unknown_argument_is_named(env_id: str) -> None:
    with pytest.raises(TypeError, match=f"{env_id} got an unexpected keyword argument 'foo': it"):
        rustgym.VectorEnv(env_id, 2, foo=3)


@pytest.mark.parametrize("kind", KINDS)
def test_forms(kind: str) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 5, kind=kind)
    assert envs.kind == kind and envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP is envs.autoreset_mode
    observations, infos = envs.reset(seed=[1, 2, 3, None, 4])
    assert observations.shape == (5, 4) and observations.dtype == np.float32 and infos == {}
    for actions in (envs.action_space.sample(), [0, 1, 0, 1, 1], np.ones(5, np.uint8), np.ones(10, np.int64)[::2]):
        observations, rewards, terminated, truncated, _ = envs.step(actions)
        assert rewards.dtype == np.float64 and terminated.dtype == np.bool_ == truncated.dtype
        assert observations in envs.observation_space
        for array in (observations, rewards, terminated, truncated):
            assert array.flags.writeable and array.flags.c_contiguous


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "actions", [[0, 1], [0, 1, 2], [0.0, 1.0, 0.0], 0, None, np.zeros((3, 1), np.int64), ["a", "b", "c"]]
)
def test_bad_actions(kind: str, actions: object) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind=kind)
    envs.reset(seed=0)
    with pytest.raises(gymnasium.error.InvalidAction):
        envs.step(actions)


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("kind", KINDS)
def test_metadata_are_the_environments_and_the_mode(kind: str, mode: AutoresetMode) -> None:
    for given in (mode, mode.value):
        envs = rustgym.VectorEnv("CartPole-v1", 2, kind=kind, autoreset_mode=given)
        assert envs.autoreset_mode is mode
        modes = {"render_modes": []} if kind == "native" else {}  # a native vector draws nothing
        assert envs.metadata == {**rustgym.Env("CartPole-v1").metadata, **modes, "autoreset_mode": mode}


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
@pytest.mark.parametrize("kind", KINDS)
def test_seeds_give_the_same_with_and_without_copies(kind: str, mode: str) -> None:
    first, second = (
        rustgym.VectorEnv("CartPole-v1", 3, kind=kind, autoreset_mode=mode, copy=copy, seeds=range(200), max_episode_steps=9)
        for copy in (True, False)
    )
    assert_same(first.reset(), second.reset())
    for k in range(40):
        kept = first.step(np.full(3, k % 2)), second.step(np.full(3, k % 2))
        # what a call returned is valid until the call after next
        if k:
            assert_same(*before)
        assert_same(*kept)
        before = kept


@pytest.mark.parametrize("kind", KINDS)
def test_order(kind: str) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind=kind)
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step([0, 0, 0])
    envs.reset()
    envs.close()
    envs.close()
    if kind == "async":  # `close` has ended the threads of the vector
        with pytest.raises(gymnasium.error.ClosedEnvironmentError):
            envs.step([0, 0, 0])


@pytest.mark.parametrize("copy", [True, False])
def test_results_stay(copy: bool) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 4, copy=copy)
    last, _ = envs.reset(seed=0)
    for _ in range(10):
        kept = last.copy()
        step = envs.step(envs.action_space.sample())
        # with `copy=False`, too, this call has not overwritten the arrays of the call before
        assert np.array_equal(last, kept) and not np.shares_memory(last, step[0])
        last = step[0]
    ids = {id(envs.step(envs.action_space.sample())[0]) for _ in range(6)}
    assert copy or len(ids) == 2


@pytest.mark.parametrize("kind", KINDS)
def test_masks(kind: str) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 4, kind=kind, autoreset_mode="Disabled")
    first, _ = envs.reset(seed=0)
    options = {"reset_mask": np.array([True, False, True, False])}
    again, _ = envs.reset(seed=7, options=options)
    assert "reset_mask" in options, "the caller's dict is the caller's"
    assert np.array_equal(again[1::2], first[1::2]) and not np.array_equal(again[::2], first[::2])
    assert np.array_equal(again[2], rustgym.Env("CartPole-v1").reset(seed=9)[0])
    for mask in ([True] * 4, np.ones(3, bool), np.zeros(4, bool), np.ones(4, int)):
        with pytest.raises(ValueError, match="mask"):
            envs.reset(options={"reset_mask": mask if isinstance(mask, np.ndarray) else [*mask, True]})


def test_constructor_arguments() -> None:
    envs = rustgym.make_vec("FrozenLake-v1", 3, map_name="8x8", autoreset_mode=AutoresetMode.SAME_STEP, kind="async", threads=2)
    assert envs.single_observation_space.n == 64 and envs.kind == "async"
    with pytest.raises(ValueError, match="choose kind async"):
        rustgym.VectorEnv("CartPole-v1", 3, affinity=0)
    if sys.platform == "linux":
        assert rustgym.VectorEnv("CartPole-v1", 3, kind="async", affinity=0).reset(seed=0)[0].shape == (3, 4)
    with pytest.raises(TypeError, match="map_nam"):
        rustgym.VectorEnv("FrozenLake-v1", 3, map_nam="8x8")
    with pytest.raises(ValueError, match="kind"):
        rustgym.VectorEnv("CartPole-v1", 3, kind="fast")
    with pytest.raises(ValueError, match="num_envs"):
        rustgym.VectorEnv("CartPole-v1", 0)
    with pytest.raises(ValueError, match="no native|there is none"):
        rustgym.VectorEnv("CarRacing-v3", 3, kind="native")
    envs = rustgym.VectorEnv("Pendulum-v1", 2, max_episode_steps=3)
    envs.reset(seed=0)
    assert [bool(envs.step(np.zeros((2, 1), np.float32))[3].all()) for _ in range(3)] == [False, False, True]


def test_rendering() -> None:
    envs = rustgym.make_vec("CartPole-v1", 3, render_mode="rgb_array")
    envs.reset(seed=0)
    frames = envs.render()
    assert len(frames) == 3 and all(frame.shape == (400, 600, 3) for frame in frames)


def test_sending_and_receiving() -> None:
    envs = rustgym.VectorEnv("Taxi-v4", 6, kind="async", threads=2)
    twin = rustgym.VectorEnv("Taxi-v4", 6, kind="sync")
    envs.reset(seed=0), twin.reset(seed=0)
    expected = twin.step([1] * 6)
    envs.send([1] * 6)
    seen = []
    for m in (1, 2, 3):
        observations, rewards, terminated, truncated, infos = envs.recv(m)
        ids = infos["env_id"]
        assert len(ids) == m == len(observations) == len(rewards) == len(terminated) == len(truncated)
        assert np.array_equal(observations, expected[0][ids]) and np.array_equal(rewards, expected[1][ids])
        assert np.array_equal(infos["prob"][ids], expected[4]["prob"][ids]) and infos["_prob"].sum() == m
        seen += ids.tolist()
    assert sorted(seen) == list(range(6))
    envs.send([0, 1], [4, 2])
    with pytest.raises(ValueError, match="pending"):
        envs.recv(3)
    with pytest.raises(gymnasium.error.Error, match="pending"):
        envs.step([0] * 6)
    envs.recv(2)
    with pytest.raises(gymnasium.error.Error, match="async"):
        twin.send([0] * 6)


def test_attributes_of_the_environments() -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind="sync")
    envs.reset(seed=0)
    assert envs.get_attr("render_mode") == (None, None, None)
    assert envs.state.shape == (4, 3)
    envs.set_attr("state", [np.full(4, 0.01 * i) for i in range(3)])
    assert np.array_equal(envs.state, np.outer(np.ones(4), 0.01 * np.arange(3)))
    observations, *_ = envs.step([1, 1, 1])
    assert observations[2, 0] == pytest.approx(0.0204)
    assert envs.call("get_state") == envs.call("get_state")
    with pytest.raises(gymnasium.error.Error, match="no separate environments"):
        rustgym.VectorEnv("CartPole-v1", 3, kind="native").get_attr("state")


@pytest.mark.parametrize("kind", KINDS)
def test_states(kind: str) -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind=kind)
    with pytest.raises(AttributeError, match="reset"):
        _ = envs.state
    observations, _ = envs.reset(seed=0)
    assert np.array_equal(envs.state.T.astype(np.float32), observations)


def test_arguments_of_the_environments() -> None:
    envs = rustgym.VectorEnv("LunarLander-v3", 2, kind="sync", enable_wind=True)
    envs.reset(seed=0)
    assert envs.get_attr("enable_wind") == (True, True) and envs.get_attr("wind_idx")[0] != envs.get_attr("wind_idx")[1]


def test_a_panic_in_one(faults: str) -> None:
    for kind in ("sync", "async"):
        envs = rustgym.VectorEnv(faults, 3, kind=kind)
        envs.reset()
        envs.step([0, 0, 0])
        with pytest.raises(gymnasium.error.Error, match="sub-environment 1: .*asked to panic"):
            envs.step([0, 1, 0])
        mask = np.array([False, True, False])
        observations, _ = envs.reset(options={"reset_mask": mask})
        assert observations.tolist() == [2, 0, 2]


def test_gymnasiums_wrappers_go_around() -> None:
    envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(rustgym.make_vec("CartPole-v1", 8))
    envs = gymnasium.wrappers.vector.DictInfoToList(envs)
    envs.reset(seed=0)
    episodes = 0
    for _ in range(100):
        *_, infos = envs.step(envs.action_space.sample())
        episodes += sum("episode" in info for info in infos)
    assert episodes > 8


def test_numbers_of_environments_and_threads() -> None:
    for kwargs, error in (
        ({"num_envs": -3}, ValueError),
        ({"num_envs": 2.5}, TypeError),
        ({"num_envs": "a"}, TypeError),
        ({"num_envs": 2, "kind": "async", "threads": -1}, ValueError),
        ({"num_envs": 2, "kind": "async", "threads": "a"}, TypeError),
        ({"num_envs": 10**30}, ValueError),
        ({"num_envs": 2, "kind": "async", "threads": 10**30}, ValueError),
    ):
        with pytest.raises(error, match="num_envs|threads"):
            rustgym.VectorEnv("CartPole-v1", **kwargs)


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("kind", 3, TypeError),
        ("render_mode", 3, TypeError),
        ("copy", "x", TypeError),
        ("max_episode_steps", "x", TypeError),
        ("arg_each", 3, TypeError),
        ("arg_each", {"gravity": 3}, TypeError),
        ("arg_each", {"gravity": "ab"}, TypeError),
        ("arg_each", {"gravity": ("a", "b")}, ValueError),
    ],
)
def test_an_argument_of_the_wrong_type_is_named(name: str, value: object, error: type[Exception]) -> None:
    with pytest.raises(error, match=f"{name}|gravity|pair of numbers") as raised:
        rustgym.VectorEnv("CartPole-v1", 2, **{name: value})
    assert not re.search(r"'str' object|'int' object|untagged", str(raised.value))


def test_an_argument_of_each() -> None:
    envs = rustgym.make_vec("CartPole-v1", 2, arg_each={"gravity": [9.8, 1.6]})
    alone = [rustgym.make("CartPole-v1", gravity=gravity) for gravity in (9.8, 1.6)]
    envs.reset(seed=1)
    for i, env in enumerate(alone):
        env.reset(seed=1 + i)
    for _ in range(5):
        observations = envs.step(np.array([1, 1]))[0]
        assert np.array_equal(observations, [env.step(1)[0] for env in alone])
    drawn = rustgym.make_vec("CartPole-v1", 2, arg_each={"gravity": (3.7, 11.2)})
    assert drawn.reset(seed=1)[0].shape == (2, 4)
    with pytest.raises(TypeError, match="'gravty'"):
        rustgym.make_vec("CartPole-v1", 2, arg_each={"gravty": [1, 2]})


def test_the_direct_base_that_skrl_reads() -> None:
    assert gymnasium.vector.VectorEnv in type(rustgym.make_vec("CartPole-v1", 2)).__bases__


@pytest.mark.parametrize(("seed", "named"), [("a", "Seed must .* 'a'"), (1.5, "Seed must .* 1.5"), ([1, "x", 2], "Seed 1 must .* 'x'")])
def test_a_seed_that_is_none_is_named(seed: object, named: str) -> None:
    envs = rustgym.make_vec("CartPole-v1", 3)
    with pytest.raises(gymnasium.error.Error, match=named):
        envs.reset(seed=seed)  # type: ignore[arg-type]


def test_infos_of_some_of_the_environments() -> None:
    envs, twin = (rustgym.VectorEnv("Taxi-v4", 4, kind=kind) for kind in ("async", "sync"))
    for e in (envs, twin):
        e.reset(seed=3)
    masks = twin.step([0, 0, 0, 0])[4]["action_mask"]
    assert len(np.unique(masks, axis=0)) > 1
    envs.send([0, 0, 0, 0])
    envs.recv(4)
    expected = twin.step([1, 1, 1, 1])
    envs.send([1, 1, 1], [3, 1, 2])
    observations, _, _, _, infos = envs.recv(3)
    assert sorted(infos["env_id"].tolist()) == [1, 2, 3]
    for row, index in enumerate(infos["env_id"]):
        assert observations[row] == expected[0][index]
        assert np.array_equal(infos["action_mask"][index], expected[4]["action_mask"][index]), index
    assert infos["_action_mask"].tolist() == [False, True, True, True]


def order(infos: dict[str, Any]) -> list[Any]:
    return [(key, order(value)) if isinstance(value, dict) else key for key, value in infos.items()]


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("env_id", ["Taxi-v4", "FrozenLake-v1", "CliffWalking-v1", "Hopper-v5", "Walker2d-v4", "Ant-v5", "Blackjack-v1"])
def test_infos_are_in_gymnasiums_order(env_id: str, mode: AutoresetMode) -> None:
    ours = rustgym.VectorEnv(env_id, 4, autoreset_mode=mode)
    made = [lambda: rustgym.make(env_id, disable_env_checker=True)] * 4
    theirs = SyncVectorEnv(made, autoreset_mode=mode)
    ours.action_space.seed(2)
    assert order(ours.reset(seed=2)[1]) == order(theirs.reset(seed=2)[1])
    for _ in range(100):
        actions = ours.action_space.sample()
        (_, _, ended, late, infos), (*_, expected) = ours.step(actions), theirs.step(actions)
        assert order(infos) == order(expected)
        if mode == AutoresetMode.DISABLED and (ended | late).any():
            over = {"reset_mask": ended | late}
            assert order(ours.reset(options=dict(over))[1]) == order(theirs.reset(options=dict(over))[1])


@pytest.mark.parametrize("kind", ["sync", "async", "native"])
@pytest.mark.parametrize("seed", [None, 4, [4, 9], [None, 9]])
def test_options_join_seeds_of_any_form(kind: str, seed: Any) -> None:
    options = {"low": 0.01, "high": 0.02}
    envs = rustgym.VectorEnv("CartPole-v1", 2, kind=kind)
    theirs = gymnasium.make_vec("CartPole-v1", num_envs=2, vectorization_mode="sync")
    for e in (envs, theirs):
        e.reset(seed=[1, 2])
    observations = envs.reset(seed=seed, options=options)[0]
    assert np.all((observations >= 0.01) & (observations < 0.02))
    expected = theirs.reset(seed=seed, options=options)[0]
    if seed != [None, 9]:  # Gymnasium's takes this as a list of seeds, too
        assert_same(observations, expected)
    mask = np.array([False, True])
    kept = envs.reset(seed=seed, options={**options, "reset_mask": mask})[0]
    assert_same(kept[0], observations[0])
    assert np.all((kept[1] >= 0.01) & (kept[1] < 0.02))
