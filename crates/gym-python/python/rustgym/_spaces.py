"""Makes Gymnasium's spaces from descriptions by the Rust side."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
from gymnasium import spaces

__all__ = ["MissionSpace", "space_from"]


class MissionSpace(spaces.Space[str]):
    """The sentences that ``mission_func`` makes from one word of each list in ``ordered_placeholders``, as in minigrid.

    With ``contains_all``, every text is an element, and ``sample`` returns the sentence that ``mission_func`` makes without
    words.
    """

    def __init__(
        self,
        mission_func: Callable[..., str],
        ordered_placeholders: list[list[str]] | None = None,
        seed: int | np.random.Generator | None = None,
        contains_all: bool = False,
    ) -> None:
        self.mission_func = mission_func
        self.ordered_placeholders = ordered_placeholders
        self.contains_all = contains_all
        super().__init__(dtype=str, seed=seed)

    def sample(self, mask: Any = None, probability: Any = None) -> str:
        """A random sentence: each word has equal probability."""
        assert mask is None and probability is None, "a MissionSpace takes neither a mask nor probabilities"
        lists = self.ordered_placeholders or []
        return self.mission_func(*(words[self.np_random.integers(0, len(words))] for words in lists))

    def contains(self, x: Any) -> bool:
        """Whether ``x`` is one of the sentences."""
        if self.contains_all:
            return True
        lists = self.ordered_placeholders or []
        return isinstance(x, str) and any(self.mission_func(*words) == x for words in product(*lists))

    @property
    def is_np_flattenable(self) -> bool:
        """Always false: sentences do not flatten to an array."""
        return False

    def __repr__(self) -> str:
        """The sentence with blanks, and the words."""
        lists = self.ordered_placeholders
        return f"MissionSpace({self.mission_func(*['{}'] * len(lists or []))!r}, {lists})"

    def __eq__(self, other: Any) -> bool:
        """Whether the sentences are equal; the order of the words does not matter."""
        if not hasattr(other, "mission_func"):
            return False
        lists, others = self.ordered_placeholders or [], other.ordered_placeholders or []
        blanks = [""] * len(lists)
        same = [*map(set, lists)] == [*map(set, others)] and (self.ordered_placeholders is None) == (
            other.ordered_placeholders is None
        )
        return same and self.mission_func(*blanks) == other.mission_func(*blanks)


class _Pattern:
    """Fills the blanks of a sentence; unlike a lambda, it can be pickled."""

    def __init__(self, pattern: str) -> None:
        self.pattern = pattern

    def __call__(self, *words: str) -> str:
        first, *rest = self.pattern.split("{}")
        return first + "".join(word + literal for word, literal in zip(words, rest, strict=True))


def _bound(bound: Any, shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
    """A bound of a box: one number for all elements, or a flat list; infinity is ``"inf"`` or ``"-inf"``."""
    numbers = [float(x) if isinstance(x, str) else x for x in (bound if isinstance(bound, list) else [bound])]
    infinite = dtype.kind in "iu" and any(isinstance(x, float) and np.isinf(x) for x in numbers)
    array = np.array(numbers, dtype=np.float64 if infinite else dtype)
    return array.reshape(shape) if isinstance(bound, list) else np.full(shape, array[0], array.dtype)


def space_from(description: dict[str, Any] | None) -> spaces.Space[Any]:
    """The space of a description such as ``{"type": "Discrete", "n": 3, ...}``."""
    assert description is not None
    d = description
    match d["type"]:
        case "Box":
            shape, dtype = tuple(d["shape"]), np.dtype(d["dtype"])
            return spaces.Box(_bound(d["low"], shape, dtype), _bound(d["high"], shape, dtype), shape, dtype.type)
        case "Discrete":
            return spaces.Discrete(d["n"], start=d["start"], dtype=np.dtype(d["dtype"]).type)
        case "MultiDiscrete":
            shape, dtype = tuple(d["shape"]), np.dtype(d["dtype"])
            nvec, start = (np.array(d[key], dtype).reshape(shape) for key in ("nvec", "start"))
            return spaces.MultiDiscrete(nvec, dtype=dtype.type, start=start)
        case "MultiBinary":
            shape = d["shape"]
            return spaces.MultiBinary(shape[0] if len(shape) == 1 else shape)
        case "Text":
            return spaces.Text(d["max_length"], min_length=d["min_length"], charset=d["charset"])
        case "Mission":
            return MissionSpace(_Pattern(d["pattern"]), d["words"] or None, contains_all=d["any"])
        case "Tuple":
            return spaces.Tuple([space_from(member) for member in d["spaces"]])
        case "Dict":
            return spaces.Dict([(key, space_from(member)) for key, member in d["spaces"]])
        case "Sequence":
            return spaces.Sequence(space_from(d["feature"]), stack=d["stack"])
        case "Graph":
            edges = d["edge_space"]
            return spaces.Graph(space_from(d["node_space"]), space_from(edges) if edges else None)
        case "OneOf":
            return spaces.OneOf([space_from(member) for member in d["spaces"]])
        case kind:
            raise ValueError(f"there is no space of type {kind!r} in gymnasium")
