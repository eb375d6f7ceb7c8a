"""CartPole, MountainCar, Pendulum and Acrobot: the classes that Gymnasium's users know, with their ``state``."""

from __future__ import annotations

import json
import math
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from rustgym.env import ClassEnv, entropy

__all__ = ["AcrobotEnv", "CartPoleEnv", "Continuous_MountainCarEnv", "MountainCarEnv", "PendulumEnv"]


class ClassicControlEnv(ClassEnv):
    """An environment whose state is a few numbers."""

    #: The names of the numbers, in Gymnasium's order.
    state_names: ClassVar[tuple[str, ...]]
    #: What else belongs to a state that was set.
    _when_set: ClassVar[dict[str, Any]] = {}

    @property
    def state(self) -> npt.NDArray[np.float64] | None:
        """The state as ``float64``, by ``state_names``; ``None`` before the first reset. Setting it goes on from there."""
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

    gravity = 9.8  # m/s^2
    masscart = 1.0  # kg
    masspole = 0.1  # kg
    total_mass = masspole + masscart
    length = 0.5  # m, half the pole's
    polemass_length = masspole * length
    force_mag = 10.0  # N
    tau = 0.02  # s between states
    kinematics_integrator = "euler"
    theta_threshold_radians = 12 * 2 * math.pi / 360
    x_threshold = 2.4  # m
    _constants = frozenset(name for name in vars() if name[0] != "_" and name != "state_names")


class MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill; ``state`` is position and velocity."""

    _id = "MountainCar-v0"
    state_names = ("position", "velocity")

    min_position = -1.2
    max_position = 0.6
    max_speed = 0.07
    goal_position = 0.5
    force = 0.001
    gravity = 0.0025
    _constants = frozenset(name for name in vars() if name[0] != "_" and name != "state_names")


class Continuous_MountainCarEnv(ClassicControlEnv):
    """Drive a weak car up a hill, with as much force as needed; ``state`` is position and velocity."""

    _id = "MountainCarContinuous-v0"
    state_names = ("position", "velocity")
    _when_set = {"fresh": True}  # as float64, like that of a reset

    min_action = -1.0
    max_action = 1.0
    min_position = -1.2
    max_position = 0.6
    max_speed = 0.07
    goal_position = 0.45
    power = 0.0015
    _constants = frozenset(name for name in vars() if name[0] != "_" and name != "state_names")


class PendulumEnv(ClassicControlEnv):
    """Swing a pendulum up and hold it there; ``state`` is angle (rad) and angular velocity (rad/s)."""

    _id = "Pendulum-v1"
    state_names = ("theta", "theta_dot")

    max_speed = 8
    max_torque = 2.0
    dt = 0.05  # s between states
    m = 1.0  # kg
    l = 1.0  # m  # noqa: E741 - Gymnasium's name
    _constants = frozenset(name for name in vars() if name[0] != "_" and name != "state_names")


class AcrobotEnv(ClassicControlEnv):
    """Swing the lower of two links above a line; ``state`` is both angles (rad) and both angular velocities (rad/s)."""

    _id = "Acrobot-v1"
    state_names = ("theta1", "theta2", "dtheta1", "dtheta2")
    _when_set = {"fresh": False}  # as float64, unlike that of a reset

    dt = 0.2  # s between states
    LINK_LENGTH_1 = 1.0  # m
    LINK_LENGTH_2 = 1.0
    LINK_MASS_1 = 1.0  # kg
    LINK_MASS_2 = 1.0
    LINK_COM_POS_1 = 0.5  # m
    LINK_COM_POS_2 = 0.5
    LINK_MOI = 1.0
    MAX_VEL_1 = 4 * math.pi  # rad/s
    MAX_VEL_2 = 9 * math.pi
    AVAIL_TORQUE = (-1.0, 0.0, 1.0)  # N m
    torque_noise_max = 0.0
    book_or_nips = "book"
    _constants = frozenset(name for name in vars() if name[0] != "_" and name != "state_names")
