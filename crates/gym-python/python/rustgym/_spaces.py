"""Spaces of Gymnasium from the descriptions that the Rust side gives."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces

__all__ = ["space_from"]


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
