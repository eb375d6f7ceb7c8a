"""Gymnasium's environments in Rust, behind Gymnasium's own interface: the same seed gives the same episode, faster.

Three ways to use it:

1. By name. ``import rustgym`` adds the namespace ``rustgym/`` to Gymnasium's registry::

       import gymnasium, rustgym
       env = gymnasium.make("rustgym/CartPole-v1")
       envs = gymnasium.make_vec("rustgym/CartPole-v1", num_envs=1024)

   Libraries that take an id understand ``"rustgym:rustgym/CartPole-v1"``, which imports by itself.

2. In Gymnasium's place. ``import rustgym as gym`` has everything that ``import gymnasium as gym`` has, with ``gym.make`` giving
   our environments where we have the id.

3. Under everything. ``rustgym.register(replace=True)`` puts them under Gymnasium's own ids, so that any library on top of
   ``gymnasium.make`` uses them.

``rustgym.Env`` and ``rustgym.VectorEnv`` are the classes, ``rustgym.ids()`` lists what there is, ``rustgym.sb3.VecEnv`` gives
vectors to Stable-Baselines3, ``rustgym.view`` shows a robot in a notebook.
"""

from __future__ import annotations

import os
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import gymnasium
from gymnasium import (  # the names that this package does not replace
    ActionWrapper,
    ObservationWrapper,
    RewardWrapper,
    Space,
    VectorizeMode,
    Wrapper,
    error,
    logger,
    register_envs,
    spaces,
    utils,
    vector,
    wrappers,
)

from rustgym import _modules, _native

_modules.install()

from rustgym import envs as envs
from rustgym._native import PanicError
from rustgym.env import Env
from rustgym.registration import ids, make, make_vec, pprint_registry, register, registry, spec
from rustgym.vector_env import VectorEnv
from rustgym._view import view

__version__ = _native.__version__

__all__ = [
    "CLASSES",
    "ActionWrapper",
    "Env",
    "ObservationWrapper",
    "PanicError",
    "RewardWrapper",
    "Space",
    "VectorEnv",
    "VectorizeMode",
    "Wrapper",
    "envs",
    "error",
    "ids",
    "logger",
    "make",
    "make_vec",
    "pprint_registry",
    "register",
    "register_envs",
    "registry",
    "spaces",
    "spec",
    "utils",
    "vector",
    "view",
    "wrappers",
]

# a forked child has only the forking thread: functions that need other threads raise an error instead of waiting for them
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_native.after_fork_in_child)

register()

#: Replacements for the classes and functions that programs import from ``gymnasium.envs``.
CLASSES: dict[str, Any] = envs.stand_ins()

for _name in ("make", "make_vec", "pprint_registry", "register", "registry", "spec"):
    _modules.replace("envs.registration", _name, partial(globals().__getitem__, _name))

_lacking = _modules.forwarder(__name__)


# modules that need another library, and the name of that library
_OPTIONAL = {"dm_env": "dm_env", "jax": "jax", "sb3": "stable-baselines3"}


def __getattr__(name: str) -> Any:
    if name in _OPTIONAL:
        try:
            return import_module(f"rustgym.{name}")
        except ModuleNotFoundError as error:
            raise AttributeError(f"rustgym.{name} needs {_OPTIONAL[name]}: {error}") from error
    return _lacking(name)


def __dir__() -> list[str]:
    optional = {name for name, library in _OPTIONAL.items() if find_spec(library.replace("-", "_"))}
    return sorted({*globals(), *dir(gymnasium), *optional})
