"""The tasks of Gymnasium-Robotics: mazes, arms and hands, with goals and without."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from rustgym._class_env import ClassEnv
from rustgym.envs.dm_control import ControlEnv

__all__ = ["AdroitEnv", "GoalEnv", "KitchenEnv", "RobotEnv", "base_of", "class_of_package"]

_CLASSES = {
    "AdroitHandDoor": "AdroitHandDoorEnv",
    "AdroitHandHammer": "AdroitHandHammerEnv",
    "AdroitHandPen": "AdroitHandPenEnv",
    "AdroitHandRelocate": "AdroitHandRelocateEnv",
    "AntMaze": "AntMazeEnv",
    "FetchPickAndPlace": "MujocoFetchPickAndPlaceEnv",
    "FetchPush": "MujocoFetchPushEnv",
    "FetchReach": "MujocoFetchReachEnv",
    "FetchSlide": "MujocoFetchSlideEnv",
    "FrankaKitchen": "KitchenEnv",
    "HandManipulateBlock": "MujocoHandBlockEnv",
    "HandManipulateEgg": "MujocoHandEggEnv",
    "HandManipulatePen": "MujocoHandPenEnv",
    "HandReach": "MujocoHandReachEnv",
    "PointMaze": "PointMazeEnv",
}


def class_of_package(env_id: str) -> str:
    """The name of the package's class of an id."""
    name = next(name for task, name in _CLASSES.items() if env_id.startswith(task))
    return name.replace("Env", "TouchSensorsEnv") if "TouchSensors" in env_id else name


class AdroitEnv(ClassEnv):
    """A task of the Adroit hand, whose model is another in each episode: it is not shown."""


class KitchenEnv(ClassEnv):
    """The kitchen, on the model of the installed package, which is not shown."""

    def compute_reward(self, achieved_goal: Mapping[str, Any], desired_goal: Mapping[str, Any], info: Mapping[str, Any]) -> float:
        """The number of tasks whose positions are within 0.3 of the goal.

        Args:
            achieved_goal: Positions by task.
            desired_goal: Positions at the goal by task.
            info: The tasks that count, as ``tasks_to_complete``. (The package counts those that the environment has left.)
        """
        distances = [np.linalg.norm(achieved_goal[task] - desired_goal[task]) for task in info["tasks_to_complete"]]
        return float(sum(distance < 0.3 for distance in distances))


def _rows(goal: npt.ArrayLike) -> npt.NDArray[np.float64]:
    return np.asarray(goal, dtype=np.float64)


class _Goals:
    """The rewards of goals."""

    _native: Any

    def compute_reward(self, achieved_goal: npt.ArrayLike, desired_goal: npt.ArrayLike, info: Any) -> Any:
        """The reward of a step that achieved one goal while another was desired.

        Args:
            achieved_goal: A goal (its numbers), or a batch of them with further dimensions in front.
            desired_goal: A goal, or a batch of the same form.
            info: Not used.

        Returns:
            A ``float64`` for one pair of goals; for batches an array with the dimensions in front.

        Raises:
            ValueError: for goals of another size.
        """
        achieved, desired = np.broadcast_arrays(_rows(achieved_goal), _rows(desired_goal))
        shape = achieved.shape[:-1]
        rewards = self._native.compute_reward(achieved.reshape(-1), desired.reshape(-1), int(np.prod(shape)))
        return rewards.reshape(shape)[()]

    def compute_terminated(self, achieved_goal: npt.ArrayLike, desired_goal: npt.ArrayLike, info: Any) -> Any:
        """Whether such a step terminates the episode: a ``bool``, for batches an array of them."""
        return self._flags(achieved_goal, desired_goal, 0)

    def compute_truncated(self, achieved_goal: npt.ArrayLike, desired_goal: npt.ArrayLike, info: Any) -> Any:
        """Whether such a step truncates the episode, apart from the limit of time: a ``bool``, for batches an array of them."""
        return self._flags(achieved_goal, desired_goal, 1)

    def _flags(self, achieved_goal: npt.ArrayLike, desired_goal: npt.ArrayLike, which: int) -> Any:
        achieved, desired = np.broadcast_arrays(_rows(achieved_goal), _rows(desired_goal))
        if achieved.ndim <= 1:
            return self._native.compute_flags(achieved.reshape(-1), desired.reshape(-1))[which]
        pairs = zip(achieved.reshape(-1, achieved.shape[-1]), desired.reshape(-1, desired.shape[-1]), strict=True)
        flags = [self._native.compute_flags(one.copy(), other.copy())[which] for one, other in pairs]
        return np.array(flags, dtype=bool).reshape(achieved.shape[:-1])


class GoalEnv(_Goals, ControlEnv):
    """A maze: Gymnasium-Robotics' ``GoalEnv``.

    The observation is a dict of ``observation``, ``achieved_goal`` and ``desired_goal``. It has the attributes of the MuJoCo tasks:
    ``data``, ``model``, ``set_state``, ``dt``. ``qpos``, ``qvel``, ``qacc_warmstart`` and ``time`` of ``data`` can be written; any
    other change is an error of the next call.
    """

    _package = "Gymnasium-Robotics"

    @property
    def _has_contact_forces(self) -> bool:
        return True


class RobotEnv(_Goals, ClassEnv):
    """A task of the Fetch arm or of the Shadow hand, on models of the installed package: Gymnasium-Robotics' ``GoalEnv``.

    The observation is a dict of ``observation``, ``achieved_goal`` and ``desired_goal``. The model is not shown.
    """


def base_of(env_id: str) -> type[ClassEnv]:
    """The base of an id's class."""
    if env_id.startswith("Adroit"):
        return AdroitEnv
    if env_id.startswith("Franka"):
        return KitchenEnv
    return GoalEnv if "Maze" in env_id else RobotEnv
