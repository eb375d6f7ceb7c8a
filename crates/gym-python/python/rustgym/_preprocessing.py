"""Atari preprocessing by wrappers in Rust."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rustgym._json import brief, to_json
from rustgym._specs import spec_of


def preprocessed(
    env_id: str, preprocessing: bool | Mapping[str, Any], kwargs: dict[str, Any]
) -> tuple[dict[str, Any], str]:
    """The arguments of a preprocessed environment, and its Rust wrappers as JSON.

    Raises:
        TypeError: for an environment that is not an Atari game, and for an unknown setting.
    """
    if spec_of(env_id)["crate"] != "gym-atari":
        raise TypeError(f"preprocessing needs an Atari game, and {env_id} is not one")
    if not isinstance(preprocessing, bool | Mapping):
        raise TypeError(f"preprocessing must be True or a dict of settings, not {brief(preprocessing)}")
    settings: dict[str, Any] = {"noop_max": 30, "frame_skip": 4, "screen_size": 84, "terminal_on_life_loss": False}
    settings |= {"clip_reward": False, "frame_stack": 4}
    for name, value in {} if isinstance(preprocessing, bool) else preprocessing.items():
        if name not in settings:
            raise TypeError(f"preprocessing has no {name!r}: its settings are {', '.join(settings)}")
        settings[name] = value
    clip, stack, size = settings.pop("clip_reward"), settings.pop("frame_stack"), settings["screen_size"]
    if not isinstance(clip, bool | np.bool_):
        raise TypeError(f"clip_reward is {brief(clip)}: it must be True or False")
    # in Rust the height comes first
    settings["screen_size"] = [size, size] if np.ndim(size) == 0 else list(size)[::-1]
    wrappers = [("AtariPreprocessing", settings)]
    if clip:
        wrappers.append(("ClipReward", {"min_reward": -1.0, "max_reward": 1.0}))
    if stack:
        wrappers.append(("FrameStackObservation", {"stack_size": stack}))
    listed = ", ".join(to_json({"name": name, "kwargs": arguments}) for name, arguments in wrappers)
    return {**kwargs, "frameskip": 1}, f"[{listed}]"
