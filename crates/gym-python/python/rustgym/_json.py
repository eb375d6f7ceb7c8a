"""Arguments and options as JSON: the form in which they reach the Rust side."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, Mapping):
        return dict(value)
    try:
        return list(value)
    except TypeError:
        # an environment that knows the name says what it wants instead; others ignore it
        return repr(value)


def to_json(values: Mapping[str, Any]) -> str:
    """A JSON object of named values, numpy's among them."""
    return json.dumps(dict(values), default=_plain)
