"""Arguments and options as JSON: the form in which they reach the Rust side."""

from __future__ import annotations

import json
import math
import reprlib
from collections.abc import Mapping
from itertools import islice
from typing import Any

import numpy as np

__all__ = ["brief", "state_json", "to_json"]

#: The most items that are read from an iterator, which may have no end.
_MOST_ITEMS = 1_000_000


class _Brief(reprlib.Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxlong = self.maxother = 200


#: ``repr`` in at most a few lines, for messages.
brief = _Brief().repr


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
        items = list(islice(value, _MOST_ITEMS + 1))
    except TypeError:
        # an environment that has this option reports the error; other environments ignore the option
        return repr(value)
    if len(items) > _MOST_ITEMS:
        raise OverflowError
    return items


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
        ValueError: for a number that is not finite (the ends of a range may be), for a value that contains itself or has no end,
            and for text that UTF-8 cannot hold.
    """
    entries = []
    for name, value in values.items():
        try:
            text = json.dumps(_open(value), default=_plain, allow_nan=False, ensure_ascii=False)
            entry = f"{json.dumps(str(name), ensure_ascii=False)}: {text}"
            entry.encode()
            entries.append(entry)
            continue
        except UnicodeError:
            wrong = "its text must be valid UTF-8"
        except OverflowError:
            wrong = f"it must have at most {_MOST_ITEMS} items"
        except RecursionError:
            wrong = "its lists are nested too deeply"
        except ValueError as error:
            is_endless = str(error).startswith("Circular")
            wrong = "it must not contain itself" if is_endless else "every number must be finite"
        raise ValueError(f"{name} is {brief(value)}: {wrong}")
    return f"{{{', '.join(entries)}}}"


def _not_finite(state: Any, place: str = "the state") -> str | None:
    """The place and value of a number in a state that is not finite."""
    if isinstance(state, float):
        return None if math.isfinite(state) else f"{place} is {state}"
    parts = state.items() if isinstance(state, dict) else enumerate(state) if isinstance(state, list) else ()
    found = (_not_finite(part, key if isinstance(key, str) else f"{place}[{key}]") for key, part in parts)
    return next(filter(None, found), None)


def state_json(state: Any) -> str:
    """A state as JSON.

    Raises:
        ValueError: names a number that is not finite.
    """
    try:
        return json.dumps(state, allow_nan=False)
    except ValueError:
        raise ValueError(f"{_not_finite(state)}: every number must be finite") from None
