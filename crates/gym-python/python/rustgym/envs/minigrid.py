"""MiniGrid's environments. What is not here is minigrid's: looking at it opens the environment (``rustgym._opened``)."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import copy
from enum import IntEnum
from importlib import import_module
from typing import Any, NamedTuple, NoReturn

import gymnasium
import numpy as np

from rustgym._class_env import ClassEnv
from rustgym._opened import package_of
from rustgym._specs import class_of

_KINDS = "unseen empty wall floor door key ball box goal lava agent".split()
_COLORS = "red green blue purple yellow grey".split()
_EMPTY, _WALL = (1, 0, 0), (2, 5, 0)
_STEPS = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])

#: What minigrid's `step` and `reset` call.
_CALLED = frozenset(
    "_gen_grid _reward gen_obs gen_obs_grid place_agent place_obj put_obj get_view_exts dir_vec front_pos steps_remaining".split()
)

Actions = IntEnum("Actions", "left right forward pickup drop toggle done", start=0)


# minigrid's classes whose names (without `Env`, for MiniGrid) begin the names of their ids
_MINIGRID = """BlockedUnlockPickup DistShift DoorKey DynamicObstacles Empty Fetch FourRooms GoToDoor GoToObject KeyCorridor LavaGap
    LockedRoom Memory MultiRoom Playground PutNear RedBlueDoor Unlock UnlockPickup""".split()
_BABYAI = """ActionObjDoor BlockedUnlockPickup BossLevel BossLevelNoUnlock GoTo GoToDoor GoToImpUnlock GoToLocal GoToObj GoToObjDoor
    GoToRedBall GoToRedBallGrey GoToRedBallNoDists GoToRedBlueBall GoToSeq KeyCorridor KeyInBox MiniBossLevel MoveTwoAcross Open
    OpenDoor OpenDoorsOrder OpenRedDoor OpenTwoDoors Pickup PickupAbove PickupDist PickupLoc PutNext PutNextLocal Synth SynthLoc
    SynthSeq UnblockPickup Unlock UnlockLocal UnlockPickup UnlockToUnlock""".split()
# the others, by the beginning of the id
_OTHERS = {
    "BabyAI-FindObj": "FindObjS5",
    "BabyAI-GoToObjMaze": "GoTo",
    "BabyAI-OneRoom": "OneRoomS8",
    "BabyAI-OpenRedBlueDoors": "OpenTwoDoors",
    "MiniGrid-LavaCrossing": "CrossingEnv",
    "MiniGrid-ObstructedMaze": "ObstructedMaze_Full",
    "MiniGrid-ObstructedMaze-1Dl": "ObstructedMaze_1Dlhb",
    "MiniGrid-SimpleCrossing": "CrossingEnv",
}
_CLASSES = {
    **{f"MiniGrid-{name}": f"{name}Env" for name in _MINIGRID},
    **{f"BabyAI-{name}": name for name in _BABYAI},
    **_OTHERS,
}


def name_of_class(env_id: str) -> str:
    """The name of minigrid's class of an id."""
    if env_id.startswith("MiniGrid-ObstructedMaze-") and env_id.endswith("-v1"):
        return "ObstructedMaze_Full_V1"
    name = env_id.replace("Dynamic-", "Dynamic")
    starts = [start for start in _CLASSES if name.startswith(start)]
    return _CLASSES[max(starts, key=len)] if starts else "GridEnv"


class Cell(NamedTuple):
    """An object in a grid."""

    type: str
    color: str
    state: int


class Grid:
    """The cells of a grid, without the package minigrid. Read-only."""

    def __init__(self, image: np.ndarray) -> None:
        self.width, self.height, _ = image.shape
        cells = image.transpose(1, 0, 2).reshape(-1, 3).tolist()
        objects = [Cell(_KINDS[kind], _COLORS[color], state) for kind, color, state in cells]
        self.grid = tuple(None if cell.type in ("empty", "unseen") else cell for cell in objects)
        self._image = image

    def get(self, i: int, j: int) -> Cell | None:
        """The object in a column and row; ``None`` in an empty cell."""
        return self.grid[j * self.width + i]

    def set(self, i: int, j: int, v: Any) -> NoReturn:
        """Raises an error: the package minigrid has the objects that can be set."""
        raise gymnasium.error.DependencyNotInstalled(f"a grid can be changed with the package minigrid: {_REMEDY}")

    def encode(self, vis_mask: np.ndarray | None = None) -> np.ndarray:
        """Kind, colour and state of each cell; zeros where ``vis_mask`` is false."""
        return self._image.copy() if vis_mask is None else self._image * vis_mask[..., None].astype(np.uint8)


_REMEDY = "run `pip install minigrid`"


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


def _of_episode(read: Callable[[Any], Any], doc: str) -> property:
    """A property of the world. Before the first reset it is minigrid's."""
    name = doc.partition(":")[0]

    def get(self: GridEnv) -> Any:
        return getattr(self, name) if not self._was_reset() and self._opens(name) else read(self)

    return property(get, doc=doc)


class GridEnv(ClassEnv):
    """An environment of MiniGrid or BabyAI."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        called = sorted(_CALLED & vars(cls).keys())
        if called and cls.__module__ != __name__ and "_opened_package" not in vars(cls) and package_of(cls._id) is None:
            raise gymnasium.error.DependencyNotInstalled(f"{cls.__name__} overrides {called[0]}, which minigrid calls: {_REMEDY}")

    def _world(self) -> dict[str, Any]:
        if (state := self._native.state()) is None:  # only the size is known
            twin = copy(self)
            twin.reset(seed=0)
            state = twin._native.state()
        world: dict[str, Any] = json.loads(state or "{}")
        return world

    def _argument(self, name: str) -> Any:
        return json.loads(self._native.arguments())[name]

    @property
    def actions(self) -> type[IntEnum]:
        """The actions, an enumeration: minigrid's own if that package is installed."""
        package = package_of(self.env_id)
        made: type[IntEnum] = import_module("minigrid.core.actions").Actions if package else Actions
        return made

    agent_view_size = property(lambda self: self._argument("agent_view_size"))
    see_through_walls = property(lambda self: self._argument("see_through_walls"))
    max_steps = property(lambda self: self._world()["max_steps"])
    width = property(lambda self: self._world()["grid"]["width"])
    height = property(lambda self: self._world()["grid"]["height"])
    agent_pos = _of_episode(lambda self: tuple(self._world()["agent"].values()), "agent_pos: column and row.")
    agent_dir = _of_episode(lambda self: self._world()["direction"], "agent_dir: 0 is right, 1 down, 2 left, 3 up.")
    mission = _of_episode(lambda self: self._world()["mission"], "mission: the task, as a sentence.")
    step_count = _of_episode(lambda self: self._world()["step_count"], "step_count: the steps since the reset.")

    @property
    def front_pos(self) -> np.ndarray:
        """The position in front of the agent."""
        position: np.ndarray = self.agent_pos + _STEPS[self.agent_dir]
        return position

    @property
    def grid(self) -> Any:
        """All cells: minigrid's own ``Grid``, or without that package a copy that cannot be changed."""
        return self.grid if self._opens("grid") else Grid(_cells(self._world()["grid"]))

    def gen_obs_grid(self, agent_view_size: int | None = None) -> tuple[Any, np.ndarray]:
        """The agent's view: the cells in front of it, rotated so that it faces up, and which of them it sees."""
        if self._opens("gen_obs_grid"):
            view: tuple[Any, np.ndarray] = self.gen_obs_grid(agent_view_size)
            return view
        return self._view(agent_view_size or self.agent_view_size)

    def _view(self, size: int) -> tuple[Grid, np.ndarray]:
        world = self._world()
        padded = np.full([n + 2 * size for n in (self.width, self.height)] + [3], _WALL, np.uint8)
        padded[size:-size, size:-size] = _cells(world["grid"])
        (x, y), direction, half = world["agent"].values(), world["direction"], size // 2
        left, top = [(x, y - half), (x - half, y), (x - size + 1, y - half), (x - half, y - size + 1)][direction]
        view = np.rot90(padded[left + size : left + 2 * size, top + size : top + 2 * size], -1 - direction).copy()
        seen = np.ones((size, size), bool) if self.see_through_walls else _visible(view)
        view[~seen] = _EMPTY
        view[half, size - 1] = _parts(world["carrying"])
        return Grid(view), seen

    def get_frame(self, highlight: bool = True, tile_size: int = 32, agent_pov: bool = False) -> np.ndarray:
        """A picture of the grid, or of the agent's view."""
        look = {"highlight": highlight, "tile_size": tile_size, "agent_pov": agent_pov}
        twin = class_of(self.env_id)(render_mode="rgb_array", **{**self._given, **look})
        twin.reset(seed=0)
        twin._native.set_state(json.dumps(self._world()))
        frame: np.ndarray = twin.render()
        return frame

    def _is_read_elsewhere(self, name: str, value: Any) -> bool:
        if isinstance(getattr(GridEnv, name, None), property):
            if self._opens(name):
                return True
            raise gymnasium.error.DependencyNotInstalled(f"{name} can be set with the package minigrid: {_REMEDY}")
        return super()._is_read_elsewhere(name, value)
