"""CartPole, MountainCar, Pendulum and Acrobot: Gymnasium's classes, with their ``state``."""

from __future__ import annotations

import json
import operator
from collections.abc import Callable
from importlib import import_module
from typing import Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym._class_env import TunableEnv
from rustgym._json import to_json
from rustgym._generators import generator_from
from rustgym._live import Live
from rustgym._modules import forwarder
from rustgym._pictures import IsOpen, OfPicture, absent
from rustgym._specs import spec_of
from rustgym.env import Env, entropy

__all__ = ["AcrobotEnv", "CartPoleEnv", "Continuous_MountainCarEnv", "MountainCarEnv", "PendulumEnv"]

# a package, as in Gymnasium: `rustgym._modules` finds the modules below it
__path__: list[str] = []
__getattr__ = forwarder(__name__)


class ClassicControlEnv(TunableEnv):
    """An environment whose state is a few numbers."""

    #: The names of the numbers in ``state``, in Gymnasium's order.
    state_names: ClassVar[tuple[str, ...]]
    @classmethod
    def _fields(cls, numbers: npt.NDArray[np.floating[Any]]) -> dict[str, Any]:
        """Further fields of the stored state, given the numbers of a state that a user sets."""
        return {}

    @classmethod
    def _is_single(cls, state: dict[str, Any]) -> bool:
        """Whether Gymnasium stores the numbers of a state as ``float32``."""
        return False

    # whether Gymnasium has a state before the first reset, which is None
    _has_early_state: ClassVar[bool] = True

    screen, clock = OfPicture(until="render"), OfPicture(until="render")
    isopen = IsOpen()
    _absent = absent("surf")

    def _read_state(self) -> Any:
        """The numbers named by ``state_names``. It can be changed in place, and set.

        Before the first reset it is as in Gymnasium: ``None`` in CartPole and Acrobot, and absent in the other tasks.
        """
        state = self._native.state()
        if state is None:
            if self._has_early_state:
                return None
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        numbers = json.loads(state)
        dtype = np.float32 if self._is_single(numbers) else np.float64
        return np.array([numbers[name] for name in self.state_names], dtype)

    def _write_state(self, state: Any) -> None:
        if state is None:
            return  # the next step needs a reset
        numbers = np.asarray(state)
        if numbers.dtype != np.float32:
            numbers = numbers.astype(np.float64)
        if numbers.shape != (len(self.state_names),):
            raise ValueError(f"the state of {self.env_id} is {self.state_names}, not an array of shape {numbers.shape}")
        if self._native.state() is None:
            self._native.reset(str(entropy()), None)
        self._change(**self._fields(numbers), **dict(zip(self.state_names, numbers.tolist(), strict=True)))

    def _change(self, **fields: Any) -> None:
        """Changes fields of the state, and continues from it."""
        state = self._native.state()
        if state is None:
            raise AttributeError(f"{self.env_id} has no state before the first reset")
        self._native.set_state(to_json({**json.loads(state), **fields}))

    state = Live(_read_state, _write_state)

    def __copy__(self) -> Env:
        twin = super().__copy__()
        if isinstance(state := (self._handed or {}).get("state"), np.ndarray):  # its precision is that of the next step
            ClassicControlEnv.state._hand(twin, state.copy())
        return twin

    def _carrier(self, cause: str) -> Callable[[Any], None]:
        names = (*self.arguments, "state", "steps_beyond_terminated", "last_u")
        values = {name: getattr(self, name) for name in names if hasattr(self, name)}
        values["_np_random"] = generator_from(json.loads(self._native.generator() or "[]"))
        return lambda inner: inner.__dict__.update(values)

    # Gymnasium's class, for tasks whose step it computes in `float32` after a user sets a `float32` state
    _theirs: ClassVar[str | None] = None

    def _watched_step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        handed = self._handed or {}
        state = handed.get("state")
        if state is None and "state" in handed:
            raise gymnasium.error.ResetNeeded(f"the state of {self.env_id} is None: call reset first")
        if self._theirs is None or state is None or np.asarray(state).dtype != np.float32 or not self._native.is_running():
            return super()._watched_step(action)
        self._push("step")
        module, _, name = self._theirs.partition(":")
        try:
            result: tuple[Any, float, bool, bool, dict[str, Any]] = getattr(import_module(module), name).step(self, action)
        except AssertionError as error:
            raise gymnasium.error.InvalidAction(str(error)) from None
        return result


class CartPoleEnv(ClassicControlEnv):
    """Balance a pole on a cart; ``state`` is position (m), velocity (m/s), angle (rad), angular velocity (rad/s)."""

    _id = "CartPole-v1"
    _theirs = "gymnasium.envs.classic_control.cartpole:CartPoleEnv"
    state_names = ("x", "x_dot", "theta", "theta_dot")
    screen_width, screen_height = OfPicture(600), OfPicture(400)
    masspole: float
    masscart: float
    length: float
    _names = {"kinematics_integrator": lambda name: name if name == "euler" else "semi-implicit euler"}

    def __init__(self, render_mode: str | None = None, **kwargs: Any) -> None:
        super().__init__(render_mode, **kwargs)
        derived = {"total_mass": self.masspole + self.masscart, "polemass_length": self.masspole * self.length}
        self.__dict__.update((name, value) for name, value in derived.items() if self.arguments[name] is None)

    @classmethod
    def _fields(cls, numbers: npt.NDArray[np.floating[Any]]) -> dict[str, Any]:
        return {"fresh": True}  # the state may be anywhere, as at the start of an episode

    @property
    def steps_beyond_terminated(self) -> int | None:
        """``None`` until the episode ends; then the number of further steps that end beyond a threshold. It can be set."""
        state = json.loads(self._native.state() or "{}")
        return int(state["steps_beyond_terminated"]) if state.get("fallen") else None

    @steps_beyond_terminated.setter
    def steps_beyond_terminated(self, steps: int | None) -> None:
        if steps is not None or self._native.state() is not None:
            self._change(fallen=steps is not None, steps_beyond_terminated=0 if steps is None else operator.index(steps))

    @property
    def _sutton_barto_reward(self) -> bool:
        return bool(self.arguments["sutton_barto_reward"])

    @_sutton_barto_reward.setter
    def _sutton_barto_reward(self, is_on: bool) -> None:
        self.sutton_barto_reward = bool(is_on)


def _bounds(position: str, sign: float) -> Callable[[Any], npt.NDArray[np.float32]]:
    return lambda self: np.array([self.arguments[position], sign * self.arguments["max_speed"]], np.float32)


def _height(self: Any, xs: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The heights of the valley at some positions."""
    return np.sin(3 * xs) * 0.45 + 0.55


class MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill; ``state`` is position and velocity."""

    _id = "MountainCar-v0"
    min_position: float
    _theirs = "gymnasium.envs.classic_control.mountain_car:MountainCarEnv"
    state_names = ("position", "velocity")
    screen_width, screen_height = OfPicture(600), OfPicture(400)
    _has_early_state = False
    _beside = {"low": _bounds("min_position", -1.0), "high": _bounds("max_position", 1.0)}
    _height = _height

    @classmethod
    def _fields(cls, numbers: npt.NDArray[np.floating[Any]]) -> dict[str, Any]:
        return {"fresh": True}

    def _read_state(self) -> Any:
        state = super()._read_state()
        if json.loads(self._native.state() or "{}").get("fresh", True):
            return state
        position, velocity = state
        # Gymnasium's step returns a tuple, and stops the car at the wall with the integer 0
        return (position, 0 if velocity == 0.0 and position == self.min_position else velocity)

    state = Live(_read_state, ClassicControlEnv._write_state)

    def get_keys_to_action(self) -> dict[tuple[int, ...], int]:
        """The actions of the arrow keys, by the numbers of the keys that are down."""
        return {(): 1, (276,): 0, (275,): 2, (275, 276): 1}


class Continuous_MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill, with as much force as needed; ``state`` is position and velocity."""

    _id = "MountainCarContinuous-v0"
    state_names = ("position", "velocity")
    screen_width, screen_height = OfPicture(600), OfPicture(400)
    _has_early_state = False
    _height = _height
    _beside = {"low_state": _bounds("min_position", -1.0), "high_state": _bounds("max_position", 1.0)}

    @classmethod
    def _fields(cls, numbers: npt.NDArray[np.floating[Any]]) -> dict[str, Any]:
        return {"fresh": numbers.dtype == np.float64}

    @classmethod
    def _is_single(cls, state: dict[str, Any]) -> bool:
        return not state["fresh"]


class PendulumEnv(ClassicControlEnv):
    """Swing a pendulum up and hold it there; ``state`` is angle (rad) and angular velocity (rad/s)."""

    _id = "Pendulum-v1"
    _theirs = "gymnasium.envs.classic_control.pendulum:PendulumEnv"
    state_names = ("theta", "theta_dot")
    _has_early_state = False
    screen_dim = OfPicture(500)

    def _get_obs(self) -> npt.NDArray[np.float32]:
        theta, theta_dot = self.state
        return np.array([np.cos(theta), np.sin(theta), theta_dot], np.float32)

    def _read_torque(self) -> np.float32 | None:
        state = self._native.state()
        if state is None:
            raise AttributeError(f"{self.env_id} has no last_u before the first reset")
        torque = json.loads(state).get("last_torque")
        return None if torque is None else np.float32(torque)

    last_u = Live(
        _read_torque,
        lambda self, torque: self._change(last_torque=None if torque is None else float(np.float32(torque))),
        doc="The last torque, clipped, which pictures show; ``None`` after a reset. It can be set.",
    )


class AcrobotEnv(ClassicControlEnv):
    """Swing the lower of two links above a line; ``state`` is both angles (rad) and both angular velocities (rad/s)."""

    _id = "Acrobot-v1"
    state_names = ("theta1", "theta2", "dtheta1", "dtheta2")

    @classmethod
    def _fields(cls, numbers: npt.NDArray[np.floating[Any]]) -> dict[str, Any]:
        return {"fresh": numbers.dtype == np.float32}

    @classmethod
    def _is_single(cls, state: dict[str, Any]) -> bool:
        return bool(state["fresh"])

    # in Gymnasium these arguments are attributes of the class
    vars().update((name, value) for name, value in spec_of(_id)["defaults"].items())
    actions_num = 3
    SCREEN_DIM = OfPicture(500)
    action_arrow = domain_fig = None

    def _get_ob(self) -> npt.NDArray[np.float32]:
        theta1, theta2, dtheta1, dtheta2 = self.state
        return np.array([np.cos(theta1), np.sin(theta1), np.cos(theta2), np.sin(theta2), dtheta1, dtheta2], np.float32)

    def _terminal(self) -> bool:
        theta1, theta2 = self.state[:2]
        return bool(-np.cos(theta1) - np.cos(theta2 + theta1) > 1.0)

    def _set_torques(self, torques: Any) -> None:
        self._native.set_argument(to_json({"AVAIL_TORQUE": torques}))
        self.arguments["AVAIL_TORQUE"] = list(torques)

    AVAIL_TORQUE = Live(
        lambda self: list(self.arguments["AVAIL_TORQUE"]),
        _set_torques,
        outlives_reset=True,
        outlives_step=True,
        doc="The torques of the actions, in N m.",
    )
    _names = {"book_or_nips": lambda name: name if name == "nips" else "book"}
