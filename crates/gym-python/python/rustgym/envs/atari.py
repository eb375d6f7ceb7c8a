"""The games of Atari: ale-py's attributes and methods, and the usual preprocessing in Rust."""

from __future__ import annotations

import operator
import os
import stat
import struct
import zlib
from collections.abc import Mapping
from enum import IntEnum
from pathlib import Path
from typing import Any, SupportsIndex

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.utils import seeding

from rustgym import _native
from rustgym._class_env import ClassEnv
from rustgym._native import AleState
from rustgym._preprocessing import preprocessed
from rustgym.env import entropy

__all__ = ["Action", "Ale", "AleState", "AtariEnv"]

Buffer = npt.NDArray[np.uint8]


# with ale-py's names and values
Action = IntEnum(
    "Action",
    "NOOP FIRE UP RIGHT LEFT DOWN UPRIGHT UPLEFT DOWNRIGHT DOWNLEFT UPFIRE RIGHTFIRE LEFTFIRE DOWNFIRE "
    "UPRIGHTFIRE UPLEFTFIRE DOWNRIGHTFIRE DOWNLEFTFIRE",
    start=0,
)

# ale-py's settings that are equal in all of Gymnasium's environments
_SETTINGS = {
    "frame_skip": "1",
    "max_num_frames": "0",
    "reward_min": "-2147483648",
    "reward_max": "2147483647",
    "truncate_on_loss_of_life": "0",
    "display_screen": "0",
    "sound": "false",
    "record_sound_filename": "",
    "record_screen_dir": "",
    "color_averaging": "0",
    "send_rgb": "0",
    "restricted_action_set": "0",
    "cpu": "low",
    "system_random_seed": "4753849",
}

# the settings that ale-py takes of one type
_TYPED = ("mode", "difficulty", "repeat_action_probability")

# in bytes: twice the longest cartridge
_LONGEST_ROM = 1 << 20

# the keys of `gymnasium.utils.play`, in the order in which ale-py lists the keys of an action
_KEYS = {"UP": "w", "DOWN": "s", "RIGHT": "d", "LEFT": "a", "FIRE": " "}


class Ale:
    """The game of an environment, for direct access, with the methods of ale-py's ``ALEInterface``.

    Unlike ale-py's, it plays only the ROM of its environment, and has no sound. The getters of settings return the arguments
    of ``make``. Pictures and RAM come as new arrays or are written to a ``uint8`` buffer of their shape.
    """

    def __init__(self, env: AtariEnv) -> None:
        self._env = env
        self._native = _native.Ale(env._native)

    # -- playing

    def act(self, action: SupportsIndex | Action, paddle_strength: float = 1.0) -> int:
        """Plays a frame and returns the reward. The last action may stick. ``ValueError`` for an invalid ``Action``."""
        # (ale-py's own `Action` is not an integer)
        return self._native.act(action if isinstance(action, int) else operator.index(getattr(action, "value", action)), paddle_strength)

    def reset_game(self) -> None:
        self._native.reset()

    def lives(self) -> int:
        """The number of lives; 0 in games without lives."""
        return self._native.progress()[0]

    def game_over(self, with_truncation: bool = True) -> bool:
        """Whether the episode has ended: the game is over, or the limit of frames is reached."""
        _, is_over, is_truncated, _, _ = self._native.progress()
        return is_over or (with_truncation and is_truncated)

    def game_truncated(self) -> bool:
        return self._native.progress()[2]

    def getFrameNumber(self) -> int:
        return self._native.progress()[3]

    def getEpisodeFrameNumber(self) -> int:
        return self._native.progress()[4]

    # -- looking

    def getScreen(self, buffer: Buffer | None = None) -> Any:
        """The picture as indices of colours, shape ``(rows, 160)``."""
        return self._native.screen("index", buffer)

    def getScreenRGB(self, buffer: Buffer | None = None) -> Any:
        """The picture in colours, shape ``(rows, 160, 3)``."""
        return self._native.screen("rgb", buffer)

    def getScreenGrayscale(self, buffer: Buffer | None = None) -> Any:
        """The picture in gray, shape ``(rows, 160)``."""
        return self._native.screen("gray", buffer)

    def getScreenDims(self) -> tuple[int, int]:
        """Rows and columns of the picture."""
        return self._native.facts()[1], 160

    def getRAM(self, buffer: Buffer | None = None) -> Any:
        """The RAM, shape ``(128,)``."""
        return self._native.ram(buffer)

    def getRAMSize(self) -> int:
        return 128

    def setRAM(self, index: int, value: int) -> None:
        """Changes a byte of the RAM. Raises ``RuntimeError`` for an index or a value out of range."""
        if index not in range(128) or value not in range(256):
            raise RuntimeError(f"RAM byte {index!r} cannot be set to {value!r}: indices are 0 to 127, values 0 to 255")
        self._native.set_ram(index, value)

    def getAudio(self, buffer: Buffer | None = None) -> Any:
        """Raises ``gymnasium.error.Error``: sound is not emulated."""
        raise gymnasium.error.Error("sound is not emulated")

    # -- the game and its settings

    def getLegalActionSet(self) -> list[Action]:
        """The actions that the game accepts."""
        return [Action(number) for number in self._native.facts()[2]]

    def getMinimalActionSet(self) -> list[Action]:
        """The actions that have an effect in the game."""
        return [Action(number) for number in self._native.facts()[3]]

    def getAvailableModes(self) -> list[int]:
        return self._native.facts()[4]

    def getAvailableDifficulties(self) -> list[int]:
        return self._native.facts()[5]

    def setMode(self, mode: int) -> None:
        """Sets the mode from the next reset on; raises ``RuntimeError`` if the game does not have it."""
        if mode not in self.getAvailableModes():
            raise RuntimeError(f"the game has no mode {mode!r}: its modes are {self.getAvailableModes()}")
        _, difficulty, max_frames = self._native.settings()
        self._native.configure(mode, difficulty, max_frames)

    def setDifficulty(self, difficulty: int) -> None:
        """Sets the difficulty from the next reset on; raises ``RuntimeError`` if the game does not have it."""
        if difficulty not in self.getAvailableDifficulties():
            there_are = self.getAvailableDifficulties()
            raise RuntimeError(f"the game has no difficulty {difficulty!r}: its difficulties are {there_are}")
        mode, _, max_frames = self._native.settings()
        self._native.configure(mode, difficulty, max_frames)

    def _setting(self, name: str) -> str | None:
        """A setting in ale-py's text form; ``None`` for an unknown name."""
        if name == "random_seed":
            return str(int(self._env._seeds()[1].astype(np.int32)))
        if name == "max_num_frames_per_episode":
            return str(self._native.settings()[2] or 0)
        if name == "repeat_action_probability":
            return f"{self._env.arguments[name]:g}"
        if name == "rom_file":
            return os.fspath(self._native.rom_file())
        return _SETTINGS.get(name)

    def getInt(self, name: str) -> int:
        """A setting as an integer, such as ``random_seed``; -1 for an unknown name."""
        setting = self._setting(name)
        try:
            return -1 if setting is None else int(setting)
        except ValueError:
            return int(self.getFloat(name))

    def getFloat(self, name: str) -> float:
        """A setting as a number, such as ``repeat_action_probability``; -1 for an unknown name."""
        if name == "repeat_action_probability":
            return float(self._env.arguments[name])
        setting = self._setting(name)
        try:
            return -1.0 if setting is None else float(np.float32(setting))
        except ValueError:
            return 0.0

    def getBool(self, name: str) -> bool:
        """A setting as a flag; ``False`` for an unknown name."""
        return self._setting(name) in ("1", "true")

    def getString(self, name: str) -> str:
        """A setting as text; empty for an unknown name."""
        return self._setting(name) or ""

    def setInt(self, name: str, value: Any) -> None:
        """Raises ``gymnasium.error.Error``: settings are arguments of ``make``."""
        raise gymnasium.error.Error(
            f"{name} cannot be set to {value!r} here: the settings of a game are arguments, as in "
            f"rustgym.make({self._env.env_id!r}, repeat_action_probability=0.0)"
        )

    setFloat = setBool = setString = setInt

    def setLoggerMode(self, mode: Any) -> None:
        """Does nothing: this emulator writes no messages."""

    def loadROM(self, path: Any = None) -> None:
        """Raises ``gymnasium.error.Error``: the id determines the game."""
        raise gymnasium.error.Error(
            f"{path} cannot be loaded here: make another game by its id with rustgym.make, and give the folder of ROMs as rom_dir"
        )

    @staticmethod
    def isSupportedROM(path: str | bytes | os.PathLike[str]) -> str | None:
        """The name of the game of a ROM file; ``None`` for an unknown file. Raises ``RuntimeError`` if it cannot be read."""
        try:
            # opening a pipe would wait for a writer
            if not stat.S_ISREG(os.stat(path).st_mode):
                raise RuntimeError(f"the ROM {os.fsdecode(path)} is not a regular file")
            with open(path, "rb") as file:
                return _native.Ale.supported(file.read(_LONGEST_ROM + 1))
        except OSError as error:
            raise RuntimeError(f"the ROM {os.fsdecode(path)} cannot be read: {error.strerror}") from error

    def getAudioSize(self) -> int:
        """The number of audio samples per frame in ale-py."""
        return 512

    def saveScreenPNG(self, path: Any) -> None:
        """Writes the picture to a file, with each pixel twice as wide as high."""
        picture = np.repeat(self.getScreenRGB(), 2, axis=1)
        rows, columns, _ = picture.shape
        # each row starts with the number of its filter: 0, none
        lines = np.hstack([np.zeros((rows, 1), np.uint8), picture.reshape(rows, -1)]).tobytes()

        def chunk(name: bytes, data: bytes) -> bytes:
            return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

        header = struct.pack(">2I5B", columns, rows, 8, 2, 0, 0, 0)
        chunks = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
        Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunks)

    # -- states

    def cloneState(self, include_rng: bool = False) -> AleState:
        """The state of the game. It can be compared, pickled, and restored in a game of the same ROM."""
        return self._native.state(include_rng)

    def restoreState(self, state: AleState) -> None:
        """Continues from a state. As in ale-py, the action that may stick stays the last action taken.

        If ``cloneState`` was called without ``include_rng``, the random numbers continue instead of going back too.
        """
        self._native.set_state(state)

    def cloneSystemState(self) -> AleState:
        """The state with its random numbers."""
        return self.cloneState(include_rng=True)

    restoreSystemState = restoreState


class SettingError(gymnasium.error.Error, ValueError):
    """A setting of a game has an invalid value. The bases are ale-py's class, and this package's for arguments."""


class UnknownSettingError(SettingError, RuntimeError):
    """The game does not have the mode or difficulty. ale-py raises a ``RuntimeError``."""


class SettingTypeError(SettingError, TypeError):
    """A setting of a game is of a wrong type, or there is no such game. ale-py raises a ``TypeError``."""


class AtariEnv(ClassEnv):
    """A game of the Atari 2600, with the attributes of ale-py's ``AtariEnv``.

    Unlike ale-py's, it needs a ``reset`` before the first ``step``.

    Args:
        render_mode: As of ``rustgym.Env``.
        preprocessing: ``True`` or a dict of settings for what Gymnasium's ``AtariPreprocessing`` and ``FrameStackObservation``
            do, here in Rust; a step then has ``frame_skip`` frames, and ``frameskip`` is 1. The settings: ``noop_max`` (30),
            ``frame_skip`` (4), ``screen_size`` (84, or width and height), ``terminal_on_life_loss`` (``False``),
            ``clip_reward`` (``False``) to -1 and 1, ``frame_stack`` (4; 0 for one picture without an axis for them).
        kwargs: The arguments of ale-py's ``AtariEnv``, and ``rom_dir``.
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 30}

    _constants = frozenset({"_frameskip", "_game", "_obs_type"})
    _game_mode: int | None
    _game_difficulty: int | None

    def __init__(
        self, render_mode: str | None = None, preprocessing: bool | Mapping[str, Any] | None = None, **kwargs: Any
    ) -> None:
        if preprocessing:
            kwargs, self._wrappers = preprocessed(self._id, preprocessing, kwargs)
        try:
            super().__init__(render_mode, **kwargs)
        except ValueError as error:
            text = str(error)
            is_unknown = any(f"{name} is " in text for name in ("mode", "difficulty"))
            is_of_type = "unknown game" in text or any(f"`{name}`: invalid type" in text for name in _TYPED)
            kind = UnknownSettingError if is_unknown else SettingTypeError if is_of_type else SettingError
            raise kind(text) from None
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise SettingError(f"Render mode {render_mode} not supported ({', '.join(self.metadata['render_modes'])})")
        if preprocessing:
            self._given = {**kwargs, "preprocessing": preprocessing}
        skip = self.arguments["frameskip"]
        self.__dict__.update(
            _frameskip=skip if isinstance(skip, int) else tuple(skip),
            _game=self.arguments["game"],
            _obs_type=self.arguments["obs_type"],
            _game_mode=self.arguments["mode"],
            _game_difficulty=self.arguments["difficulty"],
        )

    @property
    def ale(self) -> Ale:
        """The game."""
        return Ale(self)

    @property
    def _action_set(self) -> list[Action]:
        if self.arguments["continuous"]:
            return list(Action)
        return self.ale.getLegalActionSet() if self.arguments["full_action_space"] else self.ale.getMinimalActionSet()

    def get_action_meanings(self) -> list[str]:
        """The names of the actions of the environment."""
        return [action.name for action in self._action_set]

    def map_action_idx(self, left_center_right: int, down_center_up: int, fire: bool) -> Action:
        """The action for the position of the stick (left -1, centre 0, right 1; down -1, centre 0, up 1) and the fire button."""
        vertical, horizontal = ("", "UP", "DOWN")[down_center_up], ("", "RIGHT", "LEFT")[left_center_right]
        return Action[vertical + horizontal + ("FIRE" if fire else "") or "NOOP"]

    def get_keys_to_action(self) -> dict[tuple[str, ...], int]:
        """The keys for each action, as ``gymnasium.utils.play`` takes them; ``AttributeError`` with ``continuous``."""
        if self.arguments["continuous"]:
            raise AttributeError("there are no keys for continuous actions: get_keys_to_action needs continuous=False")
        names = enumerate(self.get_action_meanings())
        return {tuple(key for word, key in _KEYS.items() if word in name) or ("e",): index for index, name in names}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """As ``Env.reset``. With a seed, the ROM is loaded again, and mode and difficulty are the arguments of ``make``."""
        if seed is not None:
            self._configure()
        observation, info = super().reset(seed=seed, options=options)
        if seed is None:
            info.pop("seeds", None)
        elif "seeds" in info:
            info["seeds"] = tuple(map(np.uint32, info["seeds"]))
        return observation, info

    def seed_game(self, seed: int | None = None) -> tuple[np.uint32, np.uint32]:
        """Seeds ``np_random`` and, from the next ``load_game`` on, the game. Returns both seeds."""
        if seed is None:
            seed = entropy()
        if not self._native.is_running():
            super().reset(seed=seed)
        self._np_random_seed = seed
        first, second = self._seeds()
        self._np_random, _ = seeding.np_random(int(first))
        return first, second

    def load_game(self) -> None:
        """Loads the ROM again, which starts an episode in the default mode; a reset returns to the arguments of ``make``."""
        if self._np_random_seed in (None, -1):
            self.seed_game()
        self._configure()
        self.ale._native.load(int(self._seeds()[1]))

    def _configure(self) -> None:
        self.ale._native.configure(self._game_mode, self._game_difficulty, self.arguments["max_num_frames_per_episode"])

    def _seeds(self) -> npt.NDArray[np.uint32]:
        """The seeds of ``np_random`` and of the game."""
        return np.random.SeedSequence(self._np_random_seed).generate_state(2).astype(np.uint32)

    def clone_state(self, include_rng: bool = False) -> AleState:
        """As ``Ale.cloneState``."""
        return self.ale.cloneState(include_rng)

    def restore_state(self, state: AleState) -> None:
        """As ``Ale.restoreState``."""
        self.ale.restoreState(state)
