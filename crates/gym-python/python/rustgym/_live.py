"""Attributes whose value is a mutable object: an array, a list, a table.

Gymnasium's environments compute with these objects, so a user can change them in place. The environments of this package
compute in Rust. They make the object when a user reads the attribute. From then on, each call of the environment first
compares the object with a copy, and writes changes to the Rust side.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rustgym.env import Env

__all__ = ["Live", "Own", "same"]


def same(a: Any, b: Any) -> bool:
    """Whether two values have the same type and are equal to the last bit."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        if type(a) is not type(b) or a.dtype != b.dtype or a.shape != b.shape:
            return False
        return a.dtype != object and bool(a.tobytes() == b.tobytes())
    return type(a) is type(b) and bool(a == b)


class Live:
    """An attribute that a user can change in place or replace. Changes are written to the environment before its next call.

    Args:
        read: Makes the object from the environment.
        write: Writes the object's value to the environment.
        follow: Changes the object as a step changes it in Gymnasium. Leave it out if Gymnasium's step makes a new object.
        outlives_reset: Whether Gymnasium's reset keeps the object; it may depend on the environment.
        outlives_step: Whether Gymnasium's step keeps the object, unchanged.
    """

    def __init__(
        self,
        read: Callable[[Any], Any],
        write: Callable[[Any, Any], None],
        *,
        follow: Callable[[Any, Any], None] | None = None,
        outlives_reset: bool | Callable[[Any], bool] = False,
        outlives_step: bool = False,
        doc: str | None = None,
    ) -> None:
        self.read, self.write, self._follow = read, write, follow
        self.outlives_reset, self.outlives_step = outlives_reset, outlives_step
        self.__doc__ = doc or read.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, env: Env | None, owner: type | None = None) -> Any:
        if env is None:
            return self
        handed: dict[str, Any] = env.__dict__.get("_handed") or {}
        if self.name in handed:
            return handed[self.name]
        value = self.read(env)
        if value is not None:
            self._hand(env, value)
        return value

    def __set__(self, env: Env, value: Any) -> None:
        self.write(env, value)  # raises an error for a bad value
        self._hand(env, value)

    def _hand(self, env: Env, value: Any) -> None:
        if env._handed is None:
            env._handed, env._seen = {}, {}
        env._handed[self.name], env._seen[self.name] = value, self._copy(value)
        env._watch()

    def copy(self, twin: Env, value: Any) -> None:
        """Gives a copy of the environment its own copy of the object, and marks it as changed."""
        self._hand(twin, value)
        twin._seen[self.name] = None

    def _copy(self, value: Any) -> Any:
        """The copy of the object to compare with later."""
        return deepcopy(value)

    def push(self, env: Env, value: Any, call: str) -> None:
        """Writes the object to the environment if it has changed; called before each call."""
        if not same(value, env._seen[self.name]):
            self.write(env, value)
            env._seen[self.name] = self._copy(value)

    def follow(self, env: Env, is_reset: bool) -> None:
        """Does to the object what Gymnasium's reset or step does."""
        outlives = self.outlives_reset if is_reset else self.outlives_step
        if outlives(env) if callable(outlives) else outlives:
            return
        if is_reset or self._follow is None:
            env._drop(self.name)
        else:
            value = (env._handed or {})[self.name]
            self._follow(env, value)
            env._seen[self.name] = self._copy(value)


class Own(Live):
    """An attribute whose object the environment reads in each call. Resets and steps keep the object."""

    def __init__(self, read: Callable[[Any], Any], *, doc: str | None = None) -> None:
        super().__init__(read, lambda env, value: None, outlives_reset=True, outlives_step=True, doc=doc)

    def _copy(self, value: Any) -> Any:
        return None

    def push(self, env: Env, value: Any, call: str) -> None:
        """Does nothing: there is no copy to compare with."""
