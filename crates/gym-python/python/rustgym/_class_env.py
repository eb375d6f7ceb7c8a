"""The bases of the classes of single ids."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import gymnasium

from rustgym._json import to_json
from rustgym._live import Live, same
from rustgym._opened import open_env, package_of, same_values
from rustgym._specs import spec_of
from rustgym.env import Env

__all__ = ["ClassEnv", "TunableEnv"]


class ClassEnv(Env):
    """The base of the classes of single ids."""

    _id: ClassVar[str]

    # functions that compute further attributes of Gymnasium's class, which no step reads
    _beside: ClassVar[dict[str, Callable[[Any], Any]]] = {}

    def __init__(self, render_mode: str | None = None, **kwargs: Any) -> None:
        super().__init__(self._id, render_mode=render_mode, **kwargs)
        self.__dict__.update((name, make(self)) for name, make in self._beside.items())

    # attributes that have an effect when they are set, beside those that `Live` objects and properties stand for
    _effective: ClassVar[frozenset[str]] = frozenset("spec step reset render close np_random metadata".split())

    @classmethod
    def _is_opened(cls, kwargs: dict[str, Any]) -> bool:
        mro = cls.__mro__
        if cls.__module__ == "rustgym.envs":
            return False
        users = mro[: next(i for i, c in enumerate(mro) if c.__module__.startswith("rustgym."))]
        own = {name for c in users for name in vars(c)} - cls._honoured()
        own -= {name for name in own if name.startswith("__")}
        if not own or (package := package_of(cls._id)) is None:
            return False
        return any(map(package.is_called, own))

    @classmethod
    def _given_there(cls, kwargs: dict[str, Any]) -> dict[str, Any]:
        of_id = spec_of(cls._id)["kwargs"]
        given = {name: list(value) if isinstance(value, tuple) else value for name, value in kwargs.items()}
        return {name: value for name, value in kwargs.items() if name not in of_id or not same(given[name], of_id[name])}

    @classmethod
    def _honoured(cls) -> frozenset[str]:
        """The attributes of classes that the Rust side takes over."""
        return frozenset()

    def _is_read_elsewhere(self, name: str, value: Any) -> bool:
        found = getattr(type(self), name, None)
        is_honoured = hasattr(type(found), "__set__") and not (isinstance(found, property) and found.fset is None)
        if name in self._effective or name.startswith("__") or is_honoured:
            return False
        if name.startswith("_") and (name in vars(Env) or name in vars(gymnasium.Env)):
            return False
        if name not in self.__dict__ and found is None and not self._package_has(name):
            return False
        if (package := package_of(self.env_id)) is None or not (name in package.reads or name in dir(package.made)):
            return False
        if name in self.__dict__ and same_values(self.__dict__[name], value):
            return False
        open_env(self, package, name)
        return True

    def _package_has(self, name: str) -> bool:
        package = package_of(self.env_id)
        return package is not None and name in package.names

    def _opens(self, name: str) -> bool:
        if name.startswith("__") or "arguments" not in self.__dict__ or self._native is None or not self._package_has(name):
            return False
        package = package_of(self.env_id)
        assert package is not None, "it has the attribute"
        open_env(self, package, name)
        return True


class TunableEnv(ClassEnv):
    """The base of the classes whose arguments are attributes that take effect when they are set, as Gymnasium's do."""

    @classmethod
    def _honoured(cls) -> frozenset[str]:
        return frozenset(spec_of(cls._id)["defaults"])

    #: Functions from an argument's value to one of two names. Gymnasium treats any unknown text as the second name.
    _names: ClassVar[dict[str, Callable[[Any], Any]]] = {}

    def __init__(self, render_mode: str | None = None, **kwargs: Any) -> None:
        defaults = spec_of(self._id)["defaults"]
        # arguments that a user's subclass sets
        own = {name: getattr(type(self), name, value) for name, value in defaults.items()}
        own.update((name, defaults[name]) for name, value in own.items() if isinstance(value, Live))
        changed = {name: value for name, value in own.items() if value != defaults[name]}
        read = {name: self._names[name](value) if name in self._names else value for name, value in changed.items()}
        super().__init__(render_mode, **{**read, **kwargs})
        self.arguments.update((name, value) for name, value in changed.items() if name not in kwargs)
        self.__dict__.update((name, self.arguments[name]) for name in defaults)

    def __setattr__(self, name: str, value: Any) -> None:
        is_tunable = name in self.__dict__.get("arguments", ()) and name not in self._constants
        if not is_tunable or isinstance(getattr(type(self), name, None), Live):
            super().__setattr__(name, value)
        else:
            self._native.set_argument(to_json({name: self._names.get(name, lambda value: value)(value)}))
            self.__dict__[name] = self.arguments[name] = value
