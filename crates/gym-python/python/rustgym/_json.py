"""Arguments and options as JSON: the form in which they reach the Rust side."""

from __future__ import annotations

import json
import reprlib
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["to_json"]


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        # a map as an array of characters, as Gymnasium's FrozenLake has it, becomes a list of its rows
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
        # an environment that has this option reports the error; other environments ignore the option
        return repr(value)


def _open(value: Any) -> Any:
    """A range whose infinite ends are replaced by `None`, because JSON has no infinity; any other value unchanged."""
    if isinstance(value, np.ndarray) and value.shape == (2,):
        value = value.tolist()
    if isinstance(value, (list, tuple)) and len(value) == 2:
        ends = zip(value, (-np.inf, np.inf), strict=True)
        return [None if np.isscalar(number) and number == end else number for number, end in ends]
    return value


def to_json(values: Mapping[str, Any]) -> str:
    """Named values, including numpy's, as a JSON object.

    Raises:
        ValueError: for a number that is not finite (the ends of a range may be), and for a value that contains itself.
    """
    entries = []
    for name, value in values.items():
        try:
            entries.append(f"{json.dumps(str(name))}: {json.dumps(_open(value), default=_plain, allow_nan=False)}")
        except ValueError as error:
            is_endless = str(error).startswith("Circular")
            wrong = "it must not contain itself" if is_endless else "every number must be finite"
            raise ValueError(f"{name} is {reprlib.repr(value)}: {wrong}") from None
    return f"{{{', '.join(entries)}}}"
