"""The MuJoCo tasks, with Gymnasium's attributes: ``data``, ``model``, ``set_state``, ``dt``.

Nothing here needs MuJoCo. Where its Python package is installed, ``data`` and ``model`` are MuJoCo's own objects, and both ways
are open: they follow the environment, and the environment takes over what is written to them. What our engine does not know, such
as another model, hands the environment over: from then on the package steps it, by Gymnasium's own task.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from functools import cache, cached_property
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from types import FunctionType
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import logger

from rustgym._borrowed import Borrowed
from rustgym._class_env import ClassEnv
from rustgym._live import Live, same
from rustgym._modules import forwarder
from rustgym._mujoco import Mirror, OwnData, load, model_path, observation_structure, renderer
from rustgym._opened import package_of
from rustgym._releases import is_of, tell_other
from rustgym._specs import task_of
from rustgym.env import Env, entropy

__all__ = ["MujocoEnv"]

# makes this module a package, as Gymnasium's is; `rustgym._modules` finds its submodules
__path__: list[str] = []
__getattr__ = forwarder(__name__)

# by task: the name of Gymnasium's module without its version
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

# by task: attributes that Gymnasium's reset sets, computed from the positions
_OF_START: dict[str, dict[str, Callable[[npt.NDArray[np.float64]], npt.NDArray[Any]]]] = {
    "Pusher": {"goal_pos": lambda qpos: np.asarray([0, 0]), "cylinder_pos": lambda qpos: qpos[-4:-2].copy()},
    "Reacher": {"goal": lambda qpos: qpos[-2:].copy()},
}


@cache
def _installed() -> str | None:
    """The installed version of the package ``mujoco``, which Gymnasium computes with; ``None`` without one."""
    try:
        return version("mujoco")
    except PackageNotFoundError:
        return None


# by installed version and the argument `mujoco`: whether both give the same numbers
_AGREE: dict[tuple[str, str], bool] = {}


def _has_package() -> bool:
    return find_spec("mujoco") is not None


class MujocoEnv(ClassEnv):
    """A robot that moves by MuJoCo's equations.

    A class of your own on top of a task may override what Gymnasium's tasks call, such as ``reset_model`` or ``_get_obs``; and a
    class of your own on top of this one is made as one of ``gymnasium.envs.mujoco.MujocoEnv`` is, from the path of a model. Both
    are stepped by MuJoCo's package. A class that overrides one of these methods or ``step`` has the numbers of the installed
    package unless it is made with another ``mujoco``.
    """

    # MuJoCo's own model and data, made on first use; without the package `mujoco`, `_own_data` replaces the data
    _mirror: Mirror | None = None
    _own_data: OwnData | None = None
    # the positions at the start of the episode, if Gymnasium's task stores some of them as attributes
    _start: npt.NDArray[np.float64] | None = None
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
        self.metadata = dict(self.metadata)
        mro = type(self).__mro__
        own = {name for cls in mro[: mro.index(MujocoEnv)] if cls.__module__ != "rustgym.envs" for name in vars(cls)}
        self.__dict__["_overrides"] = any(map(self._is_called, own))
        if (installed := _installed()) is not None and not self._is_of_version(installed):
            versions = self._made_of["versions"]
            name = next((name for name in versions if is_of(installed, versions[name])), None)
            if name is not None and "mujoco" not in kwargs and (self._overrides or "step" in own):
                super().__init__(*args, **kwargs, mujoco=name)  # the installed package will step the environment
                self.__dict__.pop("_made_of")
            else:
                tell_other(self._made_of["mujoco"], installed, name)
        if self._overrides:
            self._hand_over("a method that Gymnasium's task calls", warn=False)

    # these tasks are handed over to MuJoCo's package; opened are only classes that make the model or the action space
    @classmethod
    def _is_opened(cls, kwargs: dict[str, Any]) -> bool:
        made = ("_initialize_simulation", "_set_action_space")
        return hasattr(cls, "_id") and any(not isinstance(getattr(cls, name), Borrowed) for name in made) and super()._is_opened(kwargs)

    @classmethod
    def _given_there(cls, kwargs: dict[str, Any]) -> dict[str, Any]:
        given = super()._given_there(kwargs)
        version, installed = given.pop("mujoco", None), str(_installed())
        if version is not None and not is_of(installed, [str(version)]):
            raise gymnasium.error.Error(f"this needs the package mujoco {version}, and {installed} is installed")
        return given

    def _is_read_elsewhere(self, name: str, value: Any) -> bool:
        return False

    def _opens(self, name: str) -> bool:
        return False

    @classmethod
    def _is_called(cls, name: str) -> bool:
        """Whether Gymnasium's task calls the method or property ``name``."""
        if isinstance(vars(MujocoEnv).get(name), Borrowed):
            return True
        is_free = name.startswith("__") or name in ("step", "reset", "render", "close", "metadata")
        return not is_free and _has_package() and hasattr(cls, "_id") and hasattr(getattr(package_of(cls._id), "made", None), name)

    def _is_of_version(self, installed: str) -> bool:
        """Whether version ``installed`` of the package ``mujoco`` computes the same numbers as this environment."""
        key = installed, str(self.arguments.get("mujoco"))
        if key not in _AGREE:
            _AGREE[key] = is_of(installed, self._made_of["versions"][self._made_of["mujoco"]])
        return _AGREE[key]

    @classmethod
    @cache
    def _theirs(cls) -> Any:
        """Gymnasium's class for the task, or its ``MujocoEnv`` for a user's class without an id."""
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
                result = super().reset(seed=seed, options=options)
                self._keep_start()
                return result
        gymnasium.Env.reset(self, seed=seed)
        import_module("mujoco").mj_resetData(self.model, self.data)
        observation = self.reset_model()
        info = self._get_reset_info()
        if self.render_mode == "human":
            self.render()
        return observation, info

    def _keep_start(self) -> None:
        """Sets the attributes that a reset of Gymnasium's task sets."""
        if (parts := _OF_START.get(task_of(self.env_id))) is None:
            return
        called = self._native.mujoco_before()
        assert called is not None, "it was reset"
        start = self._start = called[2]["qpos"]
        self.__dict__.update((name, part(start)) for name, part in parts.items())
        if self._handed and "init_qpos" in self._handed and "cylinder_pos" in parts:
            # Gymnasium's reset writes the positions of the objects into `init_qpos`
            self._handed["init_qpos"][-4:] = start[-4:]
            self._seen["init_qpos"] = self._handed["init_qpos"].copy()

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
        """As ``Env.render``. Depths are in metres, along the direction in which the camera looks, of our own drawing; MuJoCo's
        package, which ``mujoco_renderer`` draws with, has the numbers of its buffer, from 0 to 1."""
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
            ValueError: for what is no state of this environment, which is then as it was.
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
        try:
            whole = json.loads(state) if isinstance(state, str) else None
        except (ValueError, RecursionError):
            whole = None  # the Rust side says what is wrong
        if not isinstance(whole, dict) or "mujoco" not in whole:
            if self._is_handed:
                raise ValueError("the state is of an environment that MuJoCo's package does not step, and it steps this one")
            super().set_state(state)
            return
        before, was_handed = self._mirror, self._is_handed
        try:
            self._hand_over("a state of an environment that MuJoCo's package steps", warn=False)
            self._mirror = self._touched().restored(whole["mujoco"])
            super().set_state(json.dumps(whole.get("native")))
        except ValueError:
            self._mirror = before
            if before is not None:
                before.is_handed = was_handed
            self._watch()
            raise
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
            self._set_watched(True)

    def _push(self, call: str = "") -> None:
        super()._push(call)
        if self._own_data is not None:
            self._take_over(self._own_data.changes())
        elif self._mirror is not None:
            if self._mirror.is_handed:
                arrays = {name: np.array(getattr(self.data, name)) for name in ("qpos", "qvel", "qacc_warmstart")}
                # (what has diverged is MuJoCo's alone: its next step starts anew)
                self._write_native({name: array for name, array in arrays.items() if np.all(np.abs(array) <= 1e10)})
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
        self._go_on_from(whole)

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
        """MuJoCo's model and data, which are updated after each step from now on."""
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
        """Lets MuJoCo's package step the environment from now on; ``cause`` is named in the warning and in errors."""
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
        self._theirs()  # raises an error if Gymnasium has no class for the task
        self._touched().is_handed = True
        # Gymnasium's step reads the arguments as attributes with an underscore
        self.__dict__.update((f"_{name}", getattr(self, f"_{name}")) for name in self.arguments)
        if warn:
            logger.warn(f"{cause} was changed: from now on the package mujoco steps this {type(self).__name__}, at its speed")

    @property
    def data(self) -> Any:
        """The state and the arrays computed from it, under the names of ``mjData``: ``qpos``, ``qvel``, ``xpos``, ``cfrc_ext``, ...

        MuJoCo's own object where its package is installed, else one of ours with the same names. It follows the environment; what
        is written to it is taken over before the next step.
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
        """MuJoCo's own object for the model. The first change to it hands the environment over to MuJoCo's package.

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
        model, data = self.model, self.data
        camera = self._given.get("default_camera_config")
        if camera is None:
            camera = getattr(import_module(self._theirs().__module__), "DEFAULT_CAMERA_CONFIG", {})
        return renderer(model, data, camera, self.arguments)

    def _arrays(self) -> dict[str, Any]:
        arrays = self._native.mujoco_data()
        assert arrays is not None, "an id of these tasks"
        return arrays

    @cached_property
    def fullpath(self) -> str:
        """The path of the model's file."""
        xml_file = self._made_of["xml_file"]
        return model_path(xml_file) if self._made_of["xml"] is not None else os.path.expanduser(xml_file)

    @cached_property
    def _made_of(self) -> dict[str, Any]:
        facts = self._native.mujoco_model()
        assert facts is not None, "an id of these tasks"
        return facts

    # -- arguments and attributes

    def __getattr__(self, name: str) -> Any:
        # Gymnasium's tasks store their arguments as attributes with an underscore
        arguments = self.__dict__.get("arguments", {})
        if name.startswith("_") and name[1:] in arguments:
            value = arguments[name[1:]]
            if isinstance(value, list | tuple):  # a range: None stands for an infinite end
                return tuple(end if x is None else x for x, end in zip(value, (-np.inf, np.inf), strict=True))
            return value
        return super().__getattr__(name)  # type: ignore[misc]

    def __setattr__(self, name: str, value: Any) -> None:
        arguments = self.__dict__.get("arguments")
        if arguments is None or name in ("mujoco_renderer", "frame_skip", "spec", "metadata"):
            object.__setattr__(self, name, value)
        elif name.startswith("_") and name[1:] in arguments:
            self._set_argument(name[1:], value)
            object.__setattr__(self, name, value)
        elif isinstance(borrowed := vars(MujocoEnv).get(name), Borrowed) and self._native is not None:
            borrowed.replace(self, value)
        elif self._native is not None and isinstance(getattr(type(self), name, None), FunctionType) and self._is_called(name):
            self._hand_over(name)
            object.__setattr__(self, name, value)
        else:
            super().__setattr__(name, value)

    def _knows(self, name: str) -> bool:
        return super()._knows(name) or name in _OF_START.get(task_of(self.env_id), ())

    def _set_argument(self, name: str, value: Any) -> None:
        """Sets an argument and keeps the state of the episode."""
        self.arguments[name] = value
        if self._is_handed:
            return
        self._push()
        if isinstance(value, tuple | list):  # a range: None stands for an infinite end
            value = [None if np.isinf(x) else x for x in value]
        self._rebuild({name: value})
        self.__dict__.pop("_made_of", None)

    @property
    def frame_skip(self) -> int:
        """The number of the model's timesteps per step. It can be set."""
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
        """Seconds from one step to the next: the timestep of ``model`` times ``frame_skip``."""
        has_own = self._native is not None and self._mirror is None
        return float((self._made_of["timestep"] if has_own else self.model.opt.timestep) * self.frame_skip)

    def _initial(self, name: str) -> npt.NDArray[np.float64]:
        initial = np.array(self._made_of[name])
        if name == "init_qpos" and self._start is not None and task_of(self.env_id) == "Pusher":
            initial[-4:] = self._start[-4:]
        return initial

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
            AttributeError: for versions before 5 and tasks whose observation is made in another way, as in Gymnasium.
        """
        return observation_structure(self.env_id, self._made_of, self.arguments)

    def state_vector(self) -> npt.NDArray[np.float64]:
        """The positions, then the velocities."""
        if self._native is None or self._mirror is not None or self._own_data is not None:
            return np.concatenate([self.data.qpos.flat, self.data.qvel.flat])
        arrays = self._arrays()
        return np.concatenate([arrays["qpos"], arrays["qvel"]])

    def get_body_com(self, body_name: str) -> npt.NDArray[np.float64]:
        """The position of a body's frame, in metres; after a step as of the engine's last forward call, as in MuJoCo.

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
