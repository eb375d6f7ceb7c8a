"""MiniGrid's environments, with the attributes that minigrid's wrappers read."""

from __future__ import annotations

import json
from copy import copy
from types import SimpleNamespace
from typing import Any

import numpy as np

from rustgym.env import ClassEnv

_KINDS = "unseen empty wall floor door key ball box goal lava agent".split()
_COLORS = "red green blue purple yellow grey".split()


class Grid:
    """The cells of a grid, as minigrid's ``Grid``; each object has a ``type``, a ``color`` and a ``state``."""

    def __init__(self, width: int, height: int, cells: list[int]) -> None:
        codes = np.array(cells, np.uint32)
        parts = np.stack([codes & 0xFF, codes >> 8 & 0xF, codes >> 12 & 0xF], axis=-1).astype(np.uint8)
        objects = [SimpleNamespace(type=_KINDS[kind], color=_COLORS[color], state=state) for kind, color, state in parts.tolist()]
        self.width, self.height = width, height
        self.grid = [None if cell.type == "empty" else cell for cell in objects]
        self._image = parts.reshape(height, width, 3).transpose(1, 0, 2)

    def get(self, i: int, j: int) -> Any:
        """The object in a column and row; ``None`` in an empty cell."""
        return self.grid[j * self.width + i]

    def encode(self) -> np.ndarray:
        """Kind, colour and state of each cell."""
        return np.array(self._image)


class GridEnv(ClassEnv):
    """An environment of MiniGrid or BabyAI."""

    actions = SimpleNamespace(left=0, right=1, forward=2, pickup=3, drop=4, toggle=5, done=6)

    def _world(self) -> dict[str, Any]:
        if (state := self._native.state()) is None:  # only the size is known
            twin = copy(self)
            twin.reset(seed=0)
            state = twin._native.state()
        world: dict[str, Any] = json.loads(state or "{}")
        return world

    width = property(lambda self: self._world()["grid"]["width"])
    height = property(lambda self: self._world()["grid"]["height"])
    grid = property(lambda self: Grid(**self._world()["grid"]))
    agent_pos = property(lambda self: tuple(self._world()["agent"].values()))
    agent_dir = property(lambda self: self._world()["direction"])
    mission = property(lambda self: self._world()["mission"])
    step_count = property(lambda self: self._world()["step_count"])

    @property
    def front_pos(self) -> tuple[int, int]:
        """The place in front of the agent."""
        (x, y), (dx, dy) = self.agent_pos, [(1, 0), (0, 1), (-1, 0), (0, -1)][self.agent_dir]
        return x + dx, y + dy

    def get_frame(self, highlight: bool = True, tile_size: int = 32, agent_pov: bool = False) -> np.ndarray:
        """A picture of the grid, or of what the agent sees."""
        look = {"highlight": highlight, "tile_size": tile_size, "agent_pov": agent_pov}
        twin = type(self)(render_mode="rgb_array", **{**self._given, **look})
        twin.reset(seed=0)
        twin._native.set_state(json.dumps(self._world()))
        frame: np.ndarray = twin.render()
        return frame
