"""Attributes that Gymnasium's environments keep for their pictures, which they draw by pygame. No step reads them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NoReturn

from rustgym._live import same

if TYPE_CHECKING:
    from rustgym.env import Env

__all__ = ["OF_PYGAME", "IsOpen", "OfPicture", "ReadOnlyList", "absent"]

# what to use instead of an object of pygame
OF_PYGAME = "it is an object of pygame in Gymnasium, and this environment draws without pygame: render() returns the picture"


def _was_rendered(env: Env) -> bool:
    """Whether Gymnasium's environment has drawn a picture."""
    return (env._has_drawn and env.render_mode != "ansi") or _has_window(env)


def _has_window(env: Env) -> bool:
    return env.render_mode == "human" and env._was_reset()


def _draws_itself(env: Env) -> bool:
    """Whether the environment is of a class of a user's that overrides ``render``."""
    owner = next(cls for cls in type(env).__mro__ if "render" in vars(cls))
    return not owner.__module__.startswith("rustgym.")


class OfPicture:
    """An attribute of Gymnasium's pictures. It has Gymnasium's value, and cannot be set.

    A class of a user's that overrides ``render`` draws by itself, and can set it.

    Args:
        value: The value, or a function from the environment to the value.
        until: Until when Gymnasium has this value, if it makes an object of pygame then: ``"render"`` is the first picture,
            ``"window"`` the first picture in a window, ``"reset"`` the first reset.
    """

    def __init__(self, value: Any = None, until: str | None = None) -> None:
        self._value = value
        over: dict[str | None, Callable[[Env], bool]] = {None: lambda env: False, "render": _was_rendered, "window": _has_window, "reset": lambda env: env._was_reset()}
        self._is_over = over[until]

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, env: Env | None, owner: type | None = None) -> Any:
        if env is None:
            return self
        if self.name in env.__dict__:
            return env.__dict__[self.name]
        if self._is_over(env):
            raise AttributeError(f"{env.env_id} has no {self.name}: {OF_PYGAME}")
        return self._value(env) if callable(self._value) else self._value

    def __set__(self, env: Env, value: Any) -> None:
        if not _draws_itself(env):
            current = self.__get__(env)
            if not same(value, current):
                raise AttributeError(
                    f"{self.name} of {env.env_id} is {current!r} and cannot be set: this environment draws without pygame, and "
                    "a class that overrides render() can set it"
                )
        env.__dict__[self.name] = value


class IsOpen(OfPicture):
    """Gymnasium's ``isopen``: whether no window or surface was closed.

    Args:
        until: When Gymnasium makes the window or surface, as of ``OfPicture``.
    """

    def __init__(self, until: str = "render") -> None:
        super().__init__(None, until)

    def __get__(self, env: Env | None, owner: type | None = None) -> Any:
        if env is None:
            return self
        own = env.__dict__.get(self.name)
        return not (env._was_closed and self._is_over(env)) if own is None else own


class ReadOnlyList(list[Any]):
    """A list that refuses changes, which no step would see."""

    def _refuse(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise TypeError("this list is read-only: no step would see the change")

    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refuse
    append = clear = extend = insert = pop = remove = reverse = sort = _refuse

    def __reduce__(self) -> Any:
        return (type(self), (list(self),))


def absent(names: str, hint: str = OF_PYGAME) -> dict[str, str]:
    """What to use instead of attributes that only Gymnasium's environments have, by their names."""
    return dict.fromkeys(names.split(), hint)
