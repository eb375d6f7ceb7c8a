"""How values of Python and numpy reach the Rust side, and in which words they do not."""

from __future__ import annotations

import json
import types
from typing import Any

import numpy as np
import pytest

from rustgym._json import state_json, to_json

INF = float("inf")


class Thing:
    def __repr__(self) -> str:
        return "<a thing>"


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, None),
        (True, True),
        (np.bool_(False), False),
        (3, 3),
        (np.int64(-3), -3),
        (np.uint8(200), 200),
        (0.1, 0.1),
        (np.float64(0.1), 0.1),
        (np.float32(0.1), 0.10000000149011612),
        (np.array(2.5), 2.5),
        (np.array([1, 2, 3], np.int8), [1, 2, 3]),
        (np.array([[1, 2], [3, 4]]), [[1, 2], [3, 4]]),
        (np.array([["S", "F"], ["H", "G"]]), ["SF", "HG"]),
        (np.array([[b"S", b"F"], [b"H", b"G"]]), ["SF", "HG"]),
        (np.array(["SF", "HG"]), ["SF", "HG"]),
        ("Größe \"1\"\n\\", "Größe \"1\"\n\\"),
        (np.str_("x"), "x"),
        (b"x", "x"),
        ((1, [2, (3,)]), [1, [2, [3]]]),
        (range(3), [0, 1, 2]),
        ((x for x in "ab"), ["a", "b"]),
        ({"a": np.float32(0.5), "b": {"c": (1,)}}, {"a": 0.5, "b": {"c": [1]}}),
        (types.MappingProxyType({"a": 1}), {"a": 1}),
        (Thing(), "<a thing>"),
        # the open ends of ranges
        ([-INF, INF], [None, None]),
        ((-INF, 2.5), [None, 2.5]),
        ([0, INF], [0, None]),
        (np.array([-INF, 2.0]), [None, 2.0]),
        (np.array([1.0, INF], np.float32), [1.0, None]),
        ([np.float32(-INF), np.float64(3)], [None, 3.0]),
        ((1, 2), [1, 2]),
        (("a", None), ["a", None]),
        ([[1, 2], [3]], [[1, 2], [3]]),
    ],
)
def test_a_value_is_sent_as_plain_json(value: Any, expected: Any) -> None:
    assert json.loads(to_json({"value": value, "second": 1})) == {"value": expected, "second": 1}


@pytest.mark.parametrize("name", ["a", "é", 'the "first"', "back\\slash", "line\nbreak", ""])
def test_any_text_is_a_name(name: str) -> None:
    assert json.loads(to_json({"first": 1, name: [2]})) == {"first": 1, name: [2]}


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (INF, "inf: every number must be finite"),
        (np.float32("nan"), "nan: every number must be finite"),
        ([INF, 0.0], "[inf, 0.0]: every number must be finite"),
        ([0.0, -INF], "[0.0, -inf]: every number must be finite"),
        (np.array([-INF, float("nan")]), "array([-inf,  nan]): every number must be finite"),
        ([-INF, 0.0, INF], "[-inf, 0.0, inf]: every number must be finite"),
        ([[-INF, INF]], "[[-inf, inf]]: every number must be finite"),
        ({"a": INF}, "{'a': inf}: every number must be finite"),
        ("\udc00", r"'\udc00': its text must be valid UTF-8"),
    ],
)
def test_what_json_cannot_hold_is_named_and_shown(value: Any, text: str) -> None:
    with pytest.raises(ValueError) as raised:
        to_json({"first": 1, "second": value, "third": 3})
    shown = str(raised.value)
    assert shown in (f"second is {text}", f"second is np.float32({text.replace(':', '):', 1)}")


@pytest.mark.parametrize(
    ("state", "place"),
    [
        (float("nan"), "the state is nan"),
        ([1.0, INF, float("nan")], "the state[1] is inf"),
        ({"a": 1.0, "b": -INF, "c": float("nan")}, "b is -inf"),
        ({"a": [0.0, [1.0, 2.0, INF]], "b": INF}, "a[1][2] is inf"),
        ({"a": {"b": [0, {"c": [1, float("nan")]}]}}, "c[1] is nan"),
        ({"a": None, "b": "nan", "c": [True, 10**400, INF]}, "c[2] is inf"),
    ],
)
def test_the_first_number_of_a_state_that_is_not_finite_is_named(state: Any, place: str) -> None:
    with pytest.raises(ValueError) as raised:
        state_json(state)
    assert str(raised.value) == f"{place}: every number must be finite"


def test_an_iterator_has_at_most_a_million_items() -> None:
    assert to_json({"rows": range(1_000_000)}).endswith(", 999999]}")
    with pytest.raises(ValueError, match=r"^rows is range\(0, 1000001\): it must have at most 1000000 items$"):
        to_json({"rows": range(1_000_001)})
