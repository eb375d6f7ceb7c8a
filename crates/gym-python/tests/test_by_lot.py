"""Writes and overrides by lot, over the attributes and methods of the classes of Gymnasium, minigrid and the Control Suite.

Each has the same effect in our environment as in the package's, or is an error or a warning; never nothing without a word.
`python test_by_lot.py [SEED [NUMBER [WORD]]]` draws more of them, and prints those that are not equal.
"""

from __future__ import annotations

import importlib
import sys
import warnings
from collections import Counter
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np

import rustgym

OURS = {
    "toy text": ["Blackjack-v1", "FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"],
    "classic control": ["CartPole-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "Acrobot-v1"],
}
if find_spec("Box2D"):
    OURS["box2d"] = ["LunarLander-v3", "BipedalWalker-v3", "CarRacing-v3"]
if find_spec("mujoco"):
    OURS["mujoco"] = ["HalfCheetah-v5", "Hopper-v5", "InvertedPendulum-v5", "Reacher-v5", "Pusher-v5", "Ant-v5"]
if find_spec("minigrid"):
    OURS["minigrid"] = [
        "MiniGrid-Empty-8x8-v0",
        "MiniGrid-Empty-Random-6x6-v0",
        "MiniGrid-DoorKey-5x5-v0",
        "MiniGrid-FourRooms-v0",
        "MiniGrid-LavaGapS5-v0",
        "MiniGrid-SimpleCrossingS9N1-v0",
        "MiniGrid-Dynamic-Obstacles-6x6-v0",
        "MiniGrid-MemoryS7-v0",
        "MiniGrid-Fetch-5x5-N2-v0",
        "MiniGrid-KeyCorridorS3R1-v0",
        "MiniGrid-PutNear-6x6-N2-v0",
        "BabyAI-GoToLocal-v0",
        "BabyAI-UnlockPickup-v0",
    ]
if find_spec("dm_control") and find_spec("shimmy"):
    OURS["suite"] = ["dm_control/cartpole-swingup-v0", "dm_control/reacher-easy-v0", "dm_control/point_mass-easy-v0"]

for package in ("minigrid", "shimmy"):  # they register their ids
    if find_spec(package):
        importlib.import_module(package)

# what a package's environment does not compute with, or what ends the process
LEFT_OUT = {"close", "render", "metadata", "unwrapped", "spec", "class_name", "has_wrapper_attr", "get_wrapper_attr", "set_wrapper_attr"}


def make(module: Any, env_id: str, **kwargs: Any) -> Any:
    if module is rustgym and env_id.startswith(tuple(OURS.get("mujoco", ())) + ("dm_control",)):
        kwargs["mujoco"] = "3.12"
    if module is rustgym and env_id.startswith("CarRacing"):
        kwargs["score_font"] = True  # Gymnasium's font, which observations show
    return module.make(env_id, disable_env_checker=True, **kwargs).unwrapped


def changed(value: Any) -> Any:
    """A value of the same kind that differs."""
    if isinstance(value, bool | np.bool_):
        return not value
    if isinstance(value, int | np.integer):
        return type(value)(value + 1)
    if isinstance(value, float | np.floating):
        return type(value)(value * 1.25 + 0.125)
    if isinstance(value, np.ndarray) and value.dtype.kind in "iuf" and value.size:
        return (value * 2 + 1).astype(value.dtype)
    if isinstance(value, np.ndarray) and value.dtype.kind == "b":
        return ~value
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        return tuple(changed(part) for part in value)
    if isinstance(value, list) and value:
        return value[::-1] if len(value) > 1 else value * 2
    if isinstance(value, dict) and value:
        return {key: changed(part) for key, part in value.items()}
    if isinstance(value, str):
        return value + "x"
    return None


def alter(result: Any) -> Any:
    """What an overriding method returns in place of ``result``."""
    new = changed(result)
    return result if new is None else new


def in_place(value: Any) -> bool:
    """Changes an object in place, if it can be."""
    if isinstance(value, np.ndarray) and value.size and value.dtype.kind in "iufb":
        value[...] = changed(value)
    elif isinstance(value, list) and value:
        value.reverse()
    elif isinstance(value, dict) and value:
        key = sorted(value, key=str)[0]
        value[key] = changed(value[key])
    elif type(value).__name__ == "Grid":
        for x in range(value.width):
            value.set(x, value.height // 2, None)
    elif hasattr(value, "is_open"):
        value.is_open = not value.is_open
    else:
        return False
    return True


def is_mutable(value: Any) -> bool:
    """Whether ``in_place`` changes it."""
    if isinstance(value, np.ndarray):
        return bool(value.size) and value.dtype.kind in "iufb"
    return bool(value) and isinstance(value, list | dict) or type(value).__name__ == "Grid" or hasattr(value, "is_open")


def played(env: Any, seed: int = 3, skip_reset: bool = False) -> list[Any]:
    rng = np.random.default_rng(seed)
    space = env.action_space
    results = [] if skip_reset else [env.reset(seed=seed)]
    for i in range(12):
        if isinstance(space, gymnasium.spaces.Discrete):
            action: Any = int(rng.integers(int(space.n)))
        else:
            action = rng.uniform(-1, 1, space.shape).astype(space.dtype)
        result = env.step(action)
        results.append(result)
        if result[2] or result[3]:
            results.append(env.reset())
    return [*results, env.reset()]


def plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {str(key): plain(value[key]) for key in sorted(value, key=str)}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return float(value).hex()
    return value if isinstance(value, str | None) else "an object"


def overridden(module: Any, env_id: str, name: str) -> Any:
    base = type(make(module, env_id))
    given = dict(gymnasium.spec(env_id).kwargs) if not env_id.startswith("dm_control") else {}
    kind = vars(next(c for c in type(make(gymnasium, env_id)).__mro__ if name in vars(c)))[name]
    given = {key: value for key, value in given.items() if not isinstance(value, type)}

    def method(self: Any, *args: Any, **kwargs: Any) -> Any:
        return alter(getattr(super(Mine, self), name)(*args, **kwargs))

    def read(self: Any) -> Any:
        return alter(getattr(super(Mine, self), name))

    def static(*args: Any, **kwargs: Any) -> Any:
        return alter(kind.__func__(*args, **kwargs))

    if isinstance(kind, property):
        member: Any = property(read)
    elif isinstance(kind, staticmethod):
        member = staticmethod(static)
    elif callable(kind):
        member = method
    else:
        member = alter(kind)
    Mine = type("Mine", (base,), {name: member, "__module__": __name__})
    if module is rustgym and env_id in [*OURS.get("mujoco", ()), *OURS.get("suite", ())]:
        given["mujoco"] = "3.12"
    if module is rustgym and env_id.startswith("CarRacing"):
        given["score_font"] = True
    if module is gymnasium and env_id.startswith("dm_control"):
        return played(Mine(make(module, env_id)._env))
    return played(Mine(**given))


def replaced(module: Any, env_id: str, name: str) -> Any:
    env = make(module, env_id)
    env.reset(seed=2)
    old = getattr(env, name)
    setattr(env, name, lambda *args, **kwargs: alter(old(*args, **kwargs)))
    return played(env, skip_reset=True)


def written(module: Any, env_id: str, name: str) -> Any:
    env = make(module, env_id)
    env.reset(seed=2)
    env.step(env.action_space.sample() * 0)
    setattr(env, name, changed(getattr(env, name)))
    return [played(env, skip_reset=True), getattr(env, name)]


def written_early(module: Any, env_id: str, name: str) -> Any:
    env = make(module, env_id)
    setattr(env, name, changed(getattr(env, name)))
    return played(env)


def mutated(module: Any, env_id: str, name: str) -> Any:
    env = make(module, env_id)
    env.reset(seed=2)
    in_place(getattr(env, name))
    return played(env, skip_reset=True)


def read(module: Any, env_id: str, name: str) -> Any:
    env = make(module, env_id)
    env.reset(seed=2)
    value = getattr(env, name)
    return [value if not callable(value) else None, played(env, skip_reset=True)]


def of_task(module: Any, env_id: str, name: str) -> Any:
    """A method of the Control Suite's task."""
    env = make(module, env_id)
    env.reset(seed=2)
    task = env._env.task
    old = getattr(task, name)
    setattr(task, name, lambda *args, **kwargs: alter(old(*args, **kwargs)))
    return played(env, skip_reset=True)


def of_physics(module: Any, env_id: str, name: str) -> Any:
    """A named array of the Control Suite's physics."""
    env = make(module, env_id)
    env.reset(seed=2)
    array = getattr(env.unwrapped.physics.named.data if name in ("qpos", "qvel", "ctrl") else env.physics.named.model, name)
    array[...] = np.asarray(array) * 1.5 + 0.01
    return played(env, skip_reset=True)


def lots() -> list[tuple[Callable[..., Any], str, str]]:
    """All that can be drawn: what is done, the id, the name."""
    found: list[tuple[Callable[..., Any], str, str]] = []
    for family, ids in OURS.items():
        for env_id in ids:
            env = make(gymnasium, env_id)
            env.reset(seed=2)
            mine = [c for c in type(env).__mro__ if not c.__module__.startswith(("typing", "builtins", "gymnasium.core", "gymnasium.utils"))]
            members = {name for c in mine for name in vars(c) if not name.startswith("__")} - LEFT_OUT
            for name in sorted(members):
                found.append((overridden, env_id, name))
                if callable(getattr(type(env), name)) and name not in ("reset", "step"):
                    found.append((replaced, env_id, name))
            for name in sorted(vars(env).keys() - LEFT_OUT - {"viewer"}):
                if name.startswith(("_np_random", "_ezpickle")):
                    continue
                value = vars(env)[name]
                found.append((read, env_id, name))
                if changed(value) is not None:
                    found += [(written, env_id, name), (written_early, env_id, name)]
                if is_mutable(value):
                    found.append((mutated, env_id, name))
            if family == "suite":
                names = "get_reward get_observation initialize_episode before_step after_step get_termination action_spec".split()
                found += [(of_task, env_id, name) for name in names]
                found += [(of_physics, env_id, name) for name in ("qpos", "qvel", "ctrl", "dof_damping", "body_mass", "geom_friction")]
    return found


def outcome(module: Any, what: Callable[..., Any], env_id: str, name: str) -> tuple[Any, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = plain(what(module, env_id, name))
        except Exception as error:
            result = f"{type(error).__name__}: {error}"
    said = [str(warning.message) for warning in caught if "WARN" in str(warning.message) or "was changed" in str(warning.message)]
    return result, said


def verdict(what: Callable[..., Any], env_id: str, name: str) -> str:
    """``equal``, ``error``, ``warning``, or what differs without a word."""
    level, gymnasium.logger.min_level = gymnasium.logger.min_level, gymnasium.logger.WARN
    try:
        theirs, their_words = outcome(gymnasium, what, env_id, name)
        ours, our_words = outcome(rustgym, what, env_id, name)
    finally:
        gymnasium.logger.min_level = level
    if ours == theirs or isinstance(ours, str) and isinstance(theirs, str):
        return "equal"
    if isinstance(ours, str):
        return f"error {ours[:160]}"
    if len(our_words) > len(their_words):
        return f"warning {our_words[-1][:100]}"
    return f"SILENT theirs {str(theirs)[:150]} ours {str(ours)[:150]}"


def drawn(seed: int, number: int, word: str = "") -> list[tuple[Callable[..., Any], str, str]]:
    all_lots = [lot for lot in lots() if word in f"{lot[0].__name__} {lot[1]} {lot[2]}"]
    order = np.random.default_rng(seed).permutation(len(all_lots))[:number]
    return [all_lots[i] for i in order]


def test_changes_by_lot() -> None:
    verdicts = {lot: verdict(*lot) for lot in drawn(seed=1, number=60)}
    silent = {lot: text for lot, text in verdicts.items() if text.startswith("SILENT")}
    assert not silent
    assert sum(text == "equal" for text in verdicts.values()) >= 48


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:3]]
    seed, number, word = numbers[0] if numbers else 1, numbers[1] if numbers[1:] else 300, (sys.argv[3:] or [""])[0]
    counts: Counter[str] = Counter()
    for what, env_id, name in drawn(seed, number, word):
        text = verdict(what, env_id, name)
        counts[text.split()[0]] += 1
        if text != "equal":
            print(what.__name__, env_id, name, text, flush=True)
    print(dict(counts))
