"""The environment: ``rustgym.Env``, a ``gymnasium.Env``."""

from __future__ import annotations

import json
import operator
from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING, Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import logger

from rustgym import _native as native
from rustgym._json import brief, state_json, to_json
from rustgym._live import Live, same
from rustgym._generators import generator_from, words_of
from rustgym._opened import opened_class, order, repeater
from rustgym._pictures import OF_PYGAME
from rustgym._spaces import space_from
from rustgym._specs import class_of, metadata_from, native_arguments, native_options, spec_of
from rustgym._window import Window

#: The render modes that the Rust side has.
_NATIVE_MODES = ("human", "rgb_array", "depth_array", "rgbd_tuple", "ansi")

__all__ = ["Env"]


class _Kind(type):
    """Makes ``Env("CartPole-v1")`` an instance of the id's class, and an instance of a class that overrides what this package
    does not call an opened one."""

    def mro(cls) -> list[type]:
        base = super().mro()
        return order(cls, base) if "_opened_package" in vars(cls) else base

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        if cls is not Env or not (args or "env_id" in kwargs):
            if "_opened_package" not in vars(cls) and cls._is_opened(kwargs):
                return opened_class(cls)(*args, **kwargs)
            return super().__call__(*args, **kwargs)
        env_id = kwargs.pop("env_id") if "env_id" in kwargs else args[0]
        spec_of(env_id)
        if len(args) > 1:
            raise TypeError("rustgym.Env takes an id; its other arguments have names")
        return class_of(env_id)(**kwargs)


class Env(gymnasium.Env[Any, Any], metaclass=_Kind):
    """An environment whose dynamics run in Rust, with Gymnasium's interface and Gymnasium's numbers.

    Usually made by ``gymnasium.make("rustgym/CartPole-v1")``, which adds Gymnasium's own wrappers. The class itself has none,
    not even a time limit:

        >>> import rustgym
        >>> env = rustgym.Env("FrozenLake-v1", map_name="8x8", render_mode="ansi")
        >>> observation, info = env.reset(seed=42)
        >>> observation, info
        (0, {'prob': 1})

    It is an instance of the class that stands for the id, such as ``rustgym.envs.FrozenLake_v1``, with what Gymnasium's users
    know of that: ``state`` in classic control, ``P`` in toy text, ``data`` in the MuJoCo tasks, ``ale`` in Atari.

    Args:
        env_id: An id of the Rust registry, without the namespace ``rustgym/``; ``rustgym.ids()`` lists them.
        render_mode: ``None``, or one of ``metadata["render_modes"]``. In the mode ``"human"`` each reset and step shows a picture
            in a window of its own; where none can be opened, in one of pygame, if that is installed.
        kwargs: The arguments of that environment, as Gymnasium names them.

    Raises:
        TypeError: for an argument that the environment does not have.
        ValueError: for an argument with a bad value.

    A class of your own may have this one as its base, as it would have ``gymnasium.Env``: without an id it has Gymnasium's methods.

    Every call gives new arrays and dicts: nothing returned changes later. Copies (``copy.copy``, ``copy.deepcopy``, ``pickle``)
    can be made at any step and continue as the original does. One environment may be used from several threads; their calls
    come one after the other.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    #: The arguments of an instance, defaults included.
    arguments: dict[str, Any]

    #: The id of the Rust registry.
    env_id: str

    # wrappers of the Rust side, as JSON
    _wrappers = "[]"

    # attributes that cannot be set
    _constants: frozenset[str] = frozenset()

    # what to use instead of attributes that only Gymnasium's environment has
    _absent: ClassVar[dict[str, str]] = {}

    # whether a picture was drawn, and whether the environment was closed
    _has_drawn = _was_closed = False

    # whether a step must do more than the native step: synchronize objects that users hold, or show a picture
    _is_watched = True
    _generator: np.random.Generator | None = None
    _window: Window | None = None

    # by attribute name: the objects that users have read from `Live` attributes, and copies of them from the last comparison
    _handed: dict[str, Any] | None = None
    _seen: dict[str, Any] = {}

    # frames per second with the default arguments
    _fps: int | None = None

    # whether a vector steps the environment
    _is_of_vector = False

    # None in a user's subclass made without an id: it defines its own `reset` and `step`
    _native: native.Env = None  # type: ignore[assignment]

    def __init__(self, env_id: str | None = None, *, render_mode: str | None = None, **kwargs: Any) -> None:
        if env_id is None:
            if type(self) is Env or kwargs:
                raise TypeError("rustgym.Env needs an id, such as \"CartPole-v1\": rustgym.ids() lists them")
            return
        spec = spec_of(env_id)
        defaults = spec["defaults"]
        for name in kwargs:
            if name not in defaults:
                takes = f"its arguments are {', '.join(defaults)}" if defaults else "it takes no arguments"
                raise TypeError(f"{env_id} got an unexpected keyword argument {name!r}: {takes}, and render_mode")
        self.env_id = env_id
        self.render_mode = render_mode
        self._given = kwargs
        self._native = self._make_native(native_arguments(env_id, kwargs))
        self._watch()
        self._take_spaces()
        self.arguments = {**defaults, **spec["kwargs"], **kwargs}
        for name, value in self.arguments.items():
            if not hasattr(type(self), name):
                self.__dict__[name] = value

    def _take_spaces(self) -> None:
        description = json.loads(self._native.describe())
        if not self.metadata["render_modes"]:
            self.metadata = metadata_from(description)
        self.__dict__["observation_space"] = space_from(description["observation_space"])
        self.__dict__["action_space"] = space_from(description["action_space"])
        if description["render_fps"] != self._fps:  # arguments can change the duration of a step
            self.metadata = {**self.metadata, "render_fps": description["render_fps"]}

    @staticmethod
    def _of(inner: native.Env, env_id: str, render_mode: str | None, kwargs: dict[str, Any]) -> Env:
        """The environment around a native one, which may have wrappers of the Rust side."""
        env: Env = class_of(env_id)(render_mode=render_mode, **json.loads(inner.arguments()))
        env._native, env._is_of_vector = inner, True
        env._watch()
        env._take_spaces()
        env._np_random_seed = -1
        return env

    def _make_native(self, kwargs: str) -> native.Env:
        mode = self.render_mode if self.render_mode in _NATIVE_MODES else None
        try:
            return native.Env(self.env_id, kwargs, mode, self._wrappers)
        except gymnasium.error.UnsupportedMode:
            # Gymnasium's environments accept any mode. `make` warns of an unknown one, and `render` raises an error
            return native.Env(self.env_id, kwargs, None, self._wrappers)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Starts an episode.

        Args:
            seed: A whole number, zero or greater, of any size, which settles the episode. Without one the generator goes on
                from the last episode; the first time the operating system seeds it.
            options: What the environment's documentation names, such as ``low`` and ``high``.

        Returns:
            The first observation, an element of ``observation_space``, and the info.

        Raises:
            gymnasium.error.Error: for a seed that is negative or not a whole number.
            TypeError: for options that are not a dict.
            ValueError: for an option with a bad value. Options that the environment does not have are ignored, as in Gymnasium.
        """
        if self._native is None:
            return super().reset(seed=seed, options=options)
        if self._is_watched:
            self._push("reset")
        if seed is not None:
            seed = checked_seed(seed)
        elif self._generator is None and self._np_random_seed is None:
            seed = entropy()
        arguments = None if seed is None else str(seed), native_options(self.env_id, options)
        try:
            result = self._native.reset(*arguments)
        except gymnasium.error.UnsupportedMode as error:
            self._open_window(str(error))
            result = self._native.reset(*arguments)
        if seed is not None:
            self.__dict__["_np_random_seed"] = seed
        if self._is_watched:
            self._follow(is_reset=True)
        return result

    def _open_window(self, reason: str) -> None:
        """Opens a window of pygame, because the Rust side cannot open one."""
        self._window = Window(self.env_id, self.metadata["render_fps"], reason)
        snapshot = self._native.snapshot()
        self._native = native.Env(self.env_id, self._native.arguments(), "rgb_array", self._wrappers)
        self._native.restore(snapshot, False)
        self._watch()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes a step.

        Args:
            action: An element of ``action_space``, as Python's or numpy's number, array or list. Numbers beyond the bounds of
                a ``Box`` are clipped or not, as Gymnasium's environment does.

        Returns:
            The next observation, the reward (a number of the type of Gymnasium's, such as ``float``), ``terminated`` and
            ``truncated`` as ``bool``, and the info.

        Raises:
            gymnasium.error.InvalidAction: for what is not an action; nothing has changed then.
            gymnasium.error.ResetNeeded: before the first ``reset``.
        """
        if self._is_watched:
            return self._watched_step(action)
        return self._native.step(action)

    def _watched_step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        result: tuple[Any, float, bool, bool, dict[str, Any]]
        if self._native is None:
            result = super().step(action)  # raises NotImplementedError
            return result
        self._push("step")
        result = self._native.step(action)
        self._follow()
        return result

    def _push(self, call: str = "") -> None:
        """Writes the objects that users hold to the environment; ``call`` is ``"reset"``, ``"step"`` or empty."""
        self._push_generator()
        for name in list(self._handed or ()):
            attribute: Live = getattr(type(self), name)
            attribute.push(self, self._handed[name], call)  # type: ignore[index]

    def _follow(self, is_reset: bool = False) -> None:
        """Updates the objects that users hold after a step or reset."""
        self._pull_generator()
        for name in list(self._handed or ()):
            attribute: Live = getattr(type(self), name)
            attribute.follow(self, is_reset)
        if self._window is not None:
            self._window.show(self._native.render())
        self._watch()

    def _push_into_vector(self) -> None:
        """Like ``_push``, for an environment that a vector steps: all changes must go into the native environment."""
        self._push()

    def _drop(self, name: str) -> None:
        """Forgets the object of the attribute ``name``: the next read makes a new one."""
        if self._handed:
            self._handed.pop(name, None)
            self._seen.pop(name, None)

    def _watch(self) -> None:
        """Finds out whether a step has objects to synchronize or a window to update, and sets `_is_watched`."""
        held = self._native is None or self._generator is not None or self._window is not None or self._handed
        self._set_watched(bool(held))

    def _set_watched(self, is_watched: bool) -> None:
        # if nothing is watched, `step` becomes the native method itself, which saves a call
        own = self.__dict__
        own["_is_watched"] = is_watched
        if "step" in own and not isinstance(getattr(own["step"], "__self__", None), native.Env):
            return  # a user has set `step`
        if is_watched or type(self).step is not Env.step:
            own.pop("step", None)
        else:
            own["step"] = self._native.step

    def render(self) -> Any:
        """The picture or text that the render mode asks for.

        Returns:
            For ``"rgb_array"`` a new ``uint8`` array of shape ``(height, width, 3)``, for ``"ansi"`` a ``str``, for
            ``"human"``, which shows each reset and step in a window by itself, ``None``. For ``"depth_array"`` a ``float32``
            array of shape ``(height, width)``, and for ``"rgbd_tuple"`` both arrays.
        """
        if self._native is None:
            return super().render()
        if self.render_mode is None:
            hint = f"{self.spec.id}" if self.spec is not None else self.env_id
            logger.warn(
                "You are calling render method without specifying any render mode. You can specify the render_mode at "
                f'initialization, e.g. gym.make("{hint}", render_mode="rgb_array")'
            )
            return None
        if self.render_mode.removesuffix("_list") not in self.metadata["render_modes"]:
            modes = ", ".join(self.metadata["render_modes"])
            raise gymnasium.error.UnsupportedMode(f"{self.env_id} cannot render as {self.render_mode}: its modes are {modes}")
        if self.render_mode.endswith("_list"):
            # Gymnasium's environments return None here, too
            logger.warn(
                f"{self.env_id} itself collects no frames for {self.render_mode}: gymnasium.make adds the wrapper that does"
            )
            return None
        if self._is_watched:
            self._push()
        if not self._has_drawn:
            self.__dict__["_has_drawn"] = True
        return None if self.render_mode == "human" else self._native.render()

    def close(self) -> None:
        """Closes the window, if there is one. The episode is as it was, and the generator; more than once is fine."""
        if self._native is not None:
            self._native.close()
        if self._window is not None:
            self._window.close()
        self.__dict__["_was_closed"] = True

    @property
    def observation_names(self) -> list[str]:
        """The names of the numbers in an observation, in the order of its space; empty if they have none.

            >>> import rustgym
            >>> rustgym.Env("CartPole-v1").observation_names
            ['cart position (m)', 'cart velocity (m/s)', 'pole angle (rad)', 'pole angular velocity (rad/s)']
        """
        return [] if self._native is None else self._native.names()[0]

    @property
    def action_names(self) -> list[str]:
        """The names of the numbers in an action, in the order of its space; empty if they have none."""
        return [] if self._native is None else self._native.names()[1]

    def get_state(self) -> str:
        """The whole state, generator included, as JSON text: for planners, and to store."""
        self._push()
        return self._native.snapshot()

    def set_state(self, state: str) -> None:
        """Continues from a text that ``get_state`` returned, of this environment or another with the same arguments.

        Raises:
            ValueError: for the state of something else; the environment is then as it was.
        """
        if not isinstance(state, str):
            raise TypeError(f"a state must be a text returned by get_state, not {brief(state)} of type {type(state).__name__}")
        self._native.restore(state, True)
        if self._np_random_seed is None and self._was_reset():
            self.__dict__["_np_random_seed"] = -1  # Gymnasium's number for a generator whose seed is unknown
        self._follow(is_reset=True)

    def _rebuild(self, changed: dict[str, Any]) -> None:
        """Replaces the native environment by one with the ``changed`` arguments, in the same state."""
        if self._is_of_vector:
            raise gymnasium.error.Error(f"{', '.join(changed)} of an environment of a vector cannot be set: give it to the vector")
        given = {**json.loads(self._native.arguments()), **changed}
        native = self._make_native(native_arguments(self.env_id, given))
        state = self._take_apart()[0]
        state["config"] = json.loads(native.snapshot())["config"]
        native.restore(state_json(state), self._native.is_running())
        self._native = native
        self._watch()

    def _go_on_from(self, whole: Any) -> None:
        """Continues from a snapshot of this environment of which a part was set."""
        state = state_json(whole)
        try:
            self._native.restore(state, self._native.is_running())
        except ValueError as error:
            wrong = "a number is too large, or does not fit the others"
            raise ValueError(f"{self.env_id} cannot go on from what was set: {wrong}") from error

    def _was_reset(self) -> bool:
        return self._native is not None and self._native.generator() is not None

    def _take_apart(self) -> tuple[Any, Any]:
        """The snapshot, and the part of it that stores the episode, which is ``None`` before the first reset."""
        whole = json.loads(self._native.snapshot())
        inner = whole
        while isinstance(inner, list):  # a wrapper of the Rust side stores `[inner snapshot, its own state]`
            inner = inner[0]
        return whole, inner["episode"]

    # -- the generator: Gymnasium and its wrappers draw from `np_random`, and also read it as `_np_random`

    @property
    def _np_random(self) -> np.random.Generator | None:
        has_one = self._native is not None and self._np_random_seed is not None and self._native.generator() is not None
        if self._generator is None and has_one:
            self._generator = np.random.Generator(np.random.PCG64(0))
            self._watch()
            self._pull_generator()
        return self._generator

    @_np_random.setter
    def _np_random(self, generator: np.random.Generator | None) -> None:
        if generator is None:
            self._generator = None
            self._watch()
            return
        bits = getattr(generator, "bit_generator", generator)
        if self._native is not None and not isinstance(bits, np.random.PCG64):
            kind = type(bits).__name__
            raise ValueError(
                f"np_random must be a generator on PCG64, not {kind}: np.random.default_rng(seed) makes one"
            )
        self._generator = generator
        self._watch()
        self._push_generator()

    def _pull_generator(self) -> None:
        """Copies the state of the native generator to the numpy generator, if a user has read one."""
        if self._generator is None or (state := self._native.generator()) is None:
            return
        self._generator.bit_generator.state = generator_from(json.loads(state)).bit_generator.state

    def _push_generator(self) -> None:
        """Copies the state of the numpy generator, if a user has read one, to the native generator."""
        if self._generator is None or self._native is None:
            return
        self._native.set_generator(json.dumps(words_of(self._generator)))

    def __repr__(self) -> str:
        if self._native is None:
            return super().__repr__()
        given = "".join(f", {name}={value!r}" for name, value in self._given.items())
        mode = f", render_mode={self.render_mode!r}" if self.render_mode else ""
        return f"rustgym.Env({self.env_id!r}{mode}{given})"

    def __str__(self) -> str:
        # Gymnasium's text for an environment without a spec names the class alone
        return super().__str__() if self._native is None or self.spec is not None else repr(self)

    # -- copies

    def __copy__(self) -> Env:
        if self._native is None:
            raise TypeError(f"{type(self).__name__} cannot be copied by copy.copy: use copy.deepcopy")
        twin = object.__new__(type(self))
        self._push()
        apart = {"_native": self._native.__copy__(), "_generator": None, "_window": None}
        twin.__dict__.update(self.__dict__, **apart, _handed=None)
        twin._take_lasting(self._lasting())
        twin._watch()
        return twin

    def _lasting(self) -> dict[str, Any]:
        """Copies of the objects that users hold and snapshots do not contain, such as a table."""
        handed = (self._handed or {}).items()
        return {name: deepcopy(value) for name, value in handed if getattr(type(self), name).outlives_reset is True}

    def _take_lasting(self, objects: dict[str, Any]) -> None:
        """Takes over the objects that ``_lasting`` of another environment returned."""
        for name, value in objects.items():
            attribute: Live = getattr(type(self), name)
            attribute.copy(self, value)

    def __getstate__(self) -> Any:
        if self._native is None:
            get_state = getattr(super(), "__getstate__", None)
            return self.__dict__ if get_state is None else get_state()
        self._push()
        state = {**self.__dict__, "_window": None}
        if isinstance(getattr(state.get("step"), "__self__", None), native.Env):
            del state["step"]
        if self._handed:  # the copy must write objects that snapshots do not contain: None counts as changed
            lasting = (name for name in self._seen if getattr(type(self), name).outlives_reset is True)
            state["_seen"] = {**self._seen, **dict.fromkeys(lasting)}
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        if self._native is not None:
            self._watch()

    if not TYPE_CHECKING:  # type checkers would accept misspelt names because of it

        def __getattr__(self, name: str) -> Any:
            if name == "env_id":  # it was deleted, and what follows reads it
                raise AttributeError(f"this {type(self).__name__} has lost its env_id: make it anew")
            found = next((vars(base)[name] for base in type(self).__mro__ if name in vars(base)), None)
            if hasattr(type(found), "__get__"):  # a property raised AttributeError: called again, it raises its own message
                return found.__get__(self, type(self))
            hint = self._absent.get(name)
            try:
                if hint != OF_PYGAME and self._opens(name):
                    return getattr(self, name)
            except gymnasium.error.Error as error:
                raise AttributeError(str(error)) from error
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}" + (f": {hint}" if hint else ""))

    def __setattr__(self, name: str, value: Any) -> None:
        if "arguments" not in self.__dict__:
            object.__setattr__(self, name, value)
        elif name in self._constants or name == "env_id":
            current = getattr(self, name, value)
            if same(value, current) or (np.ndim(value) == 0 and value == current):
                return
            if self._opens(name):
                setattr(self, name, value)
                return
            remedy = f": make another environment with {name}={brief(value)}" if name in self.arguments else ""
            raise AttributeError(f"{name} of {self.env_id} is {brief(current)} and cannot be set{remedy}")
        elif self._is_read_elsewhere(name, value):
            setattr(self, name, value)
        else:
            if name in self.arguments:
                logger.warn(
                    f"{name} is what this {type(self).__name__} was made with: setting it changes nothing but the attribute"
                )
            elif not self._knows(name):
                logger.warn(f"{type(self).__name__} has no {name}: setting it changes nothing but the attribute")
            object.__setattr__(self, name, value)

    def _knows(self, name: str) -> bool:
        """Whether an attribute can be set without a warning: users' subclasses have attributes of their own."""
        return name in self.__dict__ or hasattr(type(self), name) or type(self).__module__ != "rustgym.envs"

    # -- the package's environment

    @classmethod
    def _is_opened(cls, kwargs: dict[str, Any]) -> bool:
        """Whether a class of a user's, made with the arguments ``kwargs``, overrides what this package does not call."""
        return False

    def _is_read_elsewhere(self, name: str, value: Any) -> bool:
        """Whether only the package's environment reads the attribute ``name``. If so, opens this environment."""
        return False

    def _opens(self, name: str) -> bool:
        """Whether the package's environment has the attribute ``name``. If so, opens this environment."""
        return False

    # attributes that an opened environment does not have
    _own_names: ClassVar[frozenset[str]] = frozenset(
        "_native _generator _window _handed _seen _is_watched _has_drawn _was_closed observation_space render_mode".split()
    )

    @classmethod
    def _given_there(cls, kwargs: dict[str, Any]) -> dict[str, Any]:
        """The arguments for the package's environment that stand for the arguments ``kwargs``."""
        return kwargs

    def _carrier(self, cause: str) -> Callable[[Any], None]:
        """A function that brings the package's environment to the state of this one, which was reset."""
        return repeater(self, cause)


def checked_seed(seed: Any, name: str = "Seed") -> int:
    """``seed`` as Python's ``int``. A negative seed passes: the Rust side raises the error."""
    try:
        return operator.index(seed)
    except TypeError:
        message = f"{name} must be a whole number, zero or greater, not {brief(seed)} of type {type(seed).__name__}"
        raise gymnasium.error.Error(message) from None


def entropy() -> int:
    """A seed from the operating system, drawn by numpy."""
    seed = np.random.SeedSequence().entropy
    assert isinstance(seed, int)
    return seed
