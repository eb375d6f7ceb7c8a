"""The Rust registry's data about each id, and conversion of arguments and options to JSON."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec, load_env_creator
from gymnasium.envs.registration import registry as gymnasium_registry

from rustgym import _native as native
from rustgym._json import brief, to_json

SPECS: dict[str, dict[str, Any]] = {spec["id"]: spec for spec in json.loads(native.specs())}

#: Defaults that are ``int`` in Gymnasium, by the name of an id without namespace and version.
_WHOLE = {
    "Ant": ("forward_reward_weight",),
    "HumanoidStandup": ("uph_cost_weight",),
    "MountainCar": ("goal_velocity",),
    "MountainCarContinuous": ("goal_velocity",),
    "Pendulum": ("max_speed",),
    "Pusher": ("reward_dist_weight",),
    "Reacher": ("reward_control_weight", "reward_dist_weight"),
}


def task_of(env_id: str) -> str:
    """The name of an id without namespace and version: ``CartPole`` for ``rapier/CartPole-v1``."""
    return re.sub(r"-v\d+$", "", env_id.rpartition("/")[2])


for _env_id, _spec in SPECS.items():
    for _name in _WHOLE.get(task_of(_env_id), ()):
        if isinstance(_default := _spec["defaults"].get(_name), float) and _default.is_integer():
            _spec["defaults"][_name] = int(_default)
    if "AVAIL_TORQUE" in _spec["defaults"]:
        _spec["defaults"]["AVAIL_TORQUE"] = [-1.0, 0.0, 1]


def spec_of(env_id: str) -> dict[str, Any]:
    """The Rust registry's data about an id."""
    if not isinstance(env_id, str):
        raise TypeError(f"an id is a text such as \"CartPole-v1\", not {brief(env_id)} of type {type(env_id).__name__}")
    try:
        return SPECS[env_id]
    except KeyError:
        native.describe(env_id)  # raises an error that suggests similar ids
        raise


#: The specs that this package has replaced in Gymnasium's registry.
REPLACED: dict[str, EnvSpec] = {}


# the packages whose import registers the ids of a crate
_REGISTERS = {"gym-atari": "ale_py", "gym-control": "shimmy", "gym-minigrid": "minigrid"}


def registered(env_id: str) -> EnvSpec | None:
    """The spec of an id that another package has registered."""
    spec = REPLACED.get(env_id) or gymnasium_registry.get(env_id)
    return None if spec is None or str(spec.entry_point).startswith("rustgym") else spec


def theirs(env_id: str) -> EnvSpec | None:
    """The spec of an id as its own package registers it; ``None`` without that package."""
    spec, module = registered(env_id), _REGISTERS.get(SPECS[env_id]["crate"])
    if SPECS[env_id]["crate"] == "gym-robotics":
        return None
    if spec is not None or module is None:
        return spec
    try:
        import_module(module)
    except ImportError:
        return None
    return registered(env_id)


def native_arguments(env_id: str, arguments: Mapping[str, Any]) -> str:
    """The arguments as JSON for the Rust side, with the folders of ROMs and of robots of this Python installation."""
    defaults = spec_of(env_id)["defaults"]
    if "rom_dir" in defaults and arguments.get("rom_dir") is None and not os.environ.get("ALE_ROMS_DIR"):
        package = find_spec("ale_py")
        folders = [os.path.join(place, "roms") for place in (package and package.submodule_search_locations) or ()]
        arguments = {**arguments, "rom_dir": next(filter(os.path.isdir, folders), None)}
    if "assets" in defaults and arguments.get("assets") is None and not os.environ.get("GYMNASIUM_ROBOTICS_ASSETS"):
        package = find_spec("gymnasium_robotics")
        folders = [os.path.join(place, "envs", "assets") for place in (package and package.submodule_search_locations) or ()]
        arguments = {**arguments, "assets": next(filter(os.path.isdir, folders), None)}
    if isinstance(arguments.get("desc"), Sequence):  # FrozenLake's map: rows, or lists of characters
        arguments = {**arguments, "desc": np.asarray(arguments["desc"], dtype="c")}
    if isinstance(xml_file := arguments.get("xml_file"), str):
        _find_model(xml_file)
    return to_json(arguments)


def _find_model(xml_file: str) -> None:
    """Raises Gymnasium's error if the model ``xml_file`` does not exist."""
    if xml_file.startswith((".", "/", "~")):
        if not os.path.exists(path := os.path.expanduser(xml_file)):
            raise OSError(f"File {path} does not exist")
    elif xml_file and not xml_file.startswith("<") and xml_file not in (names := native.mujoco_models()):
        raise OSError(
            f"there is no built-in model {xml_file!r}: the models are {', '.join(names)}; a file's path begins with `.`, `/` or `~`"
        )


def native_options(env_id: str, options: Any) -> str | None:
    """Reset options as JSON for the Rust side. Options that the environment does not have are left out, as in Gymnasium.

    Raises:
        TypeError: for options that are not a dict.
    """
    if options is None:
        return None
    if not isinstance(options, Mapping):
        raise TypeError(f"options must be a dict or None, not {brief(options)} of type {type(options).__name__}")
    known = spec_of(env_id)["reset_options"]
    return to_json({name: value for name, value in options.items() if name in known}) if options else None


def class_name(env_id: str) -> str:
    """The name of an id's class: ``CartPole_v1`` for ``CartPole-v1``."""
    return re.sub(r"\W", "_", env_id)


def entry_point(env_id: str) -> str:
    """The entry point of an id's class in Gymnasium's registry."""
    return f"rustgym.envs:{class_name(env_id)}"


def class_of(env_id: str) -> Any:
    """The class of an id, found by its entry point."""
    return load_env_creator(entry_point(env_id))


def metadata_from(description: dict[str, Any]) -> dict[str, Any]:
    """Gymnasium's metadata."""
    return {"render_modes": list(description["render_modes"]), "render_fps": description["render_fps"]}
