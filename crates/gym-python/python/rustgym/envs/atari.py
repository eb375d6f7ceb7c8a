"""The games of the Atari 2600, with what ale-py's users read of them: ``ale``, ``get_action_meanings()``, ``clone_state()``, ...

Nothing here needs ale-py, but for the ROMs that its package brings.
"""

from __future__ import annotations

import enum
import json
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym._native import Ale, AleState
from rustgym.env import ClassEnv, entropy, spec_of

__all__ = ["ALEInterface", "Action", "AleState", "AtariEnv"]


class Action(enum.Enum):
    """What a player does in a frame."""

    NOOP = 0
    FIRE = 1
    UP = 2
    RIGHT = 3
    LEFT = 4
    DOWN = 5
    UPRIGHT = 6
    UPLEFT = 7
    DOWNRIGHT = 8
    DOWNLEFT = 9
    UPFIRE = 10
    RIGHTFIRE = 11
    LEFTFIRE = 12
    DOWNFIRE = 13
    UPRIGHTFIRE = 14
    UPLEFTFIRE = 15
    DOWNRIGHTFIRE = 16
    DOWNLEFTFIRE = 17


# the keys of each part of an action's name, in the order in which ale-py gives them
_KEYS = {"UP": "w", "DOWN": "s", "LEFT": "a", "RIGHT": "d", "FIRE": " "}

#: What ``preprocessing`` is where it is only turned on.
PREPROCESSING: dict[str, Any] = {
    "noop_max": 30,
    "frame_skip": 4,
    "screen_size": 84,
    "terminal_on_life_loss": False,
    "clip_reward": False,
    "frame_stack": 4,
}


def preprocessed(env_id: str, how: bool | Mapping[str, Any], kwargs: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The arguments of a game whose pictures are preprocessed, and the wrappers of the Rust side that do it."""
    if "frameskip" not in spec_of(env_id)["defaults"]:
        raise TypeError(f"preprocessing is for the games of Atari: {env_id} is none")
    given = {} if isinstance(how, bool) else dict(how)
    for name in given:
        if name not in PREPROCESSING:
            raise TypeError(f"preprocessing has no {name!r}: it has {', '.join(PREPROCESSING)}")
    asked = PREPROCESSING | given
    size = asked["screen_size"]
    width, height = (size, size) if isinstance(size, int) else size
    names = ("noop_max", "frame_skip", "terminal_on_life_loss")
    arguments = {name: asked[name] for name in names} | {"screen_size": [height, width]}
    wrappers: list[dict[str, Any]] = [{"name": "AtariPreprocessing", "kwargs": arguments}]
    if asked["clip_reward"]:
        wrappers.append({"name": "ClipReward", "kwargs": {"min_reward": -1, "max_reward": 1}})
    if asked["frame_stack"]:
        wrappers.append({"name": "FrameStackObservation", "kwargs": {"stack_size": asked["frame_stack"]}})
    return {**kwargs, "frameskip": 1, "obs_type": "rgb"}, json.dumps(wrappers)


class ALEInterface:
    """The game that an environment plays, with the methods of ale-py's ``ALEInterface``.

    What it does, it does to the environment. Pictures and RAM are new arrays, or go to a buffer that is given.
    """

    def __init__(self, env: AtariEnv) -> None:
        self._env = env
        self._settings: dict[str, Any] = {
            "repeat_action_probability": env.arguments["repeat_action_probability"],
            "random_seed": 0,
            "frame_skip": 1,
            "color_averaging": False,
            "sound_obs": False,
            "display_screen": False,
            "sound": False,
        }
        # whether the game stands where loading the ROM leaves it
        self._is_loaded = False

    @property
    def _game(self) -> Ale:
        return Ale(self._env._native)

    def act(self, action: int | enum.Enum, paddle_strength: float = 1.0) -> int:
        """Plays a frame with an action, by number or name, and gives its reward."""
        self._is_loaded = False
        number = action.value if isinstance(action, enum.Enum) else getattr(action, "value", action)
        return self._game.act(number, paddle_strength, float(self._settings["repeat_action_probability"]))

    def reset_game(self) -> None:
        """Starts an episode."""
        if not self._is_loaded:
            self._game.reset()
        self._is_loaded = False

    def loadROM(self, rom_file: Any = None) -> None:  # noqa: N802 - ale-py's names, here and below
        """Loads the game again, with the seed ``random_seed``; it stays the game that the environment plays."""
        self._game.reload(int(self._settings["random_seed"]) & 0xFFFF_FFFF)
        self._is_loaded = True

    def lives(self) -> int:
        """The lives that are left; 0 where a game has none."""
        return self._game.progress()[0]

    def game_over(self, with_truncation: bool = True) -> bool:
        """Whether the game is over, or with ``with_truncation`` the episode has as many frames as it may."""
        _, over, truncated, _, _ = self._game.progress()
        return over or (with_truncation and truncated)

    def game_truncated(self) -> bool:
        """Whether the episode has as many frames as it may, and the game is not over."""
        _, over, truncated, _, _ = self._game.progress()
        return truncated and not over

    def getFrameNumber(self) -> int:  # noqa: N802
        """The frames since the game was made."""
        return self._game.progress()[3]

    def getEpisodeFrameNumber(self) -> int:  # noqa: N802
        """The frames of this episode."""
        return self._game.progress()[4]

    def getScreenDims(self) -> tuple[int, int]:  # noqa: N802
        """Height and width of the picture."""
        return self._game.facts()[1], 160

    def getScreen(self, buffer: npt.NDArray[np.uint8] | None = None) -> Any:  # noqa: N802
        """The picture as indices of colours, ``uint8`` of shape ``(height, 160)``."""
        return self._game.screen("index", buffer)

    def getScreenRGB(self, buffer: npt.NDArray[np.uint8] | None = None) -> Any:  # noqa: N802
        """The picture in red, green and blue, ``uint8`` of shape ``(height, 160, 3)``."""
        return self._game.screen("rgb", buffer)

    def getScreenGrayscale(self, buffer: npt.NDArray[np.uint8] | None = None) -> Any:  # noqa: N802
        """The picture in shades of gray, ``uint8`` of shape ``(height, 160)``."""
        return self._game.screen("gray", buffer)

    def getRAM(self, buffer: npt.NDArray[np.uint8] | None = None) -> Any:  # noqa: N802
        """The RAM, ``uint8`` of shape ``(128,)``."""
        return self._game.ram(buffer)

    def getRAMSize(self) -> int:  # noqa: N802
        """128."""
        return 128

    def setRAM(self, index: int, value: int) -> None:  # noqa: N802
        """Changes a byte of the RAM. Score and lives follow with the next frame."""
        self._is_loaded = False
        self._game.set_ram(index, value)

    def getAudio(self, buffer: Any = None) -> Any:  # noqa: N802
        """Refused: sound is not emulated."""
        raise gymnasium.error.Error("sound is not emulated, so there is no audio")

    def getLegalActionSet(self) -> list[Action]:  # noqa: N802
        """All actions."""
        return [Action(number) for number in self._game.facts()[2]]

    def getMinimalActionSet(self) -> list[Action]:  # noqa: N802
        """The actions that make a difference in the game."""
        return [Action(number) for number in self._game.facts()[3]]

    def getAvailableModes(self) -> list[int]:  # noqa: N802
        """The game's modes."""
        return sorted(self._game.facts()[4])

    def getAvailableDifficulties(self) -> list[int]:  # noqa: N802
        """The game's difficulties."""
        return sorted(self._game.facts()[5])

    def setMode(self, mode: int) -> None:  # noqa: N802
        """Chooses the mode of the episodes that follow."""
        _, difficulty, frames = self._game.settings()
        self._game.configure(mode, difficulty, frames)

    def setDifficulty(self, difficulty: int) -> None:  # noqa: N802
        """Chooses the difficulty of the episodes that follow."""
        mode, _, frames = self._game.settings()
        self._game.configure(mode, difficulty, frames)

    def cloneState(self, include_rng: bool = False) -> AleState:  # noqa: N802
        """Where the game stands; with ``include_rng`` sticky actions will stick again as they do now."""
        return self._game.state(include_rng)

    def cloneSystemState(self) -> AleState:  # noqa: N802
        """Where the game stands, random numbers included."""
        return self._game.state(True)

    def restoreState(self, state: AleState) -> None:  # noqa: N802
        """Goes on from where the game stood."""
        self._is_loaded = False
        self._game.set_state(state)

    restoreSystemState = restoreState  # noqa: N815

    def saveScreenPNG(self, path: Any) -> None:  # noqa: N802
        """Writes the picture to a file; needs Pillow."""
        from PIL import Image

        Image.fromarray(self.getScreenRGB()).save(path)

    # -- settings by name

    def _get(self, name: str) -> Any:
        if name == "max_num_frames_per_episode":
            return self._game.settings()[2] or 0
        return self._settings.get(name)

    def _set(self, name: str, value: Any) -> None:
        if name == "max_num_frames_per_episode":
            mode, difficulty, _ = self._game.settings()
            self._game.configure(mode, difficulty, int(value) or None)
        elif name in ("sound_obs", "sound", "display_screen") and value:
            raise gymnasium.error.Error(f"{name} cannot be turned on: the game has neither sound nor a window here")
        elif name in self._settings:
            self._settings[name] = value
        else:
            raise gymnasium.error.Error(f"there is no setting {name!r}: there are {', '.join(self._settings)}")

    def getInt(self, name: str) -> int:  # noqa: N802
        """A setting as a whole number; -1 for one that is unknown."""
        value = self._get(name)
        return -1 if value is None else int(value)

    def getFloat(self, name: str) -> float:  # noqa: N802
        """A setting as a number; -1 for one that is unknown."""
        value = self._get(name)
        return -1.0 if value is None else float(value)

    def getBool(self, name: str) -> bool:  # noqa: N802
        """A setting as a truth value."""
        return self._get(name) == 1

    def getString(self, name: str) -> str:  # noqa: N802
        """A setting as text; empty for one that is unknown."""
        value = self._get(name)
        return "" if value is None else str(int(value) if isinstance(value, bool) else value)

    setInt = setFloat = setBool = setString = _set  # noqa: N815

    def setLoggerMode(self, mode: Any) -> None:  # noqa: N802
        """Accepted: nothing is logged."""


class AtariEnv(ClassEnv):
    """A game of the Atari 2600.

    Args:
        preprocessing: ``True``, or a dict with some of ``noop_max=30``, ``frame_skip=4``, ``screen_size=84``,
            ``terminal_on_life_loss=False``, ``clip_reward=False``, ``frame_stack=4`` (0 for none): observations are then those of
            Gymnasium's ``AtariPreprocessing`` and ``FrameStackObservation``, made in Rust: ``uint8`` of shape ``(4, 84, 84)``.
            The game's own ``frameskip`` is 1 then.
        rom_dir: A folder with ROMs. Without one they are looked for in ``ALE_ROMS_DIR``, then in an installed ale-py.
        kwargs: The other arguments of ale-py's ``AtariEnv``.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 30}

    _interface: ALEInterface | None = None

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        preprocessing: bool | Mapping[str, Any] | None = None,
        **kwargs: Any,
    ) -> None:
        if preprocessing:
            kwargs, self._wrappers = preprocessed(self._id, preprocessing, kwargs)
        super().__init__(render_mode, **kwargs)

    @property
    def ale(self) -> ALEInterface:
        """The game."""
        if self._interface is None or self._interface._env is not self:
            self._interface = ALEInterface(self)
        return self._interface

    @property
    def _frameskip(self) -> int | tuple[int, int]:
        skip = self.arguments["frameskip"]
        return skip if isinstance(skip, int) else tuple(skip)

    @property
    def _game(self) -> str:
        return str(self.arguments["game"])

    @property
    def _game_mode(self) -> int | None:
        mode: int | None = self.arguments["mode"]
        return mode

    @property
    def _game_difficulty(self) -> int | None:
        difficulty: int | None = self.arguments["difficulty"]
        return difficulty

    @property
    def _obs_type(self) -> str:
        return str(self.arguments["obs_type"])

    @property
    def _action_set(self) -> list[Action]:
        whole = self.arguments["full_action_space"] or self.arguments["continuous"]
        return self.ale.getLegalActionSet() if whole else self.ale.getMinimalActionSet()

    def get_action_meanings(self) -> list[str]:
        """The name of each action, such as ``"RIGHTFIRE"``."""
        return [action.name for action in self._action_set]

    def get_keys_to_action(self) -> dict[tuple[str, ...], int]:
        """The action that each combination of keys stands for: w, a, s, d, the space bar, and e for nothing."""
        if self.arguments["continuous"]:
            raise AttributeError("get_keys_to_action: keys do not stand for continuous actions")
        keys = {}
        for number, action in enumerate(self._action_set):
            pressed = tuple(key for part, key in _KEYS.items() if part in action.name)
            keys[pressed or ("e",)] = number
        return keys

    def clone_state(self, include_rng: bool = False) -> AleState:
        """Where the game stands; with ``include_rng`` sticky actions will stick again as they do now."""
        return self.ale.cloneState(include_rng=include_rng)

    def restore_state(self, state: AleState) -> None:
        """Goes on from where the game stood."""
        self.ale.restoreState(state)

    def seed_game(self, seed: int | None = None) -> tuple[np.uint32, np.uint32]:
        """Seeds ``np_random`` and, from the next ``load_game`` on, the game: the two words that were used."""
        first, second = np.random.SeedSequence(entropy() if seed is None else seed).generate_state(2)
        self.np_random = np.random.default_rng(int(first))
        self.ale.setInt("random_seed", int(second))
        return first, second

    def load_game(self) -> None:
        """Loads the ROM again."""
        self.ale.loadROM()

    def render(self) -> Any:
        """As ``Env.render``: the game's own picture, ``uint8`` of shape ``(height, 160, 3)``."""
        return self.ale.getScreenRGB() if self.render_mode == "rgb_array" else super().render()

    def __copy__(self) -> Any:
        twin = super().__copy__()
        twin.__dict__.pop("_interface", None)
        return twin

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in super().__getstate__().items() if name != "_interface"}
