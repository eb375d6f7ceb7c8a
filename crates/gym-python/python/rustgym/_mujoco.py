"""MuJoCo's objects for an environment: the package's model and data or, without the package, data of this package."""

from __future__ import annotations

import base64
import copy
import os
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import as_strided

__all__ = ["Mirror", "OwnData", "load", "model_path", "observation_structure", "renderer"]

#: The arrays of the state that the Rust engine has too: changes to them are written to it.
KNOWN = ("qpos", "qvel", "qacc_warmstart")
#: The arrays from which a call of the Rust engine starts.
_STATE = (*KNOWN, "ctrl", "act", "mocap_pos", "mocap_quat", "qfrc_applied", "xfrc_applied")

# the size in bytes from which an array of the model is not watched: no step depends on arrays this large
_LARGE = 1 << 16


@cache
def _library() -> Any:
    return import_module("mujoco")


def model_path(xml_file: str) -> str:
    """Gymnasium's file of a built-in model: the same numbers, with Gymnasium's names, lights and textures."""
    gymnasium = import_module("gymnasium")
    return os.path.join(os.path.dirname(str(gymnasium.__file__)), "envs", "mujoco", "assets", xml_file)


def load(xml_file: str, text: str | None, width: int, height: int) -> Any:
    """The ``MjModel`` of a task."""
    mujoco = _library()
    if text is None:
        model = mujoco.MjModel.from_xml_path(os.path.expanduser(xml_file))
    elif os.path.exists(path := model_path(xml_file)):
        model = mujoco.MjModel.from_xml_path(path)
    else:
        model = mujoco.MjModel.from_xml_string(text)
    model.vis.global_.offwidth = max(model.vis.global_.offwidth, width)
    model.vis.global_.offheight = max(model.vis.global_.offheight, height)
    return model


# by task: how many positions an argument can exclude from the observation
_CAN_EXCLUDE = {"Ant": 2, "HalfCheetah": 1, "Hopper": 1, "Humanoid": 2, "HumanoidStandup": 2, "Swimmer": 2, "Walker2d": 1}


def observation_structure(env_id: str, facts: dict[str, Any], arguments: dict[str, Any]) -> dict[str, int]:
    """The number of elements of each array in an observation of the task ``env_id``, whose model has these ``facts``."""
    task, _, version = env_id.partition("-v")
    if version != "5" or task in ("InvertedDoublePendulum", "Pusher", "Reacher"):
        raise AttributeError(f"{env_id} has no observation_structure")
    nq, nv, bodies = len(facts["init_qpos"]), facts["nv"], len(facts["bodies"]) - 1
    structure = {}
    excluded = 0
    if task in _CAN_EXCLUDE:
        excluded = _CAN_EXCLUDE[task] * arguments["exclude_current_positions_from_observation"]
        structure["skipped_qpos"] = excluded
    structure |= {"qpos": nq - excluded, "qvel": nv}
    sizes = {"cinert": bodies * 10, "cvel": bodies * 6, "qfrc_actuator": nv - 6, "cfrc_ext": bodies * 6}
    for name, size in sizes.items():
        if (included := arguments.get(f"include_{name}_in_observation")) is not None:
            structure[name] = size * included
    if task.startswith("Humanoid"):
        structure |= {"ten_length": 0, "ten_velocity": 0}
    return structure


def renderer(model: Any, data: Any, camera: Any, arguments: dict[str, Any]) -> Any:
    """Gymnasium's renderer, with a task's arguments."""
    get, options = arguments.get, arguments.get("visual_options")
    module = import_module("gymnasium.envs.mujoco.mujoco_rendering")
    return module.MujocoRenderer(
        model,
        data,
        camera,
        get("width") or 480,
        get("height") or 480,
        get("max_geom") or 1000,
        get("camera_id"),
        get("camera_name"),
        options and {int(key): value for key, value in dict(options).items()},
    )


class Mirror:
    """The package's model and data. They are updated after each call of the environment, and checked for changes before each.

    Args:
        model: The package's model.
        contact_forces: Whether a step ends with ``mj_rnePostConstraint``.
    """

    def __init__(self, model: Any, contact_forces: bool) -> None:
        self.model, self.data = model, _library().MjData(model)
        self.contact_forces = contact_forces
        #: Whether MuJoCo's package steps the environment.
        self.is_handed = False
        self._watch()

    def _watch(self) -> None:
        mujoco = _library()
        self._everything = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._state: npt.NDArray[np.float64] = np.empty(mujoco.mj_stateSize(self.model, self._everything))
        self._arrays = {name: getattr(self.data, name).reshape(-1) for name in _STATE}
        self._spans = _spans(self.model)
        self._opt = opt = self.model.opt
        names = [name for name in dir(opt) if not name.startswith("_")]
        self._spans += [array for name in names if isinstance(array := getattr(opt, name), np.ndarray)]
        self._options = attrgetter(*(name for name in names if isinstance(getattr(opt, name), int | float)))
        self._seen_state, self._seen_model = self._read_state(), self._read_model()

    def _read_state(self) -> bytes:
        _library().mj_getState(self.model, self.data, self._state, self._everything)
        return self._state.tobytes()

    def _known(self) -> dict[str, Any]:
        return {"time": self.data.time, **{name: np.array(self._arrays[name]) for name in KNOWN}}

    def _put(self, state: dict[str, Any]) -> None:
        """Sets parts of the state."""
        for name, value in state.items():
            if name == "time":
                self.data.time = value
            else:
                self._arrays[name][:] = value

    def _read_model(self) -> tuple[Any, ...]:
        return (self._options(self._opt), *[span.tobytes() for span in self._spans])

    def follow(self, native: Any, is_reset: bool) -> None:
        """Sets the data to Gymnasium's after a reset or step: the package repeats the last call of the Rust engine."""
        mujoco, model, data = _library(), self.model, self.data
        calls = native.mujoco_before()
        if is_reset:
            mujoco.mj_resetData(model, data)
        if calls is not None:
            stepped, start, now = calls
            self._put(start)
            if stepped:
                mujoco.mj_step(model, data)
                self._put(now)
                if self.contact_forces:
                    mujoco.mj_rnePostConstraint(model, data)
            else:
                mujoco.mj_forward(model, data)
        self._seen_state = self._read_state()

    def changes(self) -> tuple[dict[str, Any], str | None]:
        """The changes to the state that the Rust engine can take, and the name of an object with other changes."""
        if self._read_model() != self._seen_model:
            return {}, "model"
        if self._read_state() == self._seen_state:
            return {}, None
        seen = np.frombuffer(self._seen_state)
        written = self._state.copy()
        changed = {}
        # whether anything differs apart from the arrays that the Rust engine knows
        mujoco, data = _library(), self.data
        current = self._known()
        mujoco.mj_setState(self.model, data, seen, self._everything)
        before = self._known()
        for name, value in current.items():
            if not np.array_equal(value, before[name], equal_nan=True):
                changed[name] = value
        self._put(current)
        data.ctrl[:] = _part(self.model, written, mujoco.mjtState.mjSTATE_CTRL, self._everything)
        other = self._read_state() != written.tobytes()
        mujoco.mj_setState(self.model, data, written, self._everything)
        self._seen_state = written.tobytes()
        return changed, "data" if other else None

    def store(self) -> dict[str, Any]:
        """The model, the state, and the arrays that the last call computed, as base64 texts."""
        mujoco = _library()
        model = np.empty(mujoco.mj_sizeModel(self.model), np.uint8)
        mujoco.mj_saveModel(self.model, None, model)
        self._read_state()
        arrays = {name: _text(array) for name, array in self._computed().items()}
        return {"model": _text(model), "state": _text(self._state), "arrays": arrays}

    def restored(self, parts: Any) -> Mirror:
        """Another one from the result of ``store`` of one with a model of this model's sizes.

        Raises:
            ValueError: for anything else.
        """
        try:
            mirror = self._stored(parts, self.contact_forces)
        except Exception as error:
            raise ValueError("cannot restore this snapshot: what it has of MuJoCo's package is damaged") from error
        sizes = ("nq", "nv", "na", "nu", "nbody", "ngeom")
        if any(getattr(mirror.model, size) != getattr(self.model, size) for size in sizes):
            raise ValueError("cannot restore this snapshot: it was taken from an environment with another model")
        return mirror

    @classmethod
    def _stored(cls, parts: dict[str, Any], contact_forces: bool) -> Mirror:
        mujoco = _library()
        model = mujoco.MjModel.from_binary_path("model.mjb", {"model.mjb": base64.b64decode(parts["model"])})
        mirror = cls(model, contact_forces)
        state = np.frombuffer(base64.b64decode(parts["state"]))
        mujoco.mj_setState(model, mirror.data, state, mirror._everything)
        mujoco.mj_forward(model, mirror.data)
        computed = mirror._computed()
        for name, text in parts["arrays"].items():
            array = computed[name]
            array[...] = np.frombuffer(base64.b64decode(text), array.dtype).reshape(array.shape)
        mujoco.mj_setState(model, mirror.data, state, mirror._everything)
        mirror.is_handed = True
        return mirror

    def _computed(self) -> dict[str, npt.NDArray[Any]]:
        """The data's arrays whose sizes depend only on the model."""
        fresh = _library().MjData(self.model)
        names = (name for name in dir(fresh) if not name.startswith(("_", "efc_", "iefc_", "efm_")))
        arrays = {name: array for name in names if isinstance(array := getattr(fresh, name), np.ndarray) and array.dtype != object}
        here = {name: getattr(self.data, name) for name in arrays}
        return {name: array for name, array in here.items() if array.shape == arrays[name].shape and array.size}

    def copy(self) -> Mirror:
        """An independent copy."""
        twin: Mirror = object.__new__(Mirror)
        twin.__setstate__({**self.__getstate__(), "model": copy.copy(self.model), "data": copy.copy(self.data)})
        return twin

    def __getstate__(self) -> dict[str, Any]:
        return {"model": self.model, "data": self.data, "contact_forces": self.contact_forces, "is_handed": self.is_handed}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._watch()


def _text(array: npt.NDArray[Any]) -> str:
    return base64.b64encode(array.tobytes()).decode()


def _part(model: Any, state: npt.NDArray[np.float64], part: Any, everything: int) -> npt.NDArray[np.float64]:
    """A part of a state. The parts before it have lower bits in ``mjtState``."""
    mujoco = _library()
    start = mujoco.mj_stateSize(model, everything & (int(part) - 1))
    return state[start : start + mujoco.mj_stateSize(model, int(part))]


def _spans(model: Any) -> list[npt.NDArray[np.uint8]]:
    """The memory of the model's arrays; adjacent arrays are merged."""
    arrays = []
    for name in dir(model):
        if not name.startswith("_") and isinstance(array := getattr(model, name), np.ndarray) and 0 < array.nbytes < _LARGE:
            arrays.append(array)
    arrays.sort(key=lambda array: array.ctypes.data)
    spans: list[tuple[Any, int, int]] = []
    for array in arrays:
        start, end = array.ctypes.data, array.ctypes.data + array.nbytes
        if spans and 0 <= start - spans[-1][2] <= 64:  # the gap is only padding for alignment
            spans[-1] = (spans[-1][0], spans[-1][1], max(end, spans[-1][2]))
        else:
            spans.append((array, start, end))
    return [as_strided(first.reshape(-1).view(np.uint8), (end - start,), (1,)) for first, start, end in spans]


class OwnData:
    """The state of a task under the names of ``mjData``, without MuJoCo's package.

    ``qpos``, ``qvel``, ``qacc_warmstart`` and ``time`` can be written, in place or as a whole: the next step starts from
    them. All other arrays are read-only. Each call of the environment updates the arrays.
    """

    def __init__(self, arrays: Mapping[str, Any]) -> None:
        self.__dict__.update({name: np.array(value) if np.ndim(value) else value for name, value in arrays.items()})
        self.follow(arrays)

    def follow(self, arrays: Mapping[str, Any]) -> None:
        """Copies the environment's arrays."""
        for name, value in arrays.items():
            array = self.__dict__[name]
            if isinstance(array, np.ndarray):
                array.flags.writeable = True
                array[...] = value
                array.flags.writeable = name in KNOWN
            else:
                self.__dict__[name] = value
        self.__dict__["_seen"] = self._known()

    def _known(self) -> dict[str, Any]:
        return {"time": self.time, **{name: np.array(getattr(self, name)) for name in KNOWN}}

    def changes(self) -> dict[str, Any]:
        """The values that were written since the last update."""
        now, seen = self._known(), self._seen
        self.__dict__["_seen"] = now
        return {name: value for name, value in now.items() if not np.array_equal(value, seen[name], equal_nan=True)}

    def __getattr__(self, name: str) -> Any:
        arrays = ", ".join(array for array in self.__dict__ if array != "_seen")
        raise AttributeError(f"data has no {name!r}: without the package mujoco it has {arrays}")

    def __setattr__(self, name: str, value: Any) -> None:
        if name in KNOWN:
            self.__dict__[name][...] = value
        elif name == "time":
            self.__dict__[name] = float(value)
        else:
            raise AttributeError(f"{name} is read-only: without the package mujoco, {', '.join(KNOWN)} and time can be written")
