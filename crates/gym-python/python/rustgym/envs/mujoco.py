"""The MuJoCo tasks, with Gymnasium's attributes: ``data``, ``model``, ``set_state``, ``dt``.

MuJoCo's Python package is optional. If it is installed, ``data`` and ``model`` are MuJoCo's own objects. Each call of the
environment updates them, and changes to them are written to the environment. After a change that the Rust engine does not
support, such as a change of the model, MuJoCo's package steps the environment, in Gymnasium's own task.
"""

from __future__ import annotations

import json
from functools import cache, cached_property
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import logger

from rustgym._borrowed import Borrowed
from rustgym._live import Live, same
from rustgym._modules import forwarder
from rustgym._mujoco import Mirror, OwnData, load
from rustgym.env import ClassEnv, Env, entropy

__all__ = ["MujocoEnv"]

# a package, as in Gymnasium: `rustgym._modules` finds the modules below it
__path__: list[str] = []
__getattr__ = forwarder(__name__)

# the tasks, and Gymnasium's modules of them, without the version
MODULES = {
    "Ant": "ant",
    "HalfCheetah": "half_cheetah",
    "Hopper": "hopper",
    "Humanoid": "humanoid",
    "HumanoidStandup": "humanoidstandup",
    "InvertedDoublePendulum": "inverted_double_pendulum",
    "InvertedPendulum": "inverted_pendulum",
    "Pusher": "pusher",
    "Reacher": "reacher",
    "Swimmer": "swimmer",
    "Walker2d": "walker2d",
}

# the number of positions that a task can leave out of its observation
_CAN_EXCLUDE = {"Ant": 2, "HalfCheetah": 1, "Hopper": 1, "Humanoid": 2, "HumanoidStandup": 2, "Swimmer": 2, "Walker2d": 1}


# the types of info columns that are not `float64`; `float32` for a `float32` action
_INFO_TYPES: dict[str, dict[str, Any]] = {
    **dict.fromkeys(["Ant", "HalfCheetah", "Hopper", "Pusher", "Reacher", "Swimmer", "Walker2d"], {"reward_ctrl": np.float32}),
    "InvertedPendulum": {"reward_survive": np.int64},
}


@cache
def _installed() -> str | None:
    """The version of MuJoCo's installed Python package, which Gymnasium uses; ``None`` without it."""
    try:
        return version("mujoco")
    except PackageNotFoundError:
        return None


# whether an installed version and a requested version give the same results
_AGREE: dict[tuple[str, str], bool] = {}


def _is_of(installed: str, versions: list[str]) -> bool:
    return installed in versions or ".".join(installed.split(".")[:2]) in versions


@cache
def _tell_other(own: str, installed: str, name: str | None) -> None:
    """Warns, once, that Gymnasium's results differ, because the installed MuJoCo differs."""
    hint = f'make it with mujoco="{name}" for these' if name else "whose numbers rustgym does not repeat"
    gymnasium.logger.warn(
        f"the environment has the numbers of MuJoCo {own}, and Gymnasium has those of the installed mujoco {installed}: {hint}"
    )


def info_types(env_id: str) -> dict[str, Any]:
    """The types of the columns of infos that are not ``float64``."""
    return _INFO_TYPES.get(env_id.rpartition("/")[2].partition("-v")[0], {})


def _has_package() -> bool:
    return find_spec("mujoco") is not None


class MujocoEnv(ClassEnv):
    """A robot that moves by MuJoCo's equations.

    A subclass of a task may override methods that Gymnasium's tasks call, such as ``reset_model`` or ``_get_obs``. A direct
    subclass of this class takes the path of a model, like one of ``gymnasium.envs.mujoco.MujocoEnv``. MuJoCo's package steps
    both kinds.
    """

    # MuJoCo's own model and data, made on first use; without MuJoCo's package, data of this package
    _mirror: Mirror | None = None
    _own_data: OwnData | None = None
    _overrides = False

    _get_obs = Borrowed()
    _get_rew = Borrowed()
    _get_reset_info = Borrowed()
    _set_action_space = Borrowed()
    _initialize_simulation = Borrowed()
    _step_mujoco_simulation = Borrowed(writes=True)
    do_simulation = Borrowed(writes=True)
    reset_model = Borrowed(writes=True)
    control_cost = Borrowed()
    contact_cost = Borrowed()
    contact_forces = Borrowed()
    healthy_reward = Borrowed()
    is_healthy = Borrowed()
    terminated = Borrowed()

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        if not hasattr(type(self), "_id"):
            self._theirs().__init__(self, *args, **kwargs)
            return
        super().__init__(*args, **kwargs)
        if (installed := _installed()) is not None and not self._is_of_version(installed):
            versions = self._made_of["versions"]
            name = next((name for name in versions if _is_of(installed, versions[name])), None)
            _tell_other(self._made_of["mujoco"], installed, name)
        own = (vars(cls) for cls in type(self).__mro__[: type(self).__mro__.index(MujocoEnv)])
        self._overrides = any(isinstance(found, Borrowed) for names in own for found in map(vars(MujocoEnv).get, names))
        if self._overrides:
            self._hand_over("a method that Gymnasium's task calls", warn=False)

    def _is_of_version(self, installed: str) -> bool:
        """Whether an installed version of MuJoCo's package gives the results of this environment."""
        key = installed, str(self.arguments.get("mujoco"))
        if key not in _AGREE:
            _AGREE[key] = _is_of(installed, self._made_of["versions"][self._made_of["mujoco"]])
        return _AGREE[key]

    @classmethod
    @cache
    def _theirs(cls) -> Any:
        """Gymnasium's class of the task, which needs MuJoCo's package."""
        env_id = getattr(cls, "_id", None)
        if not _has_package():
            raise gymnasium.error.DependencyNotInstalled("this needs the package mujoco: run `pip install mujoco`")
        if env_id is None:
            return import_module("gymnasium.envs.mujoco.mujoco_env").MujocoEnv
        task, _, version = env_id.rpartition("/")[2].partition("-v")
        if version not in ("4", "5"):
            raise AttributeError(f"Gymnasium has no class for {env_id}: versions 4 and 5 have one")
        return getattr(import_module(f"gymnasium.envs.mujoco.{MODULES[task]}_v{version}"), f"{task}Env")

    # -- reset and step

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """As ``Env.reset``."""
        if self._native is not None and not self._is_handed:
            if self._is_watched:
                self._push()
            if not self._is_handed:
                return super().reset(seed=seed, options=options)
        gymnasium.Env.reset(self, seed=seed)
        import_module("mujoco").mj_resetData(self.model, self.data)
        observation = self.reset_model()
        info = self._get_reset_info()
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """As ``Env.step``. Raises ``ValueError`` for an action of another shape, as Gymnasium's tasks do."""
        try:
            return super().step(action)
        except gymnasium.error.InvalidAction:
            expected, found = self.action_space.shape, np.shape(action)
            if found == expected:
                raise
            raise ValueError(f"Action dimension mismatch. Expected {expected}, found {found}") from None

    def _watched_step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        if not self._is_handed:
            self._push("step")
        if self._is_handed:
            result: tuple[Any, float, bool, bool, dict[str, Any]] = self._theirs().step(self, action)
            return result
        result = self._native.step(action)
        self._follow()
        return result

    def render(self) -> Any:
        """As ``Env.render``. Depths are in metres along the viewing direction, and belong to this package's own pictures.
        MuJoCo's package, which ``mujoco_renderer`` uses, returns the values of its depth buffer, from 0 to 1."""
        if self._native is None or (self.render_mode and self._is_handed):
            if self._is_watched and self._native is not None:
                self._push()
            return self.mujoco_renderer.render(self.render_mode)
        return super().render()

    def close(self) -> None:
        """As ``Env.close``."""
        super().close()
        if (renderer := self.__dict__.pop("mujoco_renderer", None)) is not None:
            renderer.close()

    # -- the state

    def set_state(self, state: Any, qvel: npt.ArrayLike | None = None) -> None:
        """Continues from other positions and velocities, or from a text that ``get_state`` returned.

        Args:
            state: The positions (``nq`` numbers), or without ``qvel`` a whole state.
            qvel: The velocities (``nv`` numbers).

        Raises:
            ValueError: for an invalid state; the environment is then unchanged.
        """
        if qvel is None:
            self._set_whole_state(state)
        elif self._is_handed:
            self._theirs().set_state(self, np.asarray(state), np.asarray(qvel))
        else:
            qpos, qvel = np.array(state, np.float64).ravel(), np.array(qvel, np.float64).ravel()
            self._push()
            if not self._native.is_running():
                self._native.reset(str(entropy()), None)
            self._native.set_mujoco_state(qpos, qvel)
            self._follow_data(is_reset=False)

    def get_state(self) -> str:
        """As ``Env.get_state``."""
        state = super().get_state()
        if not self._is_handed:
            return state
        return json.dumps({"native": json.loads(state), "mujoco": self._touched().store()})

    def _set_whole_state(self, state: Any) -> None:
        whole = json.loads(state) if isinstance(state, str) else None
        if not isinstance(whole, dict) or "mujoco" not in whole:
            if self._is_handed:
                raise ValueError("the state is of an environment that MuJoCo's package does not step, and it steps this one")
            super().set_state(state)
            return
        self._hand_over("a state of an environment that MuJoCo's package steps", warn=False)
        self._mirror = Mirror.stored(whole["mujoco"], self._has_contact_forces)
        super().set_state(json.dumps(whole["native"]))
        self.__dict__.pop("mujoco_renderer", None)

    # -- MuJoCo's objects

    @property
    def _is_handed(self) -> bool:
        """Whether MuJoCo's package steps the environment."""
        return self._native is None or (self._mirror is not None and self._mirror.is_handed)

    def _watch(self) -> None:
        if self._mirror is None and self._own_data is None:
            super()._watch()
        else:
            self.__dict__["_is_watched"] = True

    def _push(self, call: str = "") -> None:
        super()._push(call)
        if self._own_data is not None:
            self._take_over(self._own_data.changes())
        elif self._mirror is not None:
            if self._mirror.is_handed:
                self._write_native({name: np.array(getattr(self.data, name)) for name in ("qpos", "qvel", "qacc_warmstart")})
                return
            changed, unknown = self._mirror.changes()
            if unknown is not None:
                self._hand_over(unknown)
            else:
                self._take_over(changed)

    def _push_into_vector(self) -> None:
        super()._push_into_vector()
        if self._is_handed:
            raise gymnasium.error.Error(
                "what was changed needs MuJoCo's package, which steps no environment of a vector: gymnasium.vector.SyncVectorEnv does"
            )

    def _take_over(self, changed: dict[str, Any]) -> None:
        if changed and self._native.is_running():
            self._write_native(changed)

    def _write_native(self, changed: dict[str, Any]) -> None:
        whole, episode = self._take_apart()
        if episode is None:
            return
        data = episode["data"]
        if data["last"] is not None and data["before"] is None:
            data["before"] = dict(data["state"])
        data["state"].update((name, value.tolist() if np.ndim(value) else value) for name, value in changed.items())
        self._native.restore(json.dumps(whole), self._native.is_running())

    def _follow(self, is_reset: bool = False) -> None:
        super()._follow(is_reset)
        self._follow_data(is_reset)

    def _follow_data(self, is_reset: bool) -> None:
        if self._own_data is not None:
            self._own_data.follow(self._arrays())
        elif self._mirror is not None and not self._mirror.is_handed:
            self._mirror.follow(self._native, is_reset)

    @property
    def _has_contact_forces(self) -> bool:
        return int(self.env_id.rpartition("-v")[2]) >= 4

    def _touched(self) -> Mirror:
        """MuJoCo's model and data, made on first use and updated from then on."""
        if self._mirror is None:
            if not _has_package():
                raise gymnasium.error.DependencyNotInstalled(
                    "`model` needs the package mujoco: run `pip install mujoco`; `data`, `dt`, `init_qpos`, `state_vector()` and "
                    "`get_body_com()` work without it"
                )
            arguments = {"width": 480, "height": 480, **self.arguments}
            model = load(self._made_of["xml_file"], self._made_of["xml"], arguments["width"], arguments["height"])
            self._mirror = Mirror(model, self._has_contact_forces)
            self._mirror.follow(self._native, is_reset=True)
            self._watch()
        return self._mirror

    def _hand_over(self, cause: str, warn: bool = True) -> None:
        """Lets MuJoCo's package step the environment from now on."""
        if self._is_handed:
            return
        version = self._made_of["mujoco"]
        if not _has_package():
            raise gymnasium.error.DependencyNotInstalled(
                f"{cause} was changed, which needs the package mujoco: run `pip install mujoco=={version}.*`"
            )
        installed = str(_installed())
        if not self._is_of_version(installed):
            raise gymnasium.error.Error(
                f"{cause} was changed: MuJoCo's package would have to step the environment, and {installed} is installed, while "
                f"this environment computes as {version}: make it with mujoco={'.'.join(installed.split('.')[:2])!r}"
            )
        self._theirs()  # raises where there is none
        self._touched().is_handed = True
        # Gymnasium's step reads the arguments under these names
        self.__dict__.update((f"_{name}", getattr(self, f"_{name}")) for name in self.arguments)
        if warn:
            logger.warn(f"{cause} was changed: from now on the package mujoco steps this {type(self).__name__}, at its speed")

    @property
    def data(self) -> Any:
        """The state and the arrays computed from it, under the names of ``mjData``: ``qpos``, ``qvel``, ``xpos``, ``cfrc_ext``, ...

        MuJoCo's own object if its package is installed, else an object with the same names. Each call of the environment
        updates it; changes to it are written to the environment before the next step.
        """
        if self._mirror is not None:
            return self._mirror.data
        if self._native is None:
            return self.__dict__["data"]
        if not _has_package():
            if self._own_data is None:
                self._own_data = OwnData(self._arrays())
                self._watch()
            return self._own_data
        return self._touched().data

    @data.setter
    def data(self, data: Any) -> None:
        if self._native is None:
            self.__dict__["data"] = data
        else:
            self._hand_over("data")
            self._touched().data = data

    @property
    def model(self) -> Any:
        """MuJoCo's own object for the model. After the first change to it, MuJoCo's package steps the environment.

        Raises:
            gymnasium.error.DependencyNotInstalled: without MuJoCo's Python package, which nothing else here needs.
        """
        if self._mirror is not None:
            return self._mirror.model
        return self.__dict__["model"] if self._native is None else self._touched().model

    @model.setter
    def model(self, model: Any) -> None:
        if self._native is None:
            self.__dict__["model"] = model
        else:
            self._hand_over("model")
            self._touched().model = model

    @cached_property
    def mujoco_renderer(self) -> Any:
        """Gymnasium's renderer of ``model`` and ``data``, which needs MuJoCo's package."""
        get = self.arguments.get
        module = import_module("gymnasium.envs.mujoco.mujoco_rendering")
        options = get("visual_options")
        camera = self._given.get("default_camera_config")
        if camera is None:
            camera = getattr(import_module(self._theirs().__module__), "DEFAULT_CAMERA_CONFIG", {})
        return module.MujocoRenderer(
            self.model,
            self.data,
            camera,
            get("width") or 480,
            get("height") or 480,
            get("max_geom") or 1000,
            get("camera_id"),
            get("camera_name"),
            options and {int(key): value for key, value in dict(options).items()},
        )

    def _arrays(self) -> dict[str, Any]:
        arrays = self._native.mujoco_data()
        assert arrays is not None, "an id of these tasks"
        return arrays

    @cached_property
    def _made_of(self) -> dict[str, Any]:
        facts = self._native.mujoco_model()
        assert facts is not None, "an id of these tasks"
        return facts

    # -- arguments and attributes

    def __getattr__(self, name: str) -> Any:
        # Gymnasium's tasks store their arguments under names with an underscore
        arguments = self.__dict__.get("arguments", {})
        if name.startswith("_") and name[1:] in arguments:
            value = arguments[name[1:]]
            if isinstance(value, list | tuple):  # a range: an end that is missing is infinite
                return tuple(end if x is None else x for x, end in zip(value, (-np.inf, np.inf), strict=True))
            return value
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __setattr__(self, name: str, value: Any) -> None:
        arguments = self.__dict__.get("arguments", {})
        if name.startswith("_") and name[1:] in arguments:
            self._set_argument(name[1:], value)
            object.__setattr__(self, name, value)
        elif isinstance(borrowed := vars(MujocoEnv).get(name), Borrowed) and self._native is not None:
            borrowed.replace(self, value)
        elif name in ("mujoco_renderer", "frame_skip"):
            object.__setattr__(self, name, value)
        else:
            super().__setattr__(name, value)

    def _knows(self, name: str) -> bool:
        # Gymnasium's tasks read many attributes with an underscore
        if not name.startswith("_") or type(self).__module__ != "rustgym.envs" or "arguments" not in self.__dict__:
            return super()._knows(name)
        return name in self.__dict__ or hasattr(type(self), name)

    def _set_argument(self, name: str, value: Any) -> None:
        """Changes an argument. If the Rust side steps the environment, it is rebuilt."""
        self.arguments[name] = value
        if self._is_handed:
            return
        self._push()
        if isinstance(value, tuple | list):  # a range: an end that is infinite is left out
            value = [None if np.isinf(x) else x for x in value]
        self._rebuild({name: value})
        self.__dict__.pop("_made_of", None)

    @property
    def frame_skip(self) -> int:
        """The number of timesteps per step. It can be set."""
        own = self.__dict__.get("frame_skip")
        return int(self._made_of["frame_skip"] if own is None else own)

    @frame_skip.setter
    def frame_skip(self, number: int) -> None:
        if self._native is None:
            self.__dict__["frame_skip"] = number
        elif "frame_skip" in self.arguments:
            self._set_argument("frame_skip", number)
            if self._is_handed:
                self.__dict__["frame_skip"] = number
        else:
            self._hand_over("frame_skip")
            self.__dict__["frame_skip"] = number

    @property
    def dt(self) -> float:
        """Seconds per step: the timestep of ``model`` times ``frame_skip``."""
        has_own = self._native is not None and self._mirror is None
        return float((self._made_of["timestep"] if has_own else self.model.opt.timestep) * self.frame_skip)

    def _initial(self, name: str) -> npt.NDArray[np.float64]:
        return np.array(self._made_of["qpos0"]) if name == "init_qpos" else np.zeros(self._made_of["nv"])

    def _write_initial(self, name: str, value: Any) -> None:
        if self._native is not None and not same(value, self._initial(name)):
            self._hand_over(name)

    init_qpos = Live(
        lambda self: self._initial("init_qpos"),
        lambda self, value: self._write_initial("init_qpos", value),
        outlives_reset=True,
        outlives_step=True,
        doc="The positions that an episode's start is drawn around.",
    )
    init_qvel = Live(
        lambda self: self._initial("init_qvel"),
        lambda self, value: self._write_initial("init_qvel", value),
        outlives_reset=True,
        outlives_step=True,
        doc="The velocities that an episode's start is drawn around.",
    )

    @property
    def observation_structure(self) -> dict[str, int]:
        """The number of elements of each array in an observation, in this order, and the number of positions left out.

        Raises:
            AttributeError: for versions before 5, and for tasks that do not have it in Gymnasium.
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
        if self._native is None or self._mirror is not None or self._own_data is not None:
            return np.concatenate([self.data.qpos.flat, self.data.qvel.flat])
        arrays = self._arrays()
        return np.concatenate([arrays["qpos"], arrays["qvel"]])

    def get_body_com(self, body_name: str) -> npt.NDArray[np.float64]:
        """The position of a body's frame, in metres. As in MuJoCo, after a step it is that of the engine's last forward call.

        Raises:
            KeyError: for a name that no body of the model has.
        """
        if self._native is None or self._mirror is not None:
            position: npt.NDArray[np.float64] = self.data.body(body_name).xpos
            return position
        bodies = self._made_of["bodies"]
        if body_name not in bodies:
            names = ", ".join(repr(name) for name in bodies)
            raise KeyError(f"the model has no body {body_name!r}: its bodies are {names}")
        position = self._arrays()["xpos"][bodies.index(body_name)]
        return position

    def __copy__(self) -> Env:
        twin = super().__copy__()
        mirror, twin.__dict__["_own_data"] = self._mirror, None
        twin.__dict__.pop("mujoco_renderer", None)
        if mirror is not None:
            twin.__dict__["_mirror"] = mirror.copy() if mirror.is_handed else None
        twin._watch()
        return twin

    def __getstate__(self) -> Any:
        state = super().__getstate__()
        if self._native is not None:
            mirror = self._mirror if self._is_handed else None
            state = {**state, "_mirror": mirror, "_own_data": None}
            state.pop("mujoco_renderer", None)
        return state
