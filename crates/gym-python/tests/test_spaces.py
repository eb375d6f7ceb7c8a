"""Elements of each kind of space keep their values on the way to Rust and back."""

from __future__ import annotations

import json
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same
from gymnasium import spaces

import rustgym

SPACES: dict[str, spaces.Space[Any]] = {
    "Discrete": spaces.Discrete(5, start=2),
    "Box": spaces.Box(-1.0, 1.0, (2, 3)),
    "Box of bytes": spaces.Box(0, 255, (2, 2), np.uint8),
    "MultiDiscrete": spaces.MultiDiscrete([3, 4]),
    "MultiBinary": spaces.MultiBinary(4),
    "Text": spaces.Text(5),
    "Tuple": spaces.Tuple([spaces.Discrete(3), spaces.Box(0.0, 1.0, (2,))]),
    "Dict": spaces.Dict(a=spaces.Discrete(3), b=spaces.MultiBinary(2)),
    "Sequence": spaces.Sequence(spaces.Box(0.0, 1.0, (2,))),
    "Graph": spaces.Graph(spaces.Box(0.0, 1.0, (2,)), spaces.Discrete(4)),
    "Graph of texts": spaces.Graph(spaces.Text(3, min_length=1), None),
    "Graph of dicts": spaces.Graph(spaces.Dict(a=spaces.Discrete(3), b=spaces.Text(2)), spaces.Tuple([spaces.MultiBinary(2)])),
    "OneOf": spaces.OneOf([spaces.Discrete(3), spaces.Box(0.0, 1.0, (2,))]),
}


def described(space: spaces.Space[Any]) -> dict[str, Any]:
    """The form in which the Rust side stores a space."""
    match space:
        case spaces.Discrete():
            return {"type": "Discrete", "n": int(space.n), "start": int(space.start), "dtype": space.dtype.name}
        case spaces.Box():
            bounds = {"low": space.low.ravel().tolist(), "high": space.high.ravel().tolist()}
            return {"type": "Box", "shape": space.shape, "dtype": space.dtype.name, **bounds}
        case spaces.MultiDiscrete():
            numbers = {"nvec": space.nvec.ravel().tolist(), "start": space.start.ravel().tolist()}
            return {"type": "MultiDiscrete", "shape": space.shape, "dtype": space.dtype.name, **numbers}
        case spaces.MultiBinary():
            return {"type": "MultiBinary", "shape": space.shape}
        case spaces.Text():
            charset = "".join(space.character_list)
            return {"type": "Text", "min_length": space.min_length, "max_length": space.max_length, "charset": charset}
        case spaces.Dict():
            return {"type": "Dict", "spaces": [[key, described(member)] for key, member in space.spaces.items()]}
        case spaces.Sequence():
            return {"type": "Sequence", "feature": described(space.feature_space), "stack": space.stack}
        case spaces.Graph():
            edges = space.edge_space and described(space.edge_space)
            return {"type": "Graph", "node_space": described(space.node_space), "edge_space": edges}
        case _:
            return {"type": type(space).__name__, "spaces": [described(member) for member in space.spaces]}  # type: ignore[attr-defined]


@pytest.fixture
def echo(faults: str) -> str:
    return "faults/Echo-v0"


@pytest.mark.parametrize("name", SPACES)
def test_elements_come_back(echo: str, name: str) -> None:
    space = SPACES[name]
    env = rustgym.Env(echo, space=json.dumps(described(space)))
    assert env.observation_space == space
    space.seed(0)
    env.reset(seed=0)
    for _ in range(20):
        element = space.sample()
        back = env.step(element)[0]
        assert back in space, back
        assert_same(back, element)


def test_the_index_of_a_choice_is_a_number_of_numpys(echo: str) -> None:
    space = SPACES["OneOf"]
    env = rustgym.Env(echo, space=json.dumps(described(space)))
    env.reset(seed=0)
    space.seed(0)
    index, _ = env.step(space.sample())[0]
    assert type(index) is np.int64 is type(space.sample()[0])


def test_what_is_no_element(echo: str) -> None:
    env = rustgym.Env(echo, space=json.dumps(described(SPACES["Tuple"])))
    env.reset(seed=0)
    for action in ((1,), (1, np.zeros(3, np.float32)), 5, ("x", np.zeros(2, np.float32))):
        with pytest.raises(gymnasium.error.InvalidAction):
            env.step(action)
