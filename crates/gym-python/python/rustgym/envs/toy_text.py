"""Blackjack, FrozenLake, CliffWalking and Taxi: Gymnasium's classes, with their tables."""

from __future__ import annotations

import json
import operator
from collections.abc import Callable
from copy import deepcopy
from functools import cached_property
from typing import Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym import _native
from rustgym._class_env import ClassEnv
from rustgym._errors import InvalidArgument
from rustgym._json import to_json
from rustgym._live import Live, Own
from rustgym._generators import generator_from
from rustgym._modules import forwarder
from rustgym._pictures import OfPicture, ReadOnlyList, absent
from rustgym.env import checked_seed, entropy

__all__ = ["BlackjackEnv", "CliffWalkingEnv", "FrozenLakeEnv", "TaxiEnv", "generate_random_map"]

# makes this module a package, as Gymnasium's is; `rustgym._modules` finds its submodules
__path__: list[str] = []
__getattr__ = forwarder(__name__)

#: The outcomes of an action in a state: probability, next state, reward, whether the episode ends.
Outcomes = list[tuple[float, int, float, bool]]


def generate_random_map(size: int = 8, p: float = 0.8, seed: int | None = None) -> list[str]:
    """A random map for FrozenLake with a path from start to goal, equal to Gymnasium's for the same seed.

    Args:
        size: Rows and columns, at least 2.
        p: The probability of a frozen cell, above 0 and at most 1.
        seed: The seed; without one the operating system gives it.

    Raises:
        ValueError: for a size or a probability out of its range.
    """
    if size < 0:
        raise ValueError(f"size is {size}: the smallest map is 2 by 2")
    return _native.generate_random_map(size, p, seed)


class ToyTextEnv(ClassEnv):
    """An environment of a few cards or cells."""

    # arguments that Gymnasium's environment reads in each step, so that setting them takes effect
    _settable: ClassVar[frozenset[str]] = frozenset()

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self._settable and "arguments" in self.__dict__:
            self._rebuild({name: value})
            self.arguments[name] = self.__dict__[name] = value
        else:
            super().__setattr__(name, value)

    def _state(self) -> dict[str, Any]:
        state = self._native.state()
        if state is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        result: dict[str, Any] = json.loads(state)
        return result

    # attributes of an episode
    _of_episode: ClassVar[tuple[str, ...]] = ()

    def _carrier(self, cause: str) -> Callable[[Any], None]:
        values = {name: getattr(self, name) for name in (*self._of_episode, *self._settable) if hasattr(self, name)}
        values["_np_random"] = generator_from(json.loads(self._native.generator() or "[]"))
        return lambda inner: inner.__dict__.update(values)

    def _set_state(self, **fields: Any) -> None:
        """Sets these fields of the state; before the first reset, it resets first."""
        if self._native.state() is None:
            self._native.reset(str(entropy()), None)
        self._native.set_state(to_json({**self._state(), **fields}))


def _draw(probabilities: Any, rng: np.random.Generator) -> int:
    """Gymnasium's ``categorical_sample``: the first index at which the cumulative probability exceeds a random draw."""
    return int(np.argmax(np.cumsum(np.asarray(probabilities)) > rng.random()))


class TabularEnv(ToyTextEnv):
    """An environment whose dynamics are a table.

    If a user has changed ``P`` for an action, Python draws the action's outcome from ``P``, as Gymnasium does for all actions.
    If a user has changed ``initial_state_distrib``, Python draws the start from it.
    """

    # the field of the native state that stores the number of the state
    _cell: ClassVar[str] = "cell"
    _of_episode = ("s", "lastaction")
    _actions: ClassVar[tuple[str, ...]]

    # whether the states in Gymnasium's table are numpy's integers
    _has_wide_states: ClassVar[bool] = False
    # whether Gymnasium's `lastaction` exists before the first reset
    _has_early_action: ClassVar[bool] = False

    clock = OfPicture(until="render")

    def _made_table(self) -> tuple[dict[int, dict[int, Outcomes]], list[float]]:
        table = self._native.table()
        assert table is not None
        return table

    @cached_property
    def _table(self) -> tuple[dict[int, dict[int, Outcomes]], list[float]]:
        """The transitions and start probabilities of the native environment."""
        return self._made_table()

    P = Own(
        lambda self: self._made_table()[0],
        doc="``P[state][action]``: the possible outcomes of an action, as ``(probability, next state, reward, terminated)``.",
    )

    initial_state_distrib = Own(
        lambda self: np.array(self._table[1]),
        doc="The probability of each state at the start.",
    )

    def _whole(self, action: Any) -> Any:
        """The ``int`` that equals ``action``, such as 1 for 1.0; for an invalid action, ``action`` itself."""
        actions = range(int(self.action_space.n))  # type: ignore[attr-defined]
        return next((whole for whole in actions if np.ndim(action) == 0 and whole == action), action)

    def _watched_step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        table: Any = (self._handed or {}).get("P")
        if table is None or not self._native.is_running():
            return super()._watched_step(action)
        action = self._whole(action)
        state = self.s
        row = table[state][action]
        if row == self._table[0][state].get(action):
            return super()._watched_step(action)
        self._check(row, f"P[{state}][{action}]")
        self._push("step")
        rng = self._np_random
        assert rng is not None
        probability, cell, reward, terminated = row[_draw([outcome[0] for outcome in row], rng)]
        cell = self._moved(state, int(cell), rng)
        self._set_state(
            **{self._cell: cell}, last_action=self._actions[int(action)], probability=float(probability), **self._fields(action)
        )
        self._push_generator()
        self._follow()
        return cell, reward, terminated, False, self._info(probability, cell)

    def _check(self, row: Any, place: str) -> None:
        """Refuse outcomes that a vector refuses too."""
        states = len(self._table[0])
        if not row:
            raise InvalidArgument(f"{place} has no outcome")
        for outcome in row:
            probability, cell, reward, _ = outcome
            if not (0 <= probability <= 1 and 0 <= cell < states and np.isfinite(reward)):
                raise InvalidArgument(
                    f"{place}: {outcome} needs a probability from 0 to 1, a next state below {states} and a finite reward"
                )

    def _push_into_vector(self) -> None:
        super()._push_into_vector()
        handed = self._handed or {}
        table: Any = handed.get("P", self._table[0])
        starts = handed.get("initial_state_distrib", self._table[1])
        if table != self._table[0] or not np.array_equal(starts, self._table[1]):
            rows = [[table[s][a] for a in sorted(table[s])] for s in sorted(table)]
            whole = {"P": rows, "initial_state_distrib": np.asarray(starts, np.float64)}
            self._native.set_table(to_json(whole))
            self.__dict__.pop("_table", None)

    def _moved(self, state: int, cell: int, rng: np.random.Generator) -> int:
        """The next state after random changes that the table does not contain; ``cell`` is the table's next state."""
        return cell

    def _fields(self, action: Any) -> dict[str, Any]:
        """Further fields of the native state that ``action`` sets."""
        return {}

    def _info(self, probability: Any, cell: int) -> dict[str, Any]:
        return {"prob": probability}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """As ``Env.reset``."""
        starts = (self._handed or {}).get("initial_state_distrib")
        if starts is None or np.array_equal(starts, self._table[1]):
            return super().reset(seed=seed, options=options)
        if len(starts) != len(self._table[1]) or not all(0 <= start <= 1 for start in starts):
            raise InvalidArgument(f"initial_state_distrib needs {len(self._table[1])} probabilities from 0 to 1")
        if seed is None and self._np_random is None:
            seed = entropy()
        # the reset's first draw decides the start: a copy of the generator repeats it
        rng = np.random.default_rng(checked_seed(seed)) if seed is not None else deepcopy(self._np_random)
        assert rng is not None
        _, info = super().reset(seed=seed, options=options)
        cell = _draw(starts, rng)
        self._set_state(**{self._cell: cell})
        return cell, self._info(info["prob"], cell)

    @property
    def s(self) -> int:
        """The state's number. Setting it continues from there."""
        state = self._state()
        cell = int(state[self._cell])
        # Gymnasium's start is an integer of numpy
        return np.int64(cell) if self._has_wide_states or state["last_action"] is None else cell  # type: ignore[return-value]

    @s.setter
    def s(self, number: int) -> None:
        self._set_state(**{self._cell: operator.index(number)})

    @property
    def lastaction(self) -> int | None:
        """The last action; ``None`` at the start."""
        if self._has_early_action and self._native.state() is None:
            return None
        action = self._state()["last_action"]
        return None if action is None else self._actions.index(action)

    @lastaction.setter
    def lastaction(self, action: int | None) -> None:
        if action is not None and operator.index(action) not in range(len(self._actions)):
            raise ValueError(f"lastaction is {action}: it is None or from 0 to {len(self._actions) - 1}")
        self._set_state(last_action=None if action is None else self._actions[action])


class BlackjackEnv(ToyTextEnv):
    """Come closer to 21 than the dealer."""

    _id = "Blackjack-v1"
    _settable = frozenset({"natural", "sab"})
    _of_episode = ("player", "dealer", "dealer_top_card_suit", "dealer_top_card_value_str")

    def _write_player(self, cards: Any) -> None:
        self._set_state(player=[operator.index(card) for card in cards])

    def _write_dealer(self, cards: Any) -> None:
        cards = [operator.index(card) for card in cards]
        # if the open card is worth 10, the picture shows a jack, queen or king
        face = (self._state()["face"] or "Jack") if cards[:1] == [10] else None
        self._set_state(dealer=cards, face=face)

    def _follow_player(self, cards: list[int]) -> None:
        cards[:] = self._state()["player"]

    def _follow_dealer(self, cards: list[int]) -> None:
        cards[:] = self._state()["dealer"]

    player = Live(
        lambda self: list(self._state()["player"]),
        _write_player,
        follow=_follow_player,
        doc="The player's cards; an ace is 1.",
    )
    dealer = Live(
        lambda self: list(self._state()["dealer"]),
        _write_dealer,
        follow=_follow_dealer,
        doc="The dealer's cards, of which the first is open; an ace is 1.",
    )

    def _get_obs(self) -> tuple[int, int, int]:
        has_ace = 1 in self.player and sum(self.player) + 10 <= 21
        return sum(self.player) + 10 * has_ace, self.dealer[0], int(has_ace)

    @property
    def dealer_top_card_suit(self) -> str:
        """The suit of the dealer's open card in the picture: ``C``, ``D``, ``H`` or ``S``. It can be set."""
        return np.str_(self._state()["suit"][0])

    @dealer_top_card_suit.setter
    def dealer_top_card_suit(self, suit: str) -> None:
        suits = {name[0]: name for name in ("Clubs", "Diamonds", "Hearts", "Spades")}
        if suit not in suits:
            raise ValueError(f"dealer_top_card_suit is {suit!r}: it is C, D, H or S")
        self._set_state(suit=suits[suit])

    @property
    def dealer_top_card_value_str(self) -> str:
        """The dealer's open card in the picture: ``A``, a number, ``J``, ``Q`` or ``K``. A face can be set to another face."""
        state = self._state()
        card = state["dealer"][0]
        return np.str_(state["face"][0]) if state["face"] else "A" if card == 1 else str(card)

    @dealer_top_card_value_str.setter
    def dealer_top_card_value_str(self, value: str) -> None:
        if value == self.dealer_top_card_value_str:
            return
        faces = {name[0]: name for name in ("Jack", "Queen", "King")}
        if value not in faces or self._state()["face"] is None:
            raise ValueError(f"dealer_top_card_value_str cannot be {value!r}: it shows the card dealer[0], {self.dealer[0]}")
        self._set_state(face=faces[value])


class FrozenLakeEnv(TabularEnv):
    """Cross a frozen lake without falling into its holes."""

    _id = "FrozenLake-v1"
    _actions = ("Left", "Down", "Right", "Up")
    _beside = {"reward_range": lambda self: tuple(f(self._given.get("reward_schedule", (1, 0, 0))) for f in (min, max))}

    window_size = OfPicture(lambda self: (min(64 * self.ncol, 512), min(64 * self.nrow, 512)))
    cell_size = OfPicture(lambda self: (self.window_size[0] // self.ncol, self.window_size[1] // self.nrow))
    window_surface, ice_img, ice_crack_imgs, hole_img = (OfPicture(until="render") for _ in range(4))
    agent_img, goal_flag_img, letter_s_img, letter_g_img = (OfPicture(until="render") for _ in range(4))

    def _write_desc(self, desc: Any) -> None:
        # Gymnasium makes its tables once: a new `desc` changes the pictures, and not the transitions
        _ = self.P, self.initial_state_distrib
        self._rebuild({"desc": np.asarray(desc, dtype="c")})
        self.__dict__.pop("_table", None)

    desc = Live(
        lambda self: np.asarray(self._native.map(), dtype="c"),
        _write_desc,
        outlives_reset=True,
        outlives_step=True,
        doc="The map, one byte for each cell: ``S``, ``F``, ``H`` or ``G``.",
    )

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

    _has_wide_states = True

    shape = (4, 12)
    start_state_index = np.int64(36)
    nS = np.int64(48)
    nA = 4
    _constants = frozenset({"shape", "start_state_index", "nS", "nA"})

    cell_size, window_size = OfPicture((64, 64)), OfPicture((768, 256))
    window_surface, agent_img, start_img, goal_img = (OfPicture(until="render") for _ in range(4))
    goal_flag_img, cliff_imgs, ground_img = (OfPicture(until="render") for _ in range(3))

    def _made_table(self) -> tuple[dict[int, dict[int, Outcomes]], list[float]]:
        table, starts = super()._made_table()
        wide = {s: {a: [(p, np.int64(to), r, t) for p, to, r, t in row] for a, row in table[s].items()} for s in table}
        return wide, starts  # type: ignore[return-value]


class TaxiEnv(TabularEnv):
    """Bring a passenger to a hotel."""

    _id = "Taxi-v4"
    _settable = frozenset({"fickle_passenger", "fickle_probability"})
    _of_episode = ("s", "lastaction", "fickle_step", "taxi_orientation")
    _cell = "encoded"
    _actions = ("South", "North", "East", "West", "Pickup", "Dropoff")

    desc = np.asarray(
        ["+---------+", "|R: | : :G|", "| : | : : |", "| : : : : |", "| | : | : |", "|Y| : |B: |", "+---------+"], dtype="c"
    )
    desc.flags.writeable = False
    _has_early_action = True
    #: Row and column of the stands, and their colours: red, green, yellow, blue.
    locs = ReadOnlyList([(0, 0), (0, 4), (4, 0), (4, 3)])
    locs_colors = ReadOnlyList([(255, 0, 0), (0, 255, 0), (255, 255, 0), (0, 0, 255)])
    _constants = frozenset({"desc", "locs", "locs_colors"})
    _beside = {"max_row": lambda self: 4, "max_col": lambda self: 4}
    _absent = absent("get_surf_loc", "it gives places in Gymnasium's picture, and render() draws another picture")

    cell_size = OfPicture((88, 56))
    window, taxi_imgs, taxi_full_imgs, passenger_img = (OfPicture(until="render") for _ in range(4))
    destination_img, house_img, background_img = (OfPicture(until="render") for _ in range(3))
    taxi_orientation = OfPicture(
        lambda self: self._actions.index(self._state()["heading"]) if self._has_drawn and self.render_mode != "ansi" else 0
    )

    @property
    def fickle_step(self) -> bool:
        """Whether the passenger will change the destination at the first move with them aboard."""
        early: bool = self.__dict__.get("fickle_step", False)  # a reset draws it
        return early if self._native.state() is None else bool(self._state()["fickle_step"])

    @fickle_step.setter
    def fickle_step(self, will_change: bool) -> None:
        if self._native.state() is None:
            self.__dict__["fickle_step"] = will_change
        else:
            self._set_state(fickle_step=bool(will_change))

    def _moved(self, state: int, cell: int, rng: np.random.Generator) -> int:
        (row, column, passenger, destination), (r, c, p, _) = self.decode(state), self.decode(cell)
        if not (self.arguments["fickle_passenger"] and self.fickle_step and passenger == 4 and (r, c) != (row, column)):
            return cell
        self.fickle_step = False
        return self.encode(r, c, p, int(rng.choice([i for i in range(4) if i != destination])))

    def _fields(self, action: Any) -> dict[str, Any]:
        return {"heading": self._actions[int(action)]} if action < 4 else {}

    def _info(self, probability: Any, cell: int) -> dict[str, Any]:
        return {"prob": probability, "action_mask": self.action_mask(cell)}

    def encode(self, taxi_row: int, taxi_col: int, pass_loc: int, dest_idx: int) -> int:
        """The number of a state: taxi's row and column (0 to 4), passenger (stand 0 to 3, or 4 in the taxi), destination."""
        return ((taxi_row * 5 + taxi_col) * 5 + pass_loc) * 4 + dest_idx

    def decode(self, i: int) -> tuple[int, int, int, int]:
        """The row, column, passenger and destination of a state's number."""
        return (i // 100, i // 20 % 5, i // 4 % 5, i % 4)

    def action_mask(self, state: int) -> npt.NDArray[np.int8]:
        """1 for each action that changes a state, 0 for those that do not."""
        actions = self._table[0][state]
        return np.array([any(outcome[1] != state for outcome in actions[a]) for a in sorted(actions)], np.int8)
