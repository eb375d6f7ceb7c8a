"""Arguments, options and parts of stored episodes at other values: what is refused, in which words, and what the others do.

After an intended change, read what differs, and store it with `GYM_UPDATE_KEPT=1 pytest test_others.py`.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import rustgym
from rustgym._json import brief
from rustgym._specs import SPECS

KEPT = Path(__file__).with_name("others")

FAMILIES = ("box2d", "classic", "control", "minigrid", "mujoco", "robotics", "toytext")
#: Arguments that environments of a family share: one of them shows what they do.
SHARED = (
    *("agent_pov", "agent_view_size", "camera_id", "camera_name", "default_camera_config", "dtype", "flat", "frame_skip"),
    *("height", "highlight", "keyframe", "max_geom", "max_steps", "mujoco", "pixels", "qpos", "qvel", "screen_size"),
    *("see_through_walls", "tile_size", "visual_options", "visualize_reward", "width"),
)
#: A missing file is told in the words of the operating system, and not every build has a second engine.
LEFT_OUT = ("xml_file", "physics")
#: Words that an argument takes, and some that it does not.
WORDS = {
    "book_or_nips": ["nips"],
    "dtype": ["float32", "int8"],
    "goal": ["escape", "fetch"],
    "kinematics_integrator": ["semi-implicit euler"],
    "map_name": ["4x4", "8x8"],
    "mujoco": ["3.12", "5.0"],
    "obj_type": ["key", "box", "door"],
    "obstacle_type": ["lava", "wall"],
    "reward_type": ["sparse", "dense"],
}
#: Values of an argument that is null unless it is given, by a word of its type.
OF_NULL: dict[str, list[Any]] = {
    "boolean": [True, False],
    "integer or": [0, 1, 5, -1],
    "number or": [0.5, 0.0, -1.0],
    "list of 2 integers": [[1, 2], [2, 1], [0, 0], [-1, 1], [1, 99]],
    "list of strings": [["SF", "FG"], ["SFG"], ["SX", "YG"], ["FF", "FG"], ["SF", "FF"], []],
    "list of numbers": [[0.25], []],
    "colour": ["green", "none"],
    "string": ["none"],
    "object": [{"none": 1}],
}


def kinds() -> dict[str, list[dict[str, Any]]]:
    """One environment of each kind with the same arguments, by family."""
    of_kinds: dict[Any, dict[str, Any]] = {}
    for env_id, spec in SPECS.items():
        family = spec["crate"].removeprefix("gym-")
        if family in FAMILIES and not env_id.startswith(("rapier/", "Fetch", "Hand", "Franka")):
            of_kinds[family, spec["description"], *(argument["name"] for argument in spec["arguments"])] = spec
    return {family: [spec for key, spec in of_kinds.items() if key[0] == family] for family in FAMILIES}


def others(usual: Any, name: str = "", kind: str = "") -> list[Any]:
    """Other values than the usual one, possible and impossible ones."""
    found = list(WORDS.get(name, []))
    if isinstance(usual, bool):
        found += [not usual]
    elif isinstance(usual, int):
        found += [usual - 1, usual + 1, 2 * usual, 0, -1]
    elif isinstance(usual, float):
        found += [usual / 2, 2 * usual + 0.125, -usual, 0.0]
    elif isinstance(usual, str):
        found += ["none"]
    elif isinstance(usual, list):
        for i in sorted({0, len(usual) - 1}) if usual else ():
            found += [[*usual[:i], other, *usual[i + 1 :]] for other in others(usual[i])]
        found += [usual[1:]]
    elif isinstance(usual, dict):
        found += [{**usual, key: other} for key in usual for other in others(usual[key])[:2]]
        found += [{key: usual[key] for key in usual if key != left_out} for left_out in usual] + [{"none": 1}]
    else:
        found += next((values for word, values in OF_NULL.items() if word in kind), [])
    return [value for value in [*found, [["none"]]] if type(value) is not type(usual) or value != usual]


class Digest:
    """A short digest of what is added."""

    def __init__(self) -> None:
        self.sha = hashlib.sha256()

    def add(self, value: Any) -> None:
        if isinstance(value, dict):
            for key in sorted(value):
                self.add([key, value[key]])
        elif isinstance(value, list | tuple):
            for part in value:
                self.add(part)
        elif isinstance(value, float | np.ndarray | np.generic):
            array = np.asarray(value)
            self.sha.update(f"{array.dtype} {array.shape}".encode() + array.tobytes())
        else:
            self.sha.update(f"{value} ".encode())

    def __str__(self) -> str:
        return self.sha.hexdigest()[:8]


def facts(space: Any) -> list[Any]:
    if isinstance(space, gymnasium.spaces.Dict):
        return [[key, facts(part)] for key, part in space.items()]
    if isinstance(space, gymnasium.spaces.Tuple):
        return [facts(part) for part in space]
    numbers = [getattr(space, fact, None) for fact in ("low", "high", "n", "nvec")]
    return [type(space).__name__, str(space.shape), str(space.dtype), *numbers]


def play(env: Any, digest: Digest, options: dict[str, Any] | None = None, set_later: dict[str, Any] | None = None) -> None:
    """Adds what an environment or a vector shows in a short episode."""
    digest.add([*facts(env.observation_space), *facts(env.action_space), *env.reset(seed=3, options=options)])
    for name, value in (set_later or {}).items():
        setattr(env, name, value)
    env.action_space.seed(1)
    for _ in range(6):
        result = env.step(env.action_space.sample())
        digest.add(result)
        if isinstance(env, rustgym.Env) and (result[2] or result[3]):
            digest.add(env.reset())
    if env.render_mode is not None:
        digest.add(env.render())
    env.close()


class Told:
    """Lines of digests, and refusals in words that none before has."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.words: set[str] = set()

    def add(self, name: str, values: list[Any], run: Callable[[Any, Digest], None]) -> tuple[str, list[float]]:
        """What came of the values of ``name`` in short, and the numbers that refusals name."""
        whole, taken, numbers = Digest(), 0, []
        for value in values:
            digest = Digest()
            shown = brief(value)
            try:
                run(value, digest)
            except Exception as error:
                text = f"{type(error).__name__}: {error}".replace("\n", " ")
                numbers += [float(number) for number in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]\w)", text)]
                whole.add([shown, text])
                words = text.partition(": ")[2].partition(": ")[2].replace(name, "")
                for given in (shown, f"{value:g}" if isinstance(value, float) else shown):
                    words = words.replace(given, "")
                if words not in self.words:
                    self.words.add(words)
                    self.lines.append(f"  {name} = {shown:.60}: {text}")
            else:
                taken += 1
                whole.add([shown, str(digest)])
        return f"{name} {taken} {whole}", numbers


def is_possible(env_id: str, name: str, value: Any) -> bool:
    try:
        rustgym.Env(env_id, **{name: value}).close()
    except Exception:
        return False
    return True


def ends(env_id: str, name: str, usual: Any, numbers: list[float]) -> str:
    """Which of the numbers that refusals name, and of those next to them, are possible."""
    if isinstance(usual, bool) or not isinstance(usual, int | float):
        return ""
    near = [np.nextafter(x, y).item() for x in numbers for y in (-np.inf, x, np.inf)] if isinstance(usual, float) else []
    whole = {int(x) + i for x in numbers for i in (-1, 0, 1) if x.is_integer()} if isinstance(usual, int) else set()
    tried = sorted({*near, *whole})
    good = [str(value) for value in tried if is_possible(env_id, name, value)]
    return f" ({' '.join(good)} of {len(tried)})" if tried else ""


def told(family: str) -> list[str]:
    told = Told()
    for at, spec in enumerate(kinds()[family]):
        env_id, parts = spec["id"], []
        told.lines.append(env_id)
        place = len(told.lines) - 1
        for argument in spec["arguments"]:
            name, usual = argument["name"], spec["defaults"][argument["name"]]
            if name in LEFT_OUT or (at and name in SHARED):
                continue
            drawn = name in SHARED or family not in ("control", "mujoco", "robotics")

            def made(value: Any, digest: Digest, name: str = name, drawn: bool = drawn) -> None:
                play(rustgym.Env(env_id, render_mode="rgb_array" if drawn else None, **{name: value}), digest)

            def later(value: Any, digest: Digest, name: str = name) -> None:
                play(rustgym.Env(env_id), digest, set_later={name: value})

            values = others(usual, name, argument["type"])
            part, numbers = told.add(name, values, made)
            parts.append(part + ends(env_id, name, usual, numbers))
            if family in ("box2d", "classic", "toytext"):
                parts.append("set " + told.add(name, values, later)[0])
        for option in spec["reset_options"]:
            values = [0.25, -0.5, 7.0, 1e30, True, None, "none", [1, 1], [1, 99], [0], {"none": 1}]

            def given(value: Any, digest: Digest, option: str = option) -> None:
                play(rustgym.Env(env_id), digest, {option: value})

            parts.append(told.add(option, values, given)[0])
        told.lines[place] = "; ".join([env_id, *parts])
    return told.lines


def compare(name: str, lines: list[str]) -> None:
    kept = KEPT / f"{name}.txt"
    if "GYM_UPDATE_KEPT" in os.environ:
        kept.parent.mkdir(exist_ok=True)
        kept.write_text("\n".join(lines) + "\n")
    for found, line in zip(lines, kept.read_text().splitlines(), strict=True):
        assert found == line


@pytest.mark.parametrize("family", FAMILIES)
def test_other_values_are_refused_or_played_as_kept(family: str) -> None:
    compare(family, told(family))


def places(part: Any, path: tuple[Any, ...], name: str, found: dict[str, list[tuple[Any, ...]]]) -> None:
    """Adds the paths to the parts of a stored episode, by their names."""
    if isinstance(part, dict):
        for key in part:
            places(part[key], (*path, key), f"{name} {key}", found)
    elif isinstance(part, list) and part:
        for i, item in enumerate(part):
            places(item, (*path, i), name, found)
    else:
        found.setdefault(name, []).append(path)


def stored(env_id: str) -> str:
    """How many parts a stored episode has, how many of those may be others, and a digest of how it then goes on."""
    env, digest, taken = rustgym.Env(env_id), Digest(), set()
    env.reset(seed=3)
    env.action_space.seed(1)
    for _ in range(8):
        result = env.step(env.action_space.sample())
        if result[2] or result[3]:
            env.reset()
    state = json.loads(env.get_state())
    found: dict[str, list[tuple[Any, ...]]] = {}
    places(state, (), "", found)
    for name, paths in found.items():
        for path in dict.fromkeys((paths[0], paths[-1])):
            holder = state
            for key in path[:-1]:
                holder = holder[key]
            usual = holder[path[-1]]
            for other in (99, -1, 1e30, None, True, False, []):
                holder[path[-1]] = other
                try:
                    env.set_state(json.dumps(state))
                except Exception as error:
                    digest.add([name, repr(other), type(error).__name__])
                else:
                    taken.add(name)
                    env.action_space.seed(2)
                    digest.add([name, repr(other)])
                    try:
                        digest.add(env.step(env.action_space.sample())[:4])
                    except Exception as error:
                        digest.add(f"{type(error).__name__}: {error}")
            holder[path[-1]] = usual
    return f"{env_id}: {len(found)} {len(taken)} {digest}"


@pytest.mark.parametrize("family", ["classic", "toytext"])
def test_stored_episodes_with_another_part_are_refused_or_go_on_as_kept(family: str) -> None:
    compare(f"{family}_stored", [stored(spec["id"]) for spec in kinds()[family]])


@pytest.mark.parametrize("family", FAMILIES)
def test_other_values_in_a_native_vector_are_those_of_single_environments(family: str) -> None:
    for at, spec in enumerate(kinds()[family]):
        if not spec["native_vector"]:
            continue
        for argument in spec["arguments"]:
            name, usual = argument["name"], spec["defaults"][argument["name"]]
            if name in LEFT_OUT or (at and name in SHARED):
                continue
            for value in others(usual, name, argument["type"])[:2]:
                results = []
                for kind in ("native", "sync"):
                    digest = Digest()
                    try:
                        play(rustgym.VectorEnv(spec["id"], 2, kind=kind, **{name: value}), digest)
                    except Exception as error:
                        results.append(f"{type(error).__name__}: {error}")
                    else:
                        results.append(str(digest))
                if "in a native vector: make a sync" not in results[0]:
                    assert results[0] == results[1], f"{spec['id']} with {name} of {value}"
