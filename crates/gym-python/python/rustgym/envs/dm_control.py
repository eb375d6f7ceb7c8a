"""The tasks of the DeepMind Control Suite, with the attributes of the MuJoCo tasks: ``data``, ``model``, ``set_state``, ``dt``."""

from __future__ import annotations

from functools import cache
from typing import Any

import gymnasium

from rustgym.env import ClassEnv
from rustgym.envs.mujoco import MujocoEnv

__all__ = ["ControlEnv"]


class ControlEnv(MujocoEnv):
    """A task of the DeepMind Control Suite.

    ``data`` and ``model`` are those of the MuJoCo tasks. ``qpos``, ``qvel``, ``qacc_warmstart`` and ``time`` of ``data`` can be
    written: the next step starts from them, and as in dm_control the other arrays follow with it. Any other change is an error
    of the next call, since no package but this one steps these tasks.
    """

    # the package whose tasks they are
    _package = "dm_control"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        ClassEnv.__init__(self, *args, **kwargs)

    @classmethod
    @cache
    def _theirs(cls) -> Any:
        raise AttributeError(f"Gymnasium has no class for the tasks of {cls._package}")

    @property
    def _has_contact_forces(self) -> bool:
        return False

    def _hand_over(self, cause: str, warn: bool = True) -> None:
        raise gymnasium.error.Error(
            f"{cause} was changed, which this environment cannot take over: of a {self._package} task, `qpos`, `qvel`, `qacc_warmstart` "
            "and `time` of `data` can be written"
        )
