"""Arguments and options as JSON: the form in which they reach the Rust side."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["to_json"]


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        # a map of characters, as Gymnasium's FrozenLake has it, is a list of its rows
        characters = value.dtype.kind in "SU" and value.ndim == 2
        return ["".join(map(np.str_, row.astype("U"))) for row in value] if characters else value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, Mapping):
        return dict(value)
    try:
        return list(value)
    except TypeError:
        # an environment that has this option reports the error; others ignore it
        return repr(value)


def _open(value: Any) -> Any:
    """A range with `None` in place of an infinite end, as JSON has no infinity; any other value as it is."""
    if isinstance(value, np.ndarray) and value.shape == (2,):
        value = value.tolist()
    if isinstance(value, (list, tuple)) and len(value) == 2:
        ends = zip(value, (-np.inf, np.inf), strict=True)
        return [None if np.isscalar(number) and number == end else number for number, end in ends]
    return value


def to_json(values: Mapping[str, Any]) -> str:
    """A JSON object of named values, numpy's among them.

    Raises:
        ValueError: for a number that is not finite, but for the ends of a range, and for values that contain themselves.
    """
    entries = []
    for name, value in values.items():
        try:
            entries.append(f"{json.dumps(str(name))}: {json.dumps(_open(value), default=_plain, allow_nan=False)}")
        except ValueError as error:
            is_endless = str(error).startswith("Circular")
            wrong = "it must not contain itself" if is_endless else "every number must be finite"
            raise ValueError(f"{name} is {value!r}: {wrong}") from None
    return f"{{{', '.join(entries)}}}"
