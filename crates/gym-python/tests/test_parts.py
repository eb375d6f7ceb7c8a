"""Parts of the package that an episode seldom shows: vectors of the plane, sentences, pictures' limits, lists of attributes."""

from __future__ import annotations

import copy
import math
import operator
import pickle
import struct
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

import rustgym
from rustgym._bodies import Vec2
from rustgym._spaces import MissionSpace, space_from
from rustgym.notebook import Pictures


@pytest.mark.parametrize(
    ("operation", "right", "expected"),
    [
        (operator.add, (0.5, -1), (3.5, 3)),
        (operator.sub, (0.5, -1), (2.5, 5)),
        (operator.mul, 3, (9, 12)),
        (operator.truediv, 4, (0.75, 1)),
    ],
)
def test_vectors_of_the_plane(operation: Any, right: Any, expected: tuple[float, float]) -> None:
    found = operation(Vec2(3.0, 4.0), right)
    assert isinstance(found, Vec2) and tuple(found) == expected


def test_vectors_of_the_plane_are_of_single_precision() -> None:
    vector = Vec2(3.0, 4.0)
    assert 3 * vector == vector * 3 == (9, 12) and -vector == (-3, -4) and vector.length == 5
    for found in (vector + (0.1, 0.2), vector - (0.1, 0.2), vector * 0.1, vector / 3):
        assert all(x == float(np.float32(x)) for x in found), found


def _pair(words: list[list[str]], pattern: str = "go to the {} {}") -> MissionSpace:
    space = space_from({"type": "Mission", "pattern": pattern, "words": words, "any": False})
    assert isinstance(space, MissionSpace)
    return space


def test_sentences() -> None:
    words = [["red", "blue"], ["door", "key", "box"]]
    space = _pair(words)
    space.seed(3)
    sampled = {space.sample() for _ in range(200)}
    assert sampled == {f"go to the {color} {kind}" for color in words[0] for kind in words[1]}
    assert all(sentence in space for sentence in sampled)
    for other in ("go to the green door", "go to the red", "go to the red door ", "", 3, None):
        assert other not in space, other
    assert repr(space) == f"MissionSpace('go to the {{}} {{}}', {words})" and not space.is_np_flattenable
    with pytest.raises(AssertionError, match="neither a mask nor probabilities"):
        space.sample(mask=1)
    again = pickle.loads(pickle.dumps(space))
    assert again == space and again.sample() == space.sample()


def test_sentences_are_compared_without_the_order_of_words() -> None:
    space = _pair([["red", "blue"], ["door", "key"]])
    assert space == _pair([["blue", "red"], ["key", "door"]])
    for other in (
        _pair([["red", "blue"], ["door", "box"]]),
        _pair([["door", "key"], ["red", "blue"]]),
        _pair([["red", "blue"], ["door", "key"]], "go to a {} {}"),
        space_from({"type": "Mission", "pattern": "go to the {} {}", "words": [], "any": True}),
        spaces.Text(3),
    ):
        assert space != other and other != space, other
    anything = space_from({"type": "Mission", "pattern": "unlock the door", "words": [], "any": True})
    assert anything.sample() == "unlock the door" and "whatever" in anything
    plain = space_from({"type": "Mission", "pattern": "unlock the door", "words": [], "any": False})
    assert plain.sample() == "unlock the door" and "whatever" not in plain and "unlock the door" in plain


def test_sentences_equal_minigrids() -> None:
    theirs = pytest.importorskip("minigrid.core.mission").MissionSpace
    words = [["red", "blue"], ["door", "key"]]
    ours = _pair(words)
    mission = theirs(lambda color, kind: f"go to the {color} {kind}", words)
    for space in (ours, mission):
        space.seed(5)
    assert [ours.sample() for _ in range(20)] == [mission.sample() for _ in range(20)]
    assert ours == mission


def test_specs_of_dm_env() -> None:
    pytest.importorskip("dm_env")
    import rustgym.dm_env

    spec_of = rustgym.dm_env.spec_of
    for space, shape, low, high in (
        (spaces.Box(-1.0, 2.0, (2, 3), np.float32), (2, 3), -1, 2),
        (spaces.Discrete(4), (), 0, 3),
        (spaces.Discrete(4, start=-2), (), -2, 1),
        (spaces.MultiDiscrete([3, 5]), (2,), 0, [2, 4]),
        (spaces.MultiDiscrete([3, 5], start=[1, -1]), (2,), [1, -1], [3, 3]),
        (spaces.MultiBinary(3), (3,), 0, 1),
    ):
        spec = spec_of(space, "part")
        assert (spec.shape, spec.dtype, spec.name) == (shape, space.dtype, "part"), space
        assert np.array_equal(np.broadcast_to(spec.minimum, shape), np.broadcast_to(low, shape)), space
        assert np.array_equal(np.broadcast_to(spec.maximum, shape), np.broadcast_to(high, shape)), space
    both = spec_of(spaces.Dict({"a": spaces.Discrete(2), "b": spaces.Tuple([spaces.Text(3), spaces.Discrete(3)])}), "x")
    assert both["a"].name == "a" and [part.name for part in both["b"]] == ["b0", "b1"]
    with pytest.raises(TypeError, match="no spec for"):
        spec_of(spaces.Sequence(spaces.Discrete(2)))


def test_observations_fit_their_specs_in_dm_env() -> None:
    """Each kind of space, alone and within others, with numbers of Python and with arrays of another type."""
    pytest.importorskip("dm_env")
    import rustgym.dm_env

    class Given(gymnasium.Env[Any, Any]):
        action_space = spaces.Discrete(2)

        def __init__(self, space: spaces.Space[Any], element: Any) -> None:
            self.observation_space, self.element = space, element

        def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
            return self.element, {}

        def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
            return self.element, 1.0, False, False, {}

    def check(spec: Any, seen: Any) -> None:
        if isinstance(spec, dict):
            assert list(spec) == list(seen)
            for key, part in spec.items():
                check(part, seen[key])
        elif isinstance(spec, tuple):
            assert len(spec) == len(seen)
            for part, one in zip(spec, seen, strict=True):
                check(part, one)
        else:
            spec.validate(seen)

    kinds: list[tuple[spaces.Space[Any], Any]] = [
        (spaces.Discrete(5, start=-1), 3),
        (spaces.Box(0.0, 9.0, (2,), np.float32), [1.0, 2.5]),
        (spaces.Box(0, 9, (1, 2), np.uint8), np.array([[1, 2]])),
        (spaces.MultiDiscrete([3, 5]), (2, 4)),
        (spaces.MultiBinary(2), [True, False]),
        (spaces.Text(4), "abc"),
    ]
    every, element = spaces.Tuple([space for space, _ in kinds]), tuple(value for _, value in kinds)
    both = spaces.Dict({"x": every, "in": spaces.Dict({"a": kinds[0][0], "b": kinds[1][0]})})
    kinds += [(every, element), (both, {"x": element, "in": {"a": 3, "b": [1.0, 2.5]}})]
    for space, value in kinds:
        env = rustgym.dm_env.Environment(Given(space, value), seed=1)
        spec = env.observation_spec()
        for step in (env.reset(), env.step(1)):
            check(spec, step.observation)
            assert np.array_equal(spaces.flatten(space, step.observation), spaces.flatten(space, value)), space


def _chunks(png: bytes) -> list[tuple[bytes, bytes]]:
    found, at = [], 8
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        found.append((png[at + 4 : at + 8], png[at + 8 : at + 8 + length]))
        at += 12 + length
    return found


def test_pictures_have_limits_and_times() -> None:
    frame = np.zeros((2, 3, 3), np.uint8)
    for fps in (0, -1, 1000.5, math.nan, math.inf):
        with pytest.raises(ValueError, match=r"above 0, and at most 1000"):
            Pictures([frame], fps)
    for frames, words in (
        ([], "there is no picture to show"),
        ([frame, frame.astype(float)], "picture 1 is of type float64"),
        ([frame[0]], r"picture 0 is of type uint8 and shape \(3, 3\)"),
        ([frame[:0]], "picture 0 is of type"),
        ([frame[:, :, :2]], "picture 0 is of type"),
        ([frame, frame[:1]], r"picture 1 has the shape \(1, 3, 3\), and the first one has \(2, 3, 3\)"),
    ):
        with pytest.raises(ValueError, match=words):
            Pictures(frames, 30)
    alone = _chunks(Pictures([frame], 1000).png())
    assert [name for name, _ in alone] == [b"IHDR", b"IDAT", b"IEND"]
    assert struct.unpack(">II", alone[0][1][:8]) == (3, 2)
    three = _chunks(Pictures([frame] * 3, 8).png())
    names = [b"IHDR", b"acTL", b"fcTL", b"IDAT", b"fcTL", b"fdAT", b"fcTL", b"fdAT", b"IEND"]
    assert [name for name, _ in three] == names
    assert struct.unpack(">II", three[1][1]) == (3, 0)
    numbers = [struct.unpack(">I", data[:4])[0] for name, data in three if name in (b"fcTL", b"fdAT")]
    assert numbers == [0, 1, 2, 3, 4]
    delays = {struct.unpack(">HH", data[20:24]) for name, data in three if name == b"fcTL"}
    assert delays == {(125, 1000)}


def test_attributes_are_one_for_each_environment_or_one_for_all() -> None:
    envs = rustgym.VectorEnv("CartPole-v1", 3, kind="sync")
    envs.reset(seed=0)
    for values in ([1.0, 2.0], [1.0] * 4, []):
        with pytest.raises(ValueError, match=f"there are {len(values)} values for 3 environments"):
            envs.set_attr("gravity", values)
    envs.set_attr("gravity", 5.0)
    assert envs.get_attr("gravity") == (5.0, 5.0, 5.0)
    envs.set_attr("gravity", (1.0, 2.0, 3.0))
    assert envs.get_attr("gravity") == (1.0, 2.0, 3.0)


def test_what_an_environment_is_called() -> None:
    env = rustgym.make("FrozenLake-v1", render_mode="ansi", is_slippery=False, map_name="8x8").unwrapped
    assert repr(env) == "rustgym.Env('FrozenLake-v1', render_mode='ansi', map_name='8x8', is_slippery=False)"
    assert repr(rustgym.make("Taxi-v3").unwrapped) == "rustgym.Env('Taxi-v3')"


def test_a_copy_has_a_generator_of_its_own() -> None:
    env = rustgym.make("CartPole-v1").unwrapped
    env.reset(seed=3)
    numbers = env.np_random.random(3)
    twin = copy.copy(env)
    assert twin.np_random is not env.np_random
    assert np.array_equal(twin.np_random.random(4), env.np_random.random(4))
    assert len(numbers) == 3


@pytest.mark.parametrize("wrong", [3, [1], "x", {1, 2}])
def test_options_are_a_dict(wrong: Any) -> None:
    for env in (rustgym.make("CartPole-v1").unwrapped, rustgym.VectorEnv("CartPole-v1", 2)):
        with pytest.raises(TypeError, match="options must be a dict or None, not"):
            env.reset(options=wrong)


def test_namespaces_that_gymnasium_does_not_know(monkeypatch: pytest.MonkeyPatch) -> None:
    is_ours_alone = rustgym.registration.registry.is_ours_alone
    theirs = {spec.namespace for spec in gymnasium.registry.values()}
    assert is_ours_alone("dm_control") == ("dm_control" not in theirs)
    assert not is_ours_alone("nobodys") and None in theirs and not is_ours_alone(None)
    monkeypatch.setitem(gymnasium.registry, "dm_control/other-v0", EnvSpec("dm_control/other-v0"))
    assert not is_ours_alone("dm_control")


def test_an_id_that_is_set_is_gymnasiums_from_then_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(gymnasium.registry, "CartPole-v1", gymnasium.registry["CartPole-v1"])  # and back at the end
    registry, spec = rustgym.registration.Registry(), EnvSpec("CartPole-v1", entry_point="nowhere:Nothing")
    assert registry["CartPole-v1"] is not gymnasium.registry["CartPole-v1"]
    registry["CartPole-v1"] = spec
    assert registry["CartPole-v1"] is spec and gymnasium.registry["CartPole-v1"] is spec
    del registry["CartPole-v1"]
    assert "CartPole-v1" not in registry and "CartPole-v1" not in gymnasium.registry
