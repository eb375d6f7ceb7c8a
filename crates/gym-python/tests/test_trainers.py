"""The vectors for Stable-Baselines3 and JAX beside single environments. Where a package is missing, a few lines stand in for what
ours uses of it, so that every change is tested; test_learners.py and test_package.py train with the packages themselves."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from conftest import assert_same

import rustgym


class BaseVecEnv:
    """The base class of Stable-Baselines3's vectors."""

    def __init__(self, num_envs: int, observation_space: Any, action_space: Any) -> None:
        self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
        self._reset_seeds(), self._reset_options()
        self.render_mode = self.get_attr("render_mode")[0]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        raise NotImplementedError

    def _reset_seeds(self) -> None:
        self._seeds: list[Any] = [None] * self.num_envs

    def _reset_options(self) -> None:
        self._options: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]

    def seed(self, seed: int) -> None:
        self._seeds = [seed + i for i in range(self.num_envs)]

    def set_options(self, options: dict[str, Any]) -> None:
        self._options = [options] * self.num_envs

    def _get_indices(self, indices: Any) -> Any:
        return range(self.num_envs) if indices is None else [indices] if isinstance(indices, int) else indices

    def step(self, actions: Any) -> Any:
        self.step_async(actions)  # type: ignore[attr-defined]
        return self.step_wait()  # type: ignore[attr-defined]


class ShapeDtypeStruct:
    def __init__(self, shape: Any, dtype: Any) -> None:
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)


def tree_map(f: Any, tree: Any, *others: Any) -> Any:
    if isinstance(tree, dict):
        return {key: tree_map(f, tree[key], *(other[key] for other in others)) for key in tree}
    if isinstance(tree, tuple):
        items = [tree_map(f, *parts) for parts in zip(tree, *others, strict=True)]
        return type(tree)(*items) if hasattr(tree, "_fields") else tuple(items)
    return f(tree, *others)


def pure_callback(f: Any, shapes: Any, *args: Any, vmap_method: str) -> Any:
    def checked(array: Any, to: ShapeDtypeStruct) -> Any:
        assert (array.shape, array.dtype) == (to.shape, to.dtype)
        return array

    assert vmap_method == "sequential"
    return tree_map(checked, f(*args), shapes)


def canonicalize_dtype(dtype: Any) -> np.dtype[Any]:
    wide = {"float64": "float32", "int64": "int32", "uint64": "uint32"}
    return np.dtype(wide.get(np.dtype(dtype).name, dtype))


def jax_as_array(value: Any) -> Any:
    return np.asarray(value, canonicalize_dtype(np.asarray(value).dtype))


STAND_INS: dict[str, dict[str, Any]] = {
    "stable_baselines3": {},
    "stable_baselines3.common": {},
    "stable_baselines3.common.vec_env": {"VecEnv": BaseVecEnv},
    "jax.numpy": {"int32": np.int32, "asarray": jax_as_array},
    "jax": {
        "tree": type("tree", (), {"map": staticmethod(tree_map)}),
        "dtypes": type("dtypes", (), {"canonicalize_dtype": staticmethod(canonicalize_dtype)}),
        "ShapeDtypeStruct": ShapeDtypeStruct,
        "pure_callback": pure_callback,
        "block_until_ready": lambda array: array,
    },
}


def ours(name: str, theirs: str) -> Iterator[Any]:
    """The module ``name`` of rustgym, on the package ``theirs`` or on its stand-in."""
    try:
        importlib.import_module(theirs)
    except ImportError:
        stand_ins = {module: ModuleType(module) for module in STAND_INS if module.split(".")[0] == theirs}
        for module, stand_in in stand_ins.items():
            stand_in.__dict__.update(STAND_INS[module])
        if theirs == "jax":
            stand_ins["jax"].__dict__["numpy"] = stand_ins["jax.numpy"]
        with pytest.MonkeyPatch.context() as patch:
            for module, stand_in in stand_ins.items():
                patch.setitem(sys.modules, module, stand_in)
            yield importlib.import_module(f"rustgym.{name}")
        del sys.modules[f"rustgym.{name}"]
        vars(rustgym).pop(name, None)
    else:
        yield importlib.import_module(f"rustgym.{name}")


@pytest.fixture(scope="module")
def sb3() -> Iterator[Any]:
    yield from ours("sb3", "stable_baselines3")


@pytest.fixture(scope="module")
def jax() -> Iterator[Any]:
    yield from ours("jax", "jax")


@pytest.mark.parametrize(
    ("env_id", "limit", "terminates"),
    [("CartPole-v1", 17, True), ("CliffWalking-v1", 6, False), ("Taxi-v4", 9, False), ("Blackjack-v1", 2, True)],
)
def test_rows_of_a_vector_for_sb3_are_single_environments(sb3: Any, env_id: str, limit: int, terminates: bool) -> None:
    n = 3
    vec = sb3.VecEnv(env_id, n, max_episode_steps=limit)
    singles = [rustgym.make(env_id, max_episode_steps=limit) for _ in range(n)]
    assert (vec.num_envs, vec.observation_space, vec.action_space) == (n, singles[0].observation_space, singles[0].action_space)
    assert {**vec.metadata, "autoreset_mode": None} == {**rustgym.VectorEnv(env_id, n).metadata, "autoreset_mode": None}
    vec.seed(40)
    starts = [env.reset(seed=40 + i) for i, env in enumerate(singles)]
    rng, ends = np.random.default_rng(0), set()

    def row(observations: Any, i: int) -> Any:
        return tuple(part[i] for part in observations) if isinstance(observations, tuple) else observations[i]

    for again in range(2):
        observations = vec.reset()
        for i, (observation, info) in enumerate(starts):
            assert_same(row(observations, i), observation)
            assert_same(vec.reset_infos[i], info)
        for _ in range(40):
            actions = rng.integers(vec.action_space.n, size=n)
            observations, rewards, dones, infos = vec.step(actions)
            assert rewards.dtype == np.float32 and dones.dtype == np.bool_ and len(infos) == n
            for i, env in enumerate(singles):
                observation, reward, terminated, truncated, info = env.step(int(actions[i]))
                done = terminated or truncated
                ends.add((terminated, truncated))
                if done:
                    last, (observation, info) = observation, env.reset()
                    info = {**info, "terminal_observation": last, "TimeLimit.truncated": truncated and not terminated}
                assert_same(row(observations, i), observation)
                assert (rewards[i], dones[i]) == (np.float32(reward), done)
                assert_same(infos[i], info)
        # the second time without a seed: each environment goes on with its generator
        starts = [env.reset() for env in singles] if not again else []
    assert ((True, False) in ends, (False, True) in ends) == (terminates, True)


def test_options_for_sb3_are_of_one_reset(sb3: Any) -> None:
    vec, env = sb3.VecEnv("CartPole-v1", 2), rustgym.make("CartPole-v1")
    vec.seed(1), vec.set_options({"low": 0.5, "high": 0.75})
    for i, start in enumerate(vec.reset()):
        assert_same(start, env.reset(seed=1 + i, options={"low": 0.5, "high": 0.75})[0])
    assert np.abs(vec.reset()).max() < 0.1
    vec.seed(2)
    for i, start in enumerate(vec.reset()):
        assert_same(start, env.reset(seed=2 + i)[0])


def test_sb3_asks_some_environments_in_its_order(sb3: Any) -> None:
    vec = sb3.VecEnv("CartPole-v1", 3, render_mode="rgb_array")
    vec.seed(7)
    first = vec.reset()
    assert vec.get_attr("render_mode") == ["rgb_array"] * 3 and vec.get_attr("render_mode", 1) == ["rgb_array"]
    assert vec.get_attr("action_space", [0, 2]) == [vec.action_space] * 2
    assert vec.get_attr("observation_space", 0) == [vec.observation_space]
    for indices, wanted in ((None, [0, 1, 2]), ([2, 0], [2, 0]), ([1], [1]), (2, [2]), ([], [])):
        for i, state in zip(wanted, vec.get_attr("state", indices), strict=True):
            assert_same(np.asarray(state, np.float32), first[i])
        for i, found in zip(wanted, vec.env_method("__getattribute__", "state", indices=indices), strict=True):
            assert_same(np.asarray(found, np.float32), first[i])
        assert vec.env_is_wrapped(object, indices) == [False] * len(wanted)
    vec.set_attr("gravity", 1.5, [2, 0])
    assert vec.get_attr("gravity") == [1.5, 9.8, 1.5]
    vec.set_attr("gravity", 3.0)
    assert vec.get_attr("gravity", [1, 2]) == [3.0, 3.0]
    images, env = vec.get_images(), rustgym.make("CartPole-v1", render_mode="rgb_array")
    for i, image in enumerate(images):
        env.reset(seed=7 + i)
        assert_same(image, env.render())
    assert len(images) == 3 and len(sb3.VecEnv("CartPole-v1").get_images()) == 0


@pytest.mark.parametrize("env_id", ["CartPole-v1", "Blackjack-v1", "PointMaze_UMaze-v3"])
def test_steps_for_jax_are_the_vectors(jax: Any, env_id: str) -> None:
    stepper, twin = (rustgym.VectorEnv(env_id, 3, max_episode_steps=9) for _ in range(2))
    stepper = jax.Stepper(stepper)

    def same(seen: Any, expected: Any) -> None:
        if isinstance(expected, dict):
            assert list(seen) == list(expected)
            return [same(seen[key], expected[key]) for key in expected] and None
        if isinstance(expected, tuple):
            return [same(*parts) for parts in zip(seen, expected, strict=True)] and None
        assert_same(np.asarray(seen), expected.astype(canonicalize_dtype(expected.dtype)))

    twin.action_space.seed(0)
    for seed in (3, None):
        carry, observations = stepper.reset(seed=seed)
        expected, infos = twin.reset(seed=seed)
        same(observations, expected)
        assert_same(stepper.infos, infos)
        for k in range(20):
            assert int(carry) == k
            actions = twin.action_space.sample()
            before = carry
            carry, result = stepper.step(carry, actions)
            *columns, infos = twin.step(actions)
            same(tuple(result), tuple(columns))
            assert result._fields == ("observations", "rewards", "terminated", "truncated")
            assert_same(stepper.infos, infos)
            # the same call again is no other step
            again, repeated = stepper.step(before, actions)
            assert int(again) == k + 1
            same(tuple(repeated), tuple(columns))
        with pytest.raises(Exception, match=r"this is step 20, and the carry is of step 19: pass on the carry of the last call"):
            jax.jax.block_until_ready(stepper.step(before, 1 - actions if actions.dtype.kind == "i" else -actions))


def test_options_for_jax_reach_the_reset(jax: Any) -> None:
    stepper = jax.Stepper(rustgym.VectorEnv("CartPole-v1", 2))
    _, observations = stepper.reset(seed=0, options={"low": 0.5, "high": 0.75})
    assert_same(np.asarray(observations), rustgym.VectorEnv("CartPole-v1", 2).reset(seed=0, options={"low": 0.5, "high": 0.75})[0])
