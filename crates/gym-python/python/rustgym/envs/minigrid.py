"""MiniGrid's environments, with the attributes that minigrid's wrappers read."""

from __future__ import annotations

import json
import sys
from copy import copy
from types import SimpleNamespace
from typing import Any

import numpy as np

from rustgym.env import ClassEnv

_KINDS = "unseen empty wall floor door key ball box goal lava agent".split()
_COLORS = "red green blue purple yellow grey".split()
_EMPTY, _WALL = (1, 0, 0), (2, 5, 0)


class Grid:
    """The cells of a grid, as minigrid's ``Grid``; each object has a ``type``, a ``color`` and a ``state``."""

    def __init__(self, image: np.ndarray) -> None:
        self.width, self.height, _ = image.shape
        cells = image.transpose(1, 0, 2).reshape(-1, 3).tolist()
        objects = [SimpleNamespace(type=_KINDS[kind], color=_COLORS[color], state=state) for kind, color, state in cells]
        self.grid = [None if cell.type in ("empty", "unseen") else cell for cell in objects]
        self._image = image

    def get(self, i: int, j: int) -> Any:
        """The object in a column and row; ``None`` in an empty cell."""
        return self.grid[j * self.width + i]

    def encode(self, vis_mask: np.ndarray | None = None) -> np.ndarray:
        """Kind, colour and state of each cell; zeros where ``vis_mask`` is false."""
        return self._image.copy() if vis_mask is None else self._image * vis_mask[..., None].astype(np.uint8)


def _parts(codes: Any) -> np.ndarray:
    """Kind, colour and state of encoded cells, as separate arrays."""
    codes = np.asarray(codes, np.uint32)
    return np.stack([codes & 0xFF, codes >> 8 & 0xF, codes >> 12 & 0xF], axis=-1).astype(np.uint8)


def _cells(grid: dict[str, Any]) -> np.ndarray:
    """The image of a grid: an array by column and row of kind, colour and state."""
    return _parts(grid["cells"]).reshape(grid["height"], grid["width"], 3).transpose(1, 0, 2)


def _visible(view: np.ndarray) -> np.ndarray:
    """Which cells of a view the agent sees. It stands in the middle of the last row; its sight spreads sideways and forward
    through cells that do not block it."""
    size = len(view)
    blocks = (view[..., 0] == _WALL[0]) | (view[..., 0] == _KINDS.index("door")) & (view[..., 2] != 0)
    seen = np.zeros((size, size), bool)
    seen[size // 2, -1] = True
    for row in range(size - 1, -1, -1):
        for columns, side in ((range(size - 1), 1), (range(size - 1, 0, -1), -1)):
            for column in columns:
                if seen[column, row] and not blocks[column, row]:
                    seen[column + side, row] = True
                    if row:
                        seen[[column, column + side], row - 1] = True
    return seen


def _grid(image: np.ndarray) -> Any:
    """The grid of an image. It is minigrid's own class if that package is imported, so that its ``isinstance`` tests work."""
    minigrid = sys.modules.get("minigrid.core.grid")
    return minigrid.Grid.decode(image)[0] if minigrid else Grid(image)


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

    def _argument(self, name: str) -> Any:
        return json.loads(self._native.arguments())[name]

    agent_view_size = property(lambda self: self._argument("agent_view_size"))
    see_through_walls = property(lambda self: self._argument("see_through_walls"))
    max_steps = property(lambda self: self._world()["max_steps"])
    width = property(lambda self: self._world()["grid"]["width"])
    height = property(lambda self: self._world()["grid"]["height"])
    agent_pos = property(lambda self: tuple(self._world()["agent"].values()))
    agent_dir = property(lambda self: self._world()["direction"])
    mission = property(lambda self: self._world()["mission"])
    step_count = property(lambda self: self._world()["step_count"])

    @property
    def front_pos(self) -> tuple[int, int]:
        """The position in front of the agent."""
        (x, y), (dx, dy) = self.agent_pos, [(1, 0), (0, 1), (-1, 0), (0, -1)][self.agent_dir]
        return x + dx, y + dy

    @property
    def grid(self) -> Any:
        """All cells."""
        return _grid(_cells(self._world()["grid"]))

    def gen_obs_grid(self, agent_view_size: int | None = None) -> tuple[Any, np.ndarray]:
        """The agent's view: the cells in front of it, rotated so that it faces up, and which of them it sees."""
        world, size = self._world(), agent_view_size or self.agent_view_size
        padded = np.full([n + 2 * size for n in (self.width, self.height)] + [3], _WALL, np.uint8)
        padded[size:-size, size:-size] = _cells(world["grid"])
        (x, y), direction, half = world["agent"].values(), world["direction"], size // 2
        left, top = [(x, y - half), (x - half, y), (x - size + 1, y - half), (x - half, y - size + 1)][direction]
        view = np.rot90(padded[left + size : left + 2 * size, top + size : top + 2 * size], -1 - direction).copy()
        seen = np.ones((size, size), bool) if self.see_through_walls else _visible(view)
        view[~seen] = _EMPTY
        view[half, size - 1] = _parts(world["carrying"])
        return _grid(view), seen

    def get_frame(self, highlight: bool = True, tile_size: int = 32, agent_pov: bool = False) -> np.ndarray:
        """A picture of the grid, or of the agent's view."""
        look = {"highlight": highlight, "tile_size": tile_size, "agent_pov": agent_pov}
        twin = type(self)(render_mode="rgb_array", **{**self._given, **look})
        twin.reset(seed=0)
        twin._native.set_state(json.dumps(self._world()))
        frame: np.ndarray = twin.render()
        return frame
