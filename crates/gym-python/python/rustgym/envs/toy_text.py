"""Blackjack, FrozenLake, CliffWalking and Taxi: Gymnasium's classes, with their tables."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from rustgym import _native
from rustgym.env import ClassEnv, entropy

__all__ = ["BlackjackEnv", "CliffWalkingEnv", "FrozenLakeEnv", "TaxiEnv", "generate_random_map"]

#: The outcomes of an action in a state: probability, next state, reward, whether the episode ends.
Outcomes = list[tuple[float, int, float, bool]]


def generate_random_map(size: int = 8, p: float = 0.8, seed: int | None = None) -> list[str]:
    """A random map for FrozenLake with a path from start to goal, equal to Gymnasium's for the same seed.

    Args:
        size: Rows and columns, at least 2.
        p: The probability of a frozen cell, above 0 and at most 1.
        seed: The seed; without one the operating system gives it.
    """
    return _native.generate_random_map(size, p, seed)


class ToyTextEnv(ClassEnv):
    """An environment of a few cards or cells."""

    def _state(self) -> dict[str, Any]:
        state = self._native.state()
        if state is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        result: dict[str, Any] = json.loads(state)
        return result


class TabularEnv(ToyTextEnv):
    """An environment whose dynamics are a table."""

    # the name under which the state's number is stored
    _cell: ClassVar[str] = "cell"
    _actions: ClassVar[tuple[str, ...]]

    @cached_property
    def _table(self) -> tuple[dict[int, dict[int, Outcomes]], list[float]]:
        table = self._native.table()
        assert table is not None
        return table

    @property
    def P(self) -> dict[int, dict[int, Outcomes]]:  # noqa: N802 - Gymnasium's name
        """``P[state][action]``: the possible outcomes of an action, as ``(probability, next state, reward, terminated)``."""
        return self._table[0]

    @property
    def initial_state_distrib(self) -> npt.NDArray[np.float64]:
        """The probability of each state at the start."""
        return np.array(self._table[1])

    @property
    def s(self) -> int:
        """The state's number. Setting it continues from there."""
        return int(self._state()[self._cell])

    @s.setter
    def s(self, number: int) -> None:
        if self._native.state() is None:
            self._native.reset(str(entropy()), None)
        whole, episode = self._take_apart()
        episode["state"][self._cell] = int(number)
        self._native.restore(json.dumps(whole), True)

    @property
    def lastaction(self) -> int | None:
        """The last action; ``None`` at the start."""
        action = self._state()["last_action"]
        return None if action is None else self._actions.index(action)


class BlackjackEnv(ToyTextEnv):
    """Come closer to 21 than the dealer."""

    _id = "Blackjack-v1"

    @property
    def player(self) -> list[int]:
        """The player's cards; an ace is 1."""
        return self._cards("player")

    @property
    def dealer(self) -> list[int]:
        """The dealer's cards, of which the first is open; an ace is 1."""
        return self._cards("dealer")

    def _cards(self, whose: str) -> list[int]:
        return list(self._state()[whose])


class FrozenLakeEnv(TabularEnv):
    """Cross a frozen lake without falling into its holes."""

    _id = "FrozenLake-v1"
    _actions = ("Left", "Down", "Right", "Up")

    @cached_property
    def desc(self) -> npt.NDArray[np.bytes_]:
        """The map, one byte for each cell: ``S``, ``F``, ``H`` or ``G``."""
        return np.asarray(self._native.map(), dtype="c")

    @property
    def nrow(self) -> int:
        """The rows of the map."""
        return int(self.desc.shape[0])

    @property
    def ncol(self) -> int:
        """The columns of the map."""
        return int(self.desc.shape[1])


class CliffWalkingEnv(TabularEnv):
    """Walk along a cliff."""

    _id = "CliffWalking-v1"
    _actions = ("Up", "Right", "Down", "Left")

    shape = (4, 12)
    start_state_index = 36
    nS = 48
    nA = 4
    _constants = frozenset({"shape", "start_state_index", "nS", "nA"})


class TaxiEnv(TabularEnv):
    """Bring a passenger to a hotel."""

    _id = "Taxi-v4"
    _cell = "encoded"
    _actions = ("South", "North", "East", "West", "Pickup", "Dropoff")

    desc = np.asarray(
        ["+---------+", "|R: | : :G|", "| : | : : |", "| : : : : |", "| | : | : |", "|Y| : |B: |", "+---------+"], dtype="c"
    )
    #: Row and column of the stands: red, green, yellow, blue.
    locs = ((0, 0), (0, 4), (4, 0), (4, 3))
    _constants = frozenset({"desc", "locs"})

    @property
    def fickle_step(self) -> bool:
        """Whether the passenger will change the destination at the first move with them aboard."""
        return bool(self._state()["fickle_step"])

    def encode(self, taxi_row: int, taxi_col: int, pass_loc: int, dest_idx: int) -> int:
        """The number of a state: taxi's row and column (0 to 4), passenger (stand 0 to 3, or 4 in the taxi), destination."""
        return ((taxi_row * 5 + taxi_col) * 5 + pass_loc) * 4 + dest_idx

    def decode(self, i: int) -> tuple[int, int, int, int]:
        """The row, column, passenger and destination of a state's number."""
        return (i // 100, i // 20 % 5, i // 4 % 5, i % 4)

    def action_mask(self, state: int) -> npt.NDArray[np.int8]:
        """1 for each action that changes a state, 0 for those that do not."""
        actions = self.P[state]
        return np.array([any(outcome[1] != state for outcome in actions[a]) for a in sorted(actions)], np.int8)
