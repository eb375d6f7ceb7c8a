"""The tasks of the DeepMind Control Suite, with the attributes of the MuJoCo tasks: ``data``, ``model``, ``set_state``, ``dt``.

What is not here is shimmy's and dm_control's, such as ``physics`` and ``_env``: looking at it opens the environment
(``rustgym._opened``).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import gymnasium

from rustgym._class_env import ClassEnv
from rustgym._opened import package_of
from rustgym._specs import spec_of
from rustgym.envs.mujoco import MujocoEnv

__all__ = ["ControlEnv"]

#: shimmy's arguments that dm_control takes.
_OF_PACKAGE = ("task_kwargs", "environment_kwargs", "render_kwargs")


class ControlEnv(MujocoEnv):
    """A task of the DeepMind Control Suite.

    ``data`` and ``model`` are those of the MuJoCo tasks. ``qpos``, ``qvel``, ``qacc_warmstart`` and ``time`` of ``data`` can be
    written: the next step starts from them, and as in dm_control the other arrays follow with it. Any other change of them is
    an error of the next call; ``physics`` of dm_control takes it.
    """

    # the package whose tasks they are
    _package = "dm_control"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        ClassEnv.__init__(self, *args, **{name: value for name, value in kwargs.items() if name not in _OF_PACKAGE})

    @classmethod
    def _is_opened(cls, kwargs: dict[str, Any]) -> bool:
        given = [name for name in _OF_PACKAGE if kwargs.get(name) is not None]
        if given and package_of(cls._id) is None:
            raise gymnasium.error.DependencyNotInstalled(f"{given[0]} needs dm_control: run `pip install dm-control shimmy`")
        return bool(given) or super(MujocoEnv, cls)._is_opened(kwargs)

    def _is_read_elsewhere(self, name: str, value: Any) -> bool:
        return super(MujocoEnv, self)._is_read_elsewhere(name, value)

    def _opens(self, name: str) -> bool:
        return super(MujocoEnv, self)._opens(name)

    @classmethod
    def _given_there(cls, kwargs: dict[str, Any]) -> dict[str, Any]:
        """shimmy's arguments; what only changes pictures becomes ``render_kwargs``."""
        given = super()._given_there(kwargs)
        defaults = spec_of(cls._id)["defaults"]
        look = {name: given.pop(name) for name in ("width", "height", "camera_id") if name in given}
        if look:
            given["render_kwargs"] = {**look, **(given.get("render_kwargs") or {})}
        for name in [name for name in given if name in defaults and given[name] == defaults[name]]:
            del given[name]
        if unknown := [name for name in given if name in defaults and name != "visualize_reward"]:
            raise gymnasium.error.Error(f"this needs dm_control, which has no {unknown[0]}: make it without")
        return given

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
            "and `time` of `data` can be written, and everything of `physics`"
        )
