"""Continues an environment as the package's own: as Gymnasium's, minigrid's or shimmy's environment of the same id.

An environment is opened when a user reads, changes or overrides what the Rust side does not have. The package's environment
repeats the episode, and then takes the place of the Rust one in the same Python object.
"""

from __future__ import annotations

import dis
import inspect
import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from functools import cache, cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import load_env_creator

from rustgym._generators import generator_from, random_state_from, words_of
from rustgym._specs import theirs

if TYPE_CHECKING:
    from rustgym.env import Env

__all__ = ["Package", "open_env", "opened_class", "package_of", "repeater", "same_values"]

#: Names that a class can define without being opened: they have an effect in this package, too.
_FREE = frozenset("step reset render close metadata spec np_random unwrapped".split())


class Package:
    """The package's environment of an id.

    Args:
        env_id: The id.
        make: The class, or a function that makes the environment.
        kwargs: The arguments with which the package registers the id.
    """

    def __init__(self, env_id: str, make: Callable[..., Any], kwargs: dict[str, Any]) -> None:
        self.env_id, self.make, self.kwargs = env_id, make, kwargs
        # shimmy's function has the arguments of `dm_control.suite.load` and of its class
        of_shimmy = "task_kwargs environment_kwargs visualize_reward render_mode render_kwargs".split()
        self.accepts = list(inspect.signature(make).parameters) if isinstance(make, type) else of_shimmy

    @cached_property
    def made(self) -> type:
        """The class of the environment."""
        if isinstance(self.make, type):
            return self.make
        made: type = import_module("shimmy.dm_control_compatibility").DmControlCompatibilityV0
        return made

    @cached_property
    def _methods(self) -> list[Any]:
        own = [cls for cls in self.made.__mro__ if not cls.__module__.startswith(("gymnasium.core", "gymnasium.utils", "typing", "builtins"))]
        return [value for cls in own for value in vars(cls).values()]

    @cached_property
    def names(self) -> frozenset[str]:
        """The names of the attributes that an environment has or can have."""
        inner = () if isinstance(self.make, type) else dir(import_module("dm_control.rl.control").Environment)
        written = (name for value in self._methods for name in _attributes(value, "STORE_ATTR"))
        return frozenset({*dir(self.made), *inner, *written})

    @cached_property
    def reads(self) -> frozenset[str]:
        """The names of attributes that methods of the class read."""
        return frozenset(name for value in self._methods for name in _attributes(value, "LOAD"))

    def is_called(self, name: str) -> bool:
        """Whether the package's environment calls or reads ``name``, which this package does not."""
        if name in ("step", "render"):
            return name == "step" and any("step" in _attributes(vars(cls)["reset"], "LOAD") for cls in self.made.__mro__ if "reset" in vars(cls))
        return not name.startswith("__") and name not in _FREE and name in dir(self.made)

    def split(self, given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
        """The arguments that the package's environment takes, and the others, which are attributes there."""
        takes_all = "kwargs" in self.accepts
        taken = {name: value for name, value in given.items() if takes_all or name in self.accepts}
        return taken, {name: value for name, value in given.items() if name not in taken}


def _attributes(value: Any, operation: str) -> Iterator[str]:
    """The names in the instructions of a function or property that begin with ``operation``."""
    if isinstance(value, property):
        functions = [value.fget, value.fset]
    else:
        functions = [getattr(value, "__func__", value)]
    codes = [function.__code__ for function in functions if hasattr(function, "__code__")]
    while codes:
        code = codes.pop()
        codes += [const for const in code.co_consts if inspect.iscode(const)]
        yield from (i.argval for i in dis.get_instructions(code) if i.opname.startswith(operation) and isinstance(i.argval, str))


@cache
def package_of(env_id: str) -> Package | None:
    """The package's environment of an id; ``None`` if the package is not installed, or has no such id."""
    if (spec := theirs(env_id)) is None:
        return None
    try:
        entry = spec.entry_point
        package = Package(env_id, load_env_creator(entry) if isinstance(entry, str) else entry, spec.kwargs)
        return package if package.made else None
    except (ImportError, gymnasium.error.DependencyNotInstalled):
        return None


class Opened:
    """What an opened environment has beside the methods of the package's."""

    _opened_package: Package

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        package, given = self._opened_package, type(self).__base__._given_there(kwargs)  # type: ignore[union-attr]
        defaults = {name: value for name, value in package.kwargs.items() if name not in given}
        if args and isinstance(package.make, type):  # arguments that are given by position have no default
            defaults = {name: value for name, value in defaults.items() if name not in package.accepts[: len(args)]}
        taken, others = package.split({**defaults, **given})
        self._given, self.env_id = dict(kwargs), package.env_id
        if isinstance(package.make, type):
            package.make.__init__(self, *args, **taken)
        else:
            self.__dict__.update(vars(package.make(*args, **taken)))
        for name, value in others.items():
            if name not in package.names:
                raise TypeError(f"{type(self).__name__}() got an unexpected keyword argument {name!r}")
            setattr(self, name, value)

    def get_state(self) -> str:
        """Raises an error: a state of the package's environment is no text."""
        raise gymnasium.error.Error(f"{self._opened_package.made.__name__} of another package runs here, whose state is no text: use copy.deepcopy")

    def _push_into_vector(self) -> None:
        raise gymnasium.error.Error(f"{type(self).__name__} was opened, and a vector steps no opened environment: gymnasium.vector.SyncVectorEnv does")

    def __copy__(self) -> Any:
        return deepcopy(self)

    def __reduce_ex__(self, protocol: Any) -> Any:
        if isinstance(self, gymnasium.utils.EzPickle):
            raise TypeError(f"{type(self).__name__} was opened, and its package cannot copy it within an episode: copy it before")
        return _revive, (type(self).__base__,), dict(self.__dict__)


def _revive(mine: type[Env]) -> Any:
    return object.__new__(opened_class(mine))


@cache
def opened_class(mine: type[Env]) -> type:
    """The class of opened environments of the class ``mine``: its users' methods, then the package's."""
    package = package_of(mine._id)  # type: ignore[attr-defined]
    assert package is not None, "it was looked up"
    own = {"_opened_package": package, "__module__": mine.__module__, "__qualname__": mine.__qualname__, "__doc__": mine.__doc__}
    return type(mine)(mine.__name__, (mine,), own)


def order(cls: type, base: list[type]) -> list[type]:
    """The method resolution order of an opened class whose bases have the order ``base``."""
    package: Package = vars(cls)["_opened_package"]
    theirs = package.made.__mro__
    users = [c for c in base if not c.__module__.startswith("rustgym.") and c not in theirs and c is not cls]
    ours = next(i for i, c in enumerate(base) if c.__module__.startswith("rustgym.") and c is not cls)
    early = [c for c in users if base.index(c) < ours]
    late = [c for c in users if c not in early]
    end = theirs.index(gymnasium.Env)
    return [cls, *early, Opened, *theirs[:end], *late, *theirs[end:]]


def same_values(a: Any, b: Any) -> bool:
    """Whether two observations are equal."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same_values(a[key], b[key]) for key in a)
    if isinstance(a, tuple | list) and isinstance(b, tuple | list):
        return len(a) == len(b) and all(map(same_values, a, b))
    return bool(np.array_equal(a, b))


def _reset(inner: Any, source: dict[str, Any], options: dict[str, Any] | None) -> Any:
    """Resets the package's environment as ours was."""
    ((kind, value),) = source.items()
    if kind == "Seed" and "shimmy" in type(inner).__module__ and int(value) >> 32:
        words = [int(value) >> shift & 0xFFFF_FFFF for shift in range(0, int(value).bit_length(), 32)]
        inner.np_random = np.random.RandomState(words)
    elif kind == "Seed":
        return inner.reset(seed=int(value), options=options)[0]
    elif kind == "Generator":
        inner._np_random = generator_from(value)
    else:
        inner.np_random = random_state_from(value)
    return inner.reset(options=options)[0]


def _without_score(observation: Any) -> Any:
    """An observation of CarRacing without its score, whose digits are our own."""
    observation = observation.copy()
    observation[87:92, :11] = 0
    return observation


def repeater(env: Env, cause: str) -> Callable[[Any], None]:
    """A function that lets the package's environment repeat the episode of ``env``.

    Raises:
        gymnasium.error.Error: if it cannot; and the function, if the package's environment comes to another state.
    """
    native, space, name = env._native, env.action_space, _named(env)
    has_score = env.env_id.startswith("CarRacing-")
    text = native.history()
    if text is None:
        raise gymnasium.error.Error(
            f"{cause} needs the environment of the package {name}, which repeats the episode from its start, and cannot "
            "after other changes or many thousands of steps: reset first"
        )
    history = json.loads(text)
    actions = np.array(history["actions"]).reshape(history["steps"], max(1, int(np.prod(space.shape or ()))))
    generators = dict(history["generators"])

    def repeat(inner: Any) -> None:
        mode, inner.render_mode = inner.render_mode, None
        observation = _reset(inner, history["source"], history["options"] or None)
        for i, numbers in enumerate(actions):
            if i in generators:
                inner._np_random = generator_from(generators[i])
            action = int(numbers[0]) if space.shape == () else numbers.astype(space.dtype).reshape(space.shape)
            observation = inner.step(action)[0]
        if len(actions) in generators:
            inner._np_random = generator_from(generators[len(actions)])
        inner.render_mode = mode
        words, drawn = native.generator(), getattr(inner, "_np_random", None)
        is_same = not (words and isinstance(drawn, np.random.Generator)) or words_of(drawn) == json.loads(words)
        shown = native.observation()
        if has_score:
            observation, shown = _without_score(observation), _without_score(shown)
        if not is_same or not same_values(observation, shown):
            raise gymnasium.error.Error(
                f"{cause} needs the environment of the package {name}, whose installed version plays another episode than "
                "this environment"
            )

    return repeat


def _named(env: Any) -> str:
    package = package_of(env.env_id)
    assert package is not None, "it was looked up"
    return package.made.__module__.partition(".")[0]


def open_env(env: Env, package: Package, cause: str) -> None:
    """Continues ``env`` as the package's environment, in the same state; ``cause`` is named in errors."""
    if env._is_of_vector:
        raise gymnasium.error.Error(
            f"{cause} needs the environment of the package {_named(env)}, and a vector of rustgym steps its own: "
            "gymnasium.vector.SyncVectorEnv steps any"
        )
    env._push()
    taken, _ = package.split({**package.kwargs, **env._given_there(env._given), "render_mode": env.render_mode})
    was_reset = env._was_reset()
    carry = env._carrier(cause) if was_reset else None
    mine, old, handed = type(env), dict(env.__dict__), dict(env._handed or {})
    kept = {name: value for name, value in old.items() if name not in env._own_names and name not in env.arguments}
    if getattr(kept.get("step"), "__self__", None) is env._native:
        del kept["step"]
    object.__setattr__(env, "__class__", opened_class(mine))
    env.__dict__.clear()
    try:
        # in place, because objects of the package refer to their environment
        if isinstance(package.make, type):
            package.make.__init__(env, **taken)
        else:
            env.__dict__.update(vars(package.make(**taken)))
        if carry is not None:
            carry(env)
    except BaseException:
        env.__dict__.clear()
        env.__dict__.update(old)
        object.__setattr__(env, "__class__", mine)
        raise
    if (generator := old.get("_generator")) is not None:  # users hold this object
        if was_reset:
            generator.bit_generator.state = env.__dict__["_np_random"].bit_generator.state
        env.__dict__["_np_random"] = generator
    env.__dict__.update({**kept, **handed})
    if (space := old["observation_space"]) != env.observation_space:
        env.__dict__["observation_space"] = space
