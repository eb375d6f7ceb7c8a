"""Gymnasium's methods of MuJoCo tasks, called on environments of this package."""

from __future__ import annotations

from types import MethodType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rustgym.envs.mujoco import MujocoEnv

__all__ = ["Borrowed"]


class Borrowed:
    """A method or property of Gymnasium's task. It reads and writes the environment's ``model`` and ``data``.

    Args:
        writes: Whether it changes the state through MuJoCo's package. If so, that package steps the environment from then on.
    """

    def __init__(self, writes: bool = False) -> None:
        self.writes = writes
        self._found: dict[type[MujocoEnv], Any] = {}

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def replace(self, env: MujocoEnv, value: Any) -> None:
        """Replaces the method by a function of the user's."""
        if isinstance(getattr(env._theirs(), self.name, None), property):
            raise AttributeError(f"property {self.name!r} of {type(env).__name__!r} object has no setter")
        env._hand_over(self.name)
        env.__dict__[self.name] = value

    def __call__(self, env: MujocoEnv, *args: Any, **kwargs: Any) -> Any:
        return self.__get__(env, type(env))(*args, **kwargs)

    def __get__(self, env: MujocoEnv | None, owner: type[MujocoEnv]) -> Any:
        if env is None:
            return self
        if (function := self._found.get(owner)) is None:
            function = self._found[owner] = self._find(owner)
        if self.writes and not env._is_handed:
            env._hand_over(f"{self.name}()")
        return function.fget(env) if isinstance(function, property) else MethodType(function, env)

    def _find(self, owner: type[MujocoEnv]) -> Any:
        """Gymnasium's method or property for a class of this package."""
        for theirs in owner._theirs().__mro__:
            if self.name in vars(theirs):
                return vars(theirs)[self.name]
        raise AttributeError(f"{owner.__name__} has no attribute {self.name!r}")
