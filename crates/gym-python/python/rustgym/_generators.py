"""numpy's generators, and their states on the Rust side."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["generator_from", "random_state_from", "words_of"]


def generator_from(words: list[int]) -> np.random.Generator:
    """numpy's generator of the Rust side's state."""
    state_high, state, inc_high, inc, half = words
    generator = np.random.Generator(np.random.PCG64(0))
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": state_high << 64 | state, "inc": inc_high << 64 | inc},
        "has_uint32": half >> 32,
        "uinteger": half & 0xFFFF_FFFF,
    }
    return generator


def words_of(generator: np.random.Generator) -> list[int]:
    """The Rust side's state of numpy's generator: the inverse of ``generator_from``."""
    state: Any = generator.bit_generator.state
    half = 1 << 32 | int(state["uinteger"]) if state["has_uint32"] else 0
    parts = [state["state"]["state"], state["state"]["inc"]]
    return [word for part in parts for word in (part >> 64, part & 0xFFFF_FFFF_FFFF_FFFF)] + [half]


def random_state_from(stored: dict[str, Any]) -> np.random.RandomState:
    """numpy's ``RandomState`` of the Rust side's, as it is stored."""
    words = np.array([int(stored["words"][i : i + 8], 16) for i in range(0, len(stored["words"]), 8)], np.uint32)
    state = np.random.RandomState(0)
    gauss = stored["gauss"]
    state.set_state(("MT19937", words, stored["next"], int(gauss is not None), 0.0 if gauss is None else gauss))
    return state
