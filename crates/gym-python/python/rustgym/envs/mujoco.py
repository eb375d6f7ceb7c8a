"""The MuJoCo tasks, with Gymnasium's attributes: ``data``, ``model``, ``set_state``, ``dt``.

Nothing here needs MuJoCo. Where its Python package is installed, ``data`` and ``model`` are MuJoCo's own objects, for its
functions and viewers; they follow the environment, never the other way.
"""

from __future__ import annotations

import os
from functools import cache, cached_property
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from rustgym.env import ClassEnv, Env, entropy

__all__ = ["MujocoEnv"]

# the number of positions that the tasks can leave out of an observation
_CAN_EXCLUDE = {"Ant": 2, "HalfCheetah": 1, "Hopper": 1, "Humanoid": 2, "HumanoidStandup": 2, "Swimmer": 2, "Walker2d": 1}


@cache
def _installed() -> str | None:
    """The version of MuJoCo's Python package, with whose numbers Gymnasium plays."""
    try:
        return version("mujoco")
    except PackageNotFoundError:
        return None


def _is_of(installed: str, versions: list[str]) -> bool:
    return installed in versions or ".".join(installed.split(".")[:2]) in versions


@cache
def _tell_other(own: str, installed: str, name: str | None) -> None:
    """Logs, once, that Gymnasium has other numbers here."""
    hint = f'make it with mujoco="{name}" for these' if name else "whose numbers rustgym does not repeat"
    gymnasium.logger.warn(
        f"the environment has the numbers of MuJoCo {own}, and Gymnasium has those of the installed mujoco {installed}: {hint}"
    )


class MujocoEnv(ClassEnv):
    """A robot that moves by MuJoCo's equations."""

    # MuJoCo's own model and data, made on first use, and whether the data is from the last step
    _library: tuple[Any, Any] | None = None
    _is_current = False

    def __init__(self, render_mode: str | None = None, **kwargs: Any) -> None:
        super().__init__(render_mode, **kwargs)
        own, versions = self._made_of["mujoco"], self._made_of["versions"]
        if (installed := _installed()) is not None and not _is_of(installed, versions[own]):
            _tell_other(own, installed, next((name for name in versions if _is_of(installed, versions[name])), None))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """As ``Env.reset``."""
        self._is_current = False
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """As ``Env.step``; raises ``ValueError`` for an action of another shape, as Gymnasium's tasks do."""
        self._is_current = False
        try:
            return super().step(action)
        except gymnasium.error.InvalidAction:
            expected, found = self.action_space.shape, np.shape(action)
            if found == expected:
                raise
            raise ValueError(f"Action dimension mismatch. Expected {expected}, found {found}") from None

    def set_state(self, state: Any, qvel: npt.ArrayLike | None = None) -> None:
        """Continues from other positions and velocities, or from a text that ``get_state`` returned.

        Args:
            state: The positions (``nq`` numbers), or without ``qvel`` a whole state.
            qvel: The velocities (``nv`` numbers).

        Raises:
            ValueError: for what is no state of this environment, which is then as it was.
        """
        if qvel is None:
            super().set_state(state)
        else:
            qpos, qvel = np.array(state, np.float64).ravel(), np.array(qvel, np.float64).ravel()
            if not self._native.is_running():
                self._native.reset(str(entropy()), None)
            self._native.set_mujoco_state(qpos, qvel)
        self._is_current = False

    @property
    def data(self) -> Any:
        """The state and the arrays computed from it, under the names of ``mjData``: ``qpos``, ``qvel``, ``xpos``, ``cfrc_ext``, ...

        MuJoCo's own object where its package is installed, else a namespace of arrays. To change the state, call
        ``set_state``: what is written here is overwritten after the next step.
        """
        if not find_spec("mujoco"):
            return SimpleNamespace(**self._arrays())
        _, data = self._of_library()
        if not self._is_current:
            for name, array in self._arrays().items():
                setattr(data, name, array)
            self._is_current = True
        return data

    @property
    def model(self) -> Any:
        """MuJoCo's own object for the model, read-only: changes do not affect the environment.

        Raises:
            gymnasium.error.DependencyNotInstalled: without MuJoCo's Python package, which nothing else here needs.
        """
        return self._of_library()[0]

    def _of_library(self) -> tuple[Any, Any]:
        try:
            mujoco: Any = import_module("mujoco")
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled(
                "`model` needs the package mujoco: run `pip install mujoco`; `data`, `dt`, `init_qpos`, `state_vector()` and "
                "`get_body_com()` work without it"
            ) from error
        if self._library is None:
            text, path = self._made_of["xml"], os.path.expanduser(self._made_of["xml_file"])
            model = mujoco.MjModel.from_xml_string(text) if text else mujoco.MjModel.from_xml_path(path)
            self._library = model, mujoco.MjData(model)
        return self._library

    def _arrays(self) -> dict[str, Any]:
        arrays = self._native.mujoco_data()
        assert arrays is not None, "an id of these tasks"
        return arrays

    @cached_property
    def _made_of(self) -> dict[str, Any]:
        facts = self._native.mujoco_model()
        assert facts is not None, "an id of these tasks"
        return facts

    @property
    def frame_skip(self) -> int:
        """The number of the model's timesteps per step."""
        return int(self._made_of["frame_skip"])

    @property
    def dt(self) -> float:
        """Seconds from one step to the next: the timestep of ``model`` times ``frame_skip``."""
        timestep = self._made_of["timestep"] if self._library is None else self._library[0].opt.timestep
        return float(timestep * self.frame_skip)

    @property
    def init_qpos(self) -> npt.NDArray[np.float64]:
        """The positions that an episode's start is drawn around."""
        return np.array(self._made_of["qpos0"])

    @property
    def init_qvel(self) -> npt.NDArray[np.float64]:
        """The velocities that an episode's start is drawn around."""
        return np.zeros(self._made_of["nv"])

    @property
    def observation_structure(self) -> dict[str, int]:
        """The number of elements of each array in an observation, in this order, and the number of positions left out.

        Raises:
            AttributeError: for versions before 5 and tasks whose observation is made in another way, as in Gymnasium.
        """
        task, _, version = self.env_id.partition("-v")
        if version != "5" or task in ("InvertedDoublePendulum", "Pusher", "Reacher"):
            raise AttributeError(f"{self.env_id} has no observation_structure")
        nq, nv, bodies = len(self._made_of["qpos0"]), self._made_of["nv"], len(self._made_of["bodies"]) - 1
        structure = {}
        excluded = 0
        if task in _CAN_EXCLUDE:
            excluded = _CAN_EXCLUDE[task] * self.arguments["exclude_current_positions_from_observation"]
            structure["skipped_qpos"] = excluded
        structure |= {"qpos": nq - excluded, "qvel": nv}
        sizes = {"cinert": bodies * 10, "cvel": bodies * 6, "qfrc_actuator": nv - 6, "cfrc_ext": bodies * 6}
        for name, size in sizes.items():
            if (included := self.arguments.get(f"include_{name}_in_observation")) is not None:
                structure[name] = size * included
        if task.startswith("Humanoid"):
            structure |= {"ten_length": 0, "ten_velocity": 0}
        return structure

    def state_vector(self) -> npt.NDArray[np.float64]:
        """The positions, then the velocities."""
        arrays = self._arrays()
        return np.concatenate([arrays["qpos"], arrays["qvel"]])

    def get_body_com(self, body_name: str) -> npt.NDArray[np.float64]:
        """The position of a body's frame, in metres; after a step as of the engine's last forward call, as in MuJoCo.

        Raises:
            KeyError: for a name that no body of the model has.
        """
        bodies = self._made_of["bodies"]
        if body_name not in bodies:
            names = ", ".join(repr(name) for name in bodies)
            raise KeyError(f"the model has no body {body_name!r}: its bodies are {names}")
        position: npt.NDArray[np.float64] = self._arrays()["xpos"][bodies.index(body_name)]
        return position

    def __copy__(self) -> Env:
        twin = super().__copy__()
        twin.__dict__.pop("_library", None)
        return twin

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_library": None, "_is_current": False}
