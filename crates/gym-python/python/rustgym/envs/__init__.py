"""A class for each id, such as ``CartPole_v1`` and ``CartPole_v1_Vector``, and the registry of Gymnasium with ours.

The classes are made when they are asked for. Ids that Gymnasium's users know by a class have it as their base:
``CartPole_v1`` is a ``CartPoleEnv``.
"""

from __future__ import annotations

import contextlib
import json
from functools import partial
from importlib.util import find_spec
from typing import Any

import gymnasium

from rustgym import _modules, _native
from rustgym._class_env import ClassEnv
from rustgym._errors import InvalidArgument
from rustgym._specs import SPECS, class_name, metadata_from, task_of
from rustgym.env import Env
from rustgym.envs.atari import AtariEnv
from rustgym.envs.box2d import BipedalWalker, CarRacing, LunarLander
from rustgym.envs.classic_control import (
    AcrobotEnv,
    CartPoleEnv,
    Continuous_MountainCarEnv,
    MountainCarEnv,
    PendulumEnv,
)
from rustgym.envs.dm_control import ControlEnv
from rustgym.envs.minigrid import GridEnv, name_of_class
from rustgym.envs.mujoco import MODULES, MujocoEnv
from rustgym.envs.robotics import AdroitEnv, GoalEnv, KitchenEnv, RobotEnv, base_of, class_of_package
from rustgym.envs.toy_text import BlackjackEnv, CliffWalkingEnv, FrozenLakeEnv, TaxiEnv, generate_random_map
from rustgym.registration import registry
from rustgym.vector_env import VectorEnv

__all__ = [
    "AcrobotEnv",
    "AdroitEnv",
    "AtariEnv",
    "BipedalWalker",
    "BlackjackEnv",
    "CarRacing",
    "CartPoleEnv",
    "CliffWalkingEnv",
    "Continuous_MountainCarEnv",
    "ControlEnv",
    "FrozenLakeEnv",
    "GoalEnv",
    "KitchenEnv",
    "LunarLander",
    "MountainCarEnv",
    "MujocoEnv",
    "PendulumEnv",
    "RobotEnv",
    "TaxiEnv",
    "generate_random_map",
    "registry",
]

_BASES: dict[str, type[Env]] = {
    "Acrobot": AcrobotEnv,
    "BipedalWalker": BipedalWalker,
    "BipedalWalkerHardcore": BipedalWalker,
    "Blackjack": BlackjackEnv,
    "CarRacing": CarRacing,
    "CartPole": CartPoleEnv,
    "CliffWalking": CliffWalkingEnv,
    "CliffWalkingSlippery": CliffWalkingEnv,
    "FrozenLake": FrozenLakeEnv,
    "FrozenLake8x8": FrozenLakeEnv,
    "LunarLander": LunarLander,
    "LunarLanderContinuous": LunarLander,
    "MountainCar": MountainCarEnv,
    "MountainCarContinuous": Continuous_MountainCarEnv,
    "Pendulum": PendulumEnv,
    "Taxi": TaxiEnv,
    **dict.fromkeys(MODULES, MujocoEnv),
}

# by task: Gymnasium's render modes that the Rust side lacks
_MORE_MODES = {
    "CarRacing": ["state_pixels"],
}


_IDS = {class_name(env_id): env_id for env_id in SPECS}


def _documented(argument: dict[str, str], defaults: dict[str, Any]) -> str:
    """The line about ``argument`` for the docstring of a class."""
    name, unit = argument["name"], argument["unit"] and f" {argument['unit']}"
    return f"\n        {name}: {argument['meaning']} {argument['type']}; {defaults[name]!r}{unit} unless given."


def _env_class(name: str, env_id: str) -> type[Env]:
    spec = SPECS[env_id]
    of_crate: dict[str, type[Env]] = {"gym-atari": AtariEnv, "gym-control": ControlEnv, "gym-minigrid": GridEnv}
    if spec["crate"] == "gym-robotics":
        of_crate["gym-robotics"] = base_of(env_id)
    base = of_crate.get(spec["crate"]) or _BASES.get(task_of(env_id), ClassEnv)
    # a game cannot be described without its ROM, others not without an argument: the base class has the metadata
    metadata = dict(base.metadata)
    if base is not AtariEnv:
        with contextlib.suppress(InvalidArgument):
            metadata = metadata_from(json.loads(_native.describe(env_id)))
    metadata["render_modes"] = metadata["render_modes"] + _MORE_MODES.get(task_of(env_id), [])
    arguments = "".join(_documented(argument, spec["defaults"]) for argument in spec["arguments"])
    doc = f"{spec['description'] or env_id}\n\n    ``{env_id}`` without Gymnasium's wrappers, with the arguments:\n{arguments}"

    own = {"__doc__": doc, "__module__": __name__, "_id": env_id, "metadata": metadata, "_fps": metadata.get("render_fps")}
    made = type(name, (base,), own)
    # Gymnasium's name of the class, because environments print it
    if base in (AdroitEnv, GoalEnv, KitchenEnv, RobotEnv):
        made.__name__ = class_of_package(env_id)
    elif base is MujocoEnv:
        made.__name__ = f"{task_of(env_id)}Env"
    elif base is GridEnv:
        made.__name__ = name_of_class(env_id)
    elif base not in (ClassEnv, ControlEnv):
        made.__name__ = base.__name__
    return made


def _vector_class(name: str, env_id: str) -> type[VectorEnv]:
    def __init__(self: Any, num_envs: int = 1, **kwargs: Any) -> None:
        VectorEnv.__init__(self, env_id, num_envs, **kwargs)

    doc = f"A vector of ``{env_id}``; see ``rustgym.VectorEnv`` for its arguments."
    # skrl recognizes a vector by the direct bases of its class
    return type(name, (VectorEnv, gymnasium.vector.VectorEnv), {"__doc__": doc, "__module__": __name__, "__init__": __init__})


_lacking = _modules.forwarder(__name__)


def __getattr__(name: str) -> Any:
    made: Any
    if name in _IDS:
        made = _env_class(name, _IDS[name])
    elif name.endswith("_Vector") and (env_id := _IDS.get(name.removesuffix("_Vector"))):
        made = _vector_class(name, env_id)
    else:
        return _lacking(name)
    globals()[name] = made
    return made


def __dir__() -> list[str]:
    return sorted({*globals(), *_IDS, *(f"{name}_Vector" for name in _IDS)})


def stand_ins() -> dict[str, Any]:
    """Replacements for the classes and functions that programs import from ``gymnasium.envs``."""
    modules = {
        "classic_control.acrobot": AcrobotEnv,
        "classic_control.cartpole": CartPoleEnv,
        "classic_control.continuous_mountain_car": Continuous_MountainCarEnv,
        "classic_control.mountain_car": MountainCarEnv,
        "classic_control.pendulum": PendulumEnv,
        "box2d.bipedal_walker": BipedalWalker,
        "box2d.car_racing": CarRacing,
        "box2d.lunar_lander": LunarLander,
        "toy_text.blackjack": BlackjackEnv,
        "toy_text.cliffwalking": CliffWalkingEnv,
        "toy_text.frozen_lake": FrozenLakeEnv,
        "toy_text.taxi": TaxiEnv,
    }
    found: dict[str, Any] = {}
    for module, made in modules.items():
        family = module.partition(".")[0]
        found[f"gymnasium.envs.{family}:{made.__name__}"] = made
        found[f"gymnasium.envs.{module}:{made.__name__}"] = made
    found["gymnasium.envs.classic_control.cartpole:CartPoleVectorEnv"] = __getattr__("CartPole_v1_Vector")
    if find_spec("mujoco"):  # without it Gymnasium's module cannot be imported
        found["gymnasium.envs.mujoco.mujoco_env:MujocoEnv"] = MujocoEnv
    found["gymnasium.envs.toy_text.frozen_lake:generate_random_map"] = generate_random_map
    return found


def _same(made: Any) -> Any:
    return made


def _class(name: str) -> Any:
    return globals().get(name) or __getattr__(name)


def _replace() -> None:
    """Puts this package's classes into its copies of Gymnasium's modules."""
    for name, made in stand_ins().items():
        module, _, attribute = name.removeprefix("gymnasium.").partition(":")
        if module.count(".") > 1:  # the others, such as `envs.box2d`, are modules of this package
            _modules.replace(module, attribute, partial(_same, made))
    for task, module in MODULES.items():
        for version in (4, 5):
            made_of = f"{task}_v{version}"
            if made_of in _IDS:
                _modules.replace(f"envs.mujoco.{module}_v{version}", f"{task}Env", partial(_class, made_of))


_replace()
