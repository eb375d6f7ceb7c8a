"""CartPole, MountainCar, Pendulum and Acrobot: Gymnasium's classes, with their ``state``."""

from __future__ import annotations

import json
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from rustgym._specs import spec_of
from rustgym.env import TunableEnv, entropy

__all__ = ["AcrobotEnv", "CartPoleEnv", "Continuous_MountainCarEnv", "MountainCarEnv", "PendulumEnv"]


class ClassicControlEnv(TunableEnv):
    """An environment whose state is a few numbers."""

    #: The names of the numbers, in Gymnasium's order.
    state_names: ClassVar[tuple[str, ...]]
    #: Further fields of a state that was set.
    _when_set: ClassVar[dict[str, Any]] = {}
    @property
    def state(self) -> npt.NDArray[np.float64] | None:
        """The state as ``float64``, by ``state_names``; ``None`` before the first reset. Setting it continues from there."""
        state = self._native.state()
        if state is None:
            return None
        numbers = json.loads(state)
        return np.array([numbers[name] for name in self.state_names])

    @state.setter
    def state(self, numbers: Any) -> None:
        numbers = np.asarray(numbers, np.float64)
        if numbers.shape != (len(self.state_names),):
            raise ValueError(f"the state of {self.env_id} is {self.state_names}, not an array of shape {numbers.shape}")
        if self._native.state() is None:
            self._native.reset(str(entropy()), None)
        whole, episode = self._take_apart()
        episode["state"].update(self._when_set, **dict(zip(self.state_names, numbers.tolist(), strict=True)))
        self._native.restore(json.dumps(whole), True)


class CartPoleEnv(ClassicControlEnv):
    """Balance a pole on a cart; ``state`` is position (m), velocity (m/s), angle (rad), angular velocity (rad/s)."""

    _id = "CartPole-v1"
    state_names = ("x", "x_dot", "theta", "theta_dot")
    _when_set = {"fallen": False, "fresh": True}  # anywhere, as a start may be

    masspole: float
    masscart: float
    length: float
    _names = {"kinematics_integrator": lambda name: name if name == "euler" else "semi-implicit euler"}

    def __init__(self, render_mode: str | None = None, **kwargs: Any) -> None:
        super().__init__(render_mode, **kwargs)
        derived = {"total_mass": self.masspole + self.masscart, "polemass_length": self.masspole * self.length}
        self.__dict__.update((name, value) for name, value in derived.items() if self.arguments[name] is None)


class MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill; ``state`` is position and velocity."""

    _id = "MountainCar-v0"
    state_names = ("position", "velocity")


class Continuous_MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill, with as much force as needed; ``state`` is position and velocity."""

    _id = "MountainCarContinuous-v0"
    state_names = ("position", "velocity")
    _when_set = {"fresh": True}  # as float64, like that of a reset


class PendulumEnv(ClassicControlEnv):
    """Swing a pendulum up and hold it there; ``state`` is angle (rad) and angular velocity (rad/s)."""

    _id = "Pendulum-v1"
    state_names = ("theta", "theta_dot")


class AcrobotEnv(ClassicControlEnv):
    """Swing the lower of two links above a line; ``state`` is both angles (rad) and both angular velocities (rad/s)."""

    _id = "Acrobot-v1"
    state_names = ("theta1", "theta2", "dtheta1", "dtheta2")
    _when_set = {"fresh": False}  # as float64, unlike that of a reset

    # in Gymnasium these belong to the class
    vars().update((name, value) for name, value in spec_of(_id)["defaults"].items())
    actions_num = 3
    _names = {"book_or_nips": lambda name: name if name == "nips" else "book"}
