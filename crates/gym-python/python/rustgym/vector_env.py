"""Many environments stepped as one: ``rustgym.VectorEnv``, a ``gymnasium.vector.VectorEnv``."""

from __future__ import annotations

import json
import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from rustgym import _native
from rustgym._json import brief, to_json
from rustgym._preprocessing import preprocessed
from rustgym._seeds import Seeds
from rustgym._spaces import space_from
from rustgym._specs import class_of, metadata_from, native_arguments, native_options, spec_of
from rustgym.env import Env, checked_seed

__all__ = ["VectorEnv"]


def _whole(name: str, number: Any, least: int) -> int:
    """``number`` as ``int``; raises an error that starts with ``name`` unless it is a whole number and at least ``least``."""
    try:
        whole = operator.index(number)
    except TypeError:
        raise TypeError(f"{name} is {brief(number)}: it must be a whole number") from None
    if whole < least:
        raise ValueError(f"{name} is {brief(whole)}: it must be at least {least}")
    if whole >= 1 << 63:
        raise ValueError(f"{name} is {brief(whole)}: that is too many")
    return whole


def _text(name: str, text: Any) -> str | None:
    """``text``, after a check that it is a text or ``None``."""
    if text is not None and not isinstance(text, str):
        raise TypeError(f"{name} is {brief(text)}: it must be a text or None")
    return text


def _pixels(gray: bool, frame_stack: int) -> str:
    """The Rust wrappers that make pictures the observations, as JSON."""
    wrappers: list[tuple[str, dict[str, Any]]] = [("AddRenderObservation", {"render_only": True})]
    if gray:
        wrappers.append(("GrayscaleObservation", {"keep_dim": False}))
    if frame_stack:
        wrappers.append(("FrameStackObservation", {"stack_size": frame_stack}))
    return json.dumps([{"name": name, "kwargs": kwargs} for name, kwargs in wrappers])


class _Stored:
    """A native vector whose environments may have arguments of their own; what is pickled or copied of it is a native vector."""

    def __init__(self, vector: _native.Vector) -> None:
        self._rebuild, (spec, copy, snapshot) = vector.__reduce__()
        made, each = json.loads(spec), [json.loads(env.arguments()) for env in vector.envs()]
        made["each"] = {**made.get("each", {}), **{name: [arguments[name] for arguments in each] for name in each[0]}}
        self._parts = to_json(made), copy, snapshot

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return self._rebuild, self._parts


class VectorEnv(gymnasium.vector.VectorEnv[Any, Any, Any]):
    """``num_envs`` environments of one id, stepped together in Rust without Python's lock.

    Usually made by ``gymnasium.make_vec("rustgym/CartPole-v1", num_envs=64)``, whose further keywords come here:

        >>> import rustgym
        >>> envs = rustgym.VectorEnv("CartPole-v1", 3, autoreset_mode="SameStep")
        >>> observations, infos = envs.reset(seed=42)
        >>> observations.shape
        (3, 4)
        >>> observations, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
        >>> rewards.dtype, terminated.dtype
        (dtype('float64'), dtype('bool'))

    Args:
        env_id: An id of the Rust registry, without the namespace ``rustgym/``.
        num_envs: How many environments there are.
        kind: ``"sync"`` steps one after the other, ``"async"`` on a pool of threads, ``"native"`` by one loop with vector
            instructions, where the id has it. ``None`` is native where there is one and no render mode is wanted, else sync.
            All give the same results, to the last bit.
        autoreset_mode: When environments are reset whose episode has ended: ``AutoresetMode`` or its value.
        threads: How many threads an async vector has; one for each core unless given. It makes no difference to results.
        affinity: The core of an async vector's first thread; the next thread has the next core, and so on, around the end of those
            that the program may use. Unless given, the operating system chooses.
        copy: With ``True`` each call returns new arrays. With ``False`` two sets of arrays take turns: what a call returned
            is valid until the call after next, which is enough for ``obs, next_obs`` and saves some allocations.
        arg_each: An argument for each environment, by name: a list with one value for each, or a pair ``(low, high)``, from which
            each draws a new value at each reset. ``arg_each={"gravity": (3.7, 11.2)}``
        preprocessing: For the games of Atari: as of ``rustgym.envs.AtariEnv``.
        render_size: Width and height of pictures, which are drawn at that size. With it, or with ``gray`` or ``frame_stack``, the
            observations are the pictures, of any task that draws; with ``render_mode="rgb_array"`` as well, the size is that of
            ``render`` alone.
        gray: Whether the pictures are gray, without an axis of colours.
        frame_stack: How many pictures an observation has, the last ones, along a first axis; 0 for one, without that axis.
        seeds: A list or an iterator of the seeds of all resets to come, those included that the vector makes by itself, such as
            ``itertools.count(1000)``: each takes the next, in a step by index. ``reset(seed=...)`` does not use them.
        max_episode_steps: The steps after which an episode is truncated, instead of the number registered; -1 for never.
        render_mode: As of ``rustgym.Env``; ``render`` then returns a tuple with the current picture of each.
        kwargs: The arguments of the environment.

    ``reset(seed=s)`` seeds environment ``i`` with ``s + i``, as Gymnasium's ``SyncVectorEnv`` does.
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP}
    observation_space: gymnasium.Space[Any]
    action_space: gymnasium.Space[Any]
    single_observation_space: gymnasium.Space[Any]
    single_action_space: gymnasium.Space[Any]

    # the environments, from the first read of `envs`, `get_attr` or a similar method
    _envs: tuple[Env, ...] | None = None
    _keeps_envs = False
    # whether a user has done something with single environments, such as set an argument
    _has_own = False

    def __init__(
        self,
        env_id: str,
        num_envs: int = 1,
        *,
        kind: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        affinity: int | None = None,
        copy: bool = True,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        arg_each: Mapping[str, Sequence[Any] | tuple[float, float]] | None = None,
        preprocessing: bool | Mapping[str, Any] | None = None,
        render_size: tuple[int, int] | None = None,
        gray: bool = False,
        frame_stack: int = 0,
        seeds: Iterable[int] | None = None,
        **kwargs: Any,
    ) -> None:
        defaults = spec_of(env_id)["defaults"]
        num_envs = _whole("num_envs", num_envs, 1)
        if threads is not None:
            threads = _whole("threads", threads, 1)
        if affinity is not None:
            affinity = _whole("affinity", affinity, 0)
        if max_episode_steps is not None:
            max_episode_steps = _whole("max_episode_steps", max_episode_steps, -1)
        for name, flag in (("copy", copy), ("gray", gray)):
            if not isinstance(flag, bool | np.bool_):
                raise TypeError(f"{name} is {brief(flag)}: it must be True or False")
        if seeds is not None and not isinstance(seeds, Iterable):
            raise TypeError(f"seeds is {brief(seeds)}: it must be a list or an iterator of whole numbers")
        kind, render_mode = _text("kind", kind), _text("render_mode", render_mode)
        for name in kwargs:
            if name not in defaults:
                takes = f"its arguments are {', '.join(defaults)}" if defaults else "it takes no arguments"
                raise TypeError(
                    f"{env_id} got an unexpected keyword argument {name!r}: {takes}, and those of rustgym.VectorEnv"
                )
        each = {}
        if not isinstance(arg_each or {}, Mapping):
            raise TypeError(f"arg_each must be a dict of arguments, not {brief(arg_each)}")
        for name, values in (arg_each or {}).items():
            if name not in defaults:
                raise TypeError(f"arg_each has the key {name!r}, which is not an argument of {env_id}")
            if isinstance(values, str) or not isinstance(values, Iterable):
                raise TypeError(
                    f"arg_each has {brief(values)} for {name}: it takes a list with a value for each environment, or a pair (low, high)"
                )
            is_range = isinstance(values, tuple) and len(values) == 2
            each[name] = {"low": values[0], "high": values[1]} if is_range else list(values)
        self._wrappers = "[]"
        if preprocessing:
            kwargs, self._wrappers = preprocessed(env_id, preprocessing, kwargs)
            max_episode_steps = -1 if max_episode_steps is None else max_episode_steps
        if gray or frame_stack or (render_size is not None and render_mode is None):
            if preprocessing:
                raise TypeError("preprocessing decides what is observed: it goes without render_size, gray and frame_stack")
            if render_mode not in (None, "rgb_array"):
                raise ValueError(f"observations of pixels need render_mode=\"rgb_array\", not {render_mode!r}")
            render_mode, self._wrappers = "rgb_array", _pixels(gray, _whole("frame_stack", frame_stack, 0))
        if render_size is not None:
            try:
                width, height = render_size
            except (TypeError, ValueError):
                raise TypeError(f"render_size is {brief(render_size)}: it must be a pair of whole numbers, (width, height)") from None
            render_size = _whole("render_size", width, 1), _whole("render_size", height, 1)
        self.env_id = env_id
        self._given = kwargs
        self.num_envs = num_envs
        self.render_mode = render_mode
        try:
            self.autoreset_mode = AutoresetMode(autoreset_mode)
        except (ValueError, RecursionError):
            modes = ", ".join(mode.value for mode in AutoresetMode)
            raise ValueError(f"autoreset_mode is {brief(autoreset_mode)}: it must be one of {modes}") from None
        self._native = _native.Vector(
            env_id,
            num_envs,
            kind,
            native_arguments(env_id, kwargs),
            render_mode and render_mode.removesuffix("_list"),
            max_episode_steps,
            (AutoresetMode.DISABLED if seeds is not None else self.autoreset_mode).value,
            threads,
            bool(copy) or seeds is not None,
            self._wrappers,
            to_json(each),
            render_size,
            affinity,
        )
        self.kind = self._native.kind
        self._take_spaces()
        is_of_suite = spec_of(env_id)["crate"] == "gym-control"
        # the module imports dm_env, if that is installed
        steps = import_module("rustgym._time_steps").TimeSteps if is_of_suite else None
        self._time_steps = steps and steps(self._native, num_envs, self.autoreset_mode, max_episode_steps, env_id, kwargs)
        self._seeds = None if seeds is None else Seeds(seeds, self.autoreset_mode)
        self._watch()

    def _take_spaces(self) -> None:
        description = json.loads(self._native.describe())
        self.metadata = {**metadata_from(description), "autoreset_mode": self.autoreset_mode}
        self.single_observation_space = space_from(description["observation_space"])
        self.single_action_space = space_from(description["action_space"])
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Starts episodes.

        Args:
            seed: Of the first environment, the next ones having one more each; or a list with one for each.
            options: Those of the environment, and ``"reset_mask"``: a ``bool`` array of shape ``(num_envs,)`` that says which
                environments start an episode. The others stay where they are, and ``infos`` says nothing of them.

        Returns:
            Observations, with a row for each environment, and infos, with a column for each key.
        """
        one = each = mask = None
        if seed is not None:
            if isinstance(seed, Iterable) and not isinstance(seed, (str, bytes)):
                each = [None if s is None else str(checked_seed(s, f"Seed {i}")) for i, s in enumerate(seed)]
            else:
                one = str(checked_seed(seed))
        known = native_options(self.env_id, options)
        if options and "reset_mask" in options:
            mask = self._checked_mask(options["reset_mask"])
        if self._seeds is not None:
            started = np.flatnonzero(np.ones(self.num_envs) if mask is None else mask)
            self._seeds.forget(started)
            if seed is None:
                each = self._seeds.take(started, self.num_envs)
        if self._envs is not None:
            self._push_envs()
        result = self._native.reset(one, each, known, mask)
        if self._time_steps is not None:
            self._time_steps.reset(result[1], mask)
        if self._envs is not None:
            self._follow_envs(is_reset=True)
        return result

    def _checked_mask(self, mask: Any) -> list[bool]:
        array = np.asarray(mask)
        if array.dtype != np.bool_ or array.shape != (self.num_envs,):
            raise ValueError(
                f"options['reset_mask'] must be a bool array of shape ({self.num_envs},), "
                f"not of type {array.dtype} and shape {array.shape}"
            )
        flags: list[bool] = array.tolist()
        return flags

    def step(
        self, actions: Any
    ) -> tuple[Any, npt.NDArray[np.float64], npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]:
        """Takes a step in each environment; one whose reset is due starts an episode instead (see ``autoreset_mode``).

        Args:
            actions: An element of ``action_space``: an action for each environment. Other integer or float types and lists
                are converted.

        Returns:
            Observations, rewards (``float64``), terminated, truncated (``bool``), each with a row for each environment, and
            infos: for each key a column, and under ``_key`` which rows of it count.
        """
        if self._envs is not None:
            self._push_envs()
        native, seeds, time_steps = self._native, self._seeds, self._time_steps
        ongoing = time_steps and time_steps.ongoing
        result = native.step(actions, ongoing) if seeds is None else seeds.step(native, actions, self.num_envs, ongoing)
        if time_steps is not None:
            time_steps.add(*result[2:])
        if self._envs is not None:
            self._follow_envs(is_reset=False)
        return result

    def _watch(self) -> None:
        # if there is nothing to synchronize, `step` becomes the native method itself, or that of its time steps, which saves a call
        own = self.__dict__
        if "step" in own and not self._steps_natively():
            return  # a user has set `step`
        if self._envs is not None or self._seeds is not None or type(self).step is not VectorEnv.step:
            own.pop("step", None)
        else:
            own["step"] = (self._time_steps or self._native).step

    def _steps_natively(self) -> bool:
        owner = getattr(self.__dict__.get("step"), "__self__", None)
        return owner is not None and owner in (self._native, self._time_steps)

    def send(self, actions: Any, env_ids: Sequence[int] | npt.NDArray[np.integer[Any]] | None = None) -> None:
        """Lets some environments of an async vector take a step, and returns at once.

        Args:
            actions: A row for each of ``env_ids``.
            env_ids: Which; all unless given. None of them may be pending.
        """
        if self._seeds is not None:
            raise gymnasium.error.Error("a vector with seeds steps all of its environments at once: it has no send and recv")
        ids = range(self.num_envs) if env_ids is None else env_ids
        self._native.send(actions, [_whole("an id of env_ids", i, 0) for i in ids])

    def recv(self, m: int | None = None) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Waits until ``m`` of the environments that were sent have taken their step, and returns the results of these.

        Args:
            m: How many; ``num_envs`` unless given.

        Returns:
            As ``step``, with ``m`` rows in the order in which they were ready; ``infos["env_id"]`` says whose they are. The other
            columns of ``infos`` have a row for each environment.
        """
        *results, infos, ids = self._native.recv(self.num_envs if m is None else _whole("m", m, 1))
        columns: dict[str, Any] = {}
        for index, info in zip(ids, infos, strict=True):
            columns = self._add_info(columns, info, index)
        if self._time_steps is not None:
            self._time_steps.add(*results[2:], columns, ids)
        columns["env_id"] = np.array(ids)
        return (*results, columns)

    def render(self) -> tuple[Any, ...] | None:
        """The picture or text of each environment."""
        if self.render_mode is None:
            gymnasium.logger.warn(
                "You are calling render method without specifying any render mode. "
                'You can specify the render_mode at initialization, e.g. make_vec(id, n, render_mode="rgb_array")'
            )
            return None
        return self._native.render()

    def close_extras(self, **kwargs: Any) -> None:
        """Ends the threads of an async vector, and with them its use; closes the windows of others, which go on as they were."""
        self._native.close()

    def __repr__(self) -> str:
        return f"rustgym.VectorEnv({self.env_id!r}, num_envs={self.num_envs}, kind={self.kind!r})"

    # -- the environments within

    @property
    def envs(self) -> tuple[Env, ...]:
        """The environments: what is done with them is done in the vector. A native vector has none.

        From the first look on each call of the vector takes them over before and brings them up to date after, which takes time.
        """
        self._keeps_envs = True
        return self._look_at_envs()

    def _look_at_envs(self) -> tuple[Env, ...]:
        if self._envs is None:
            natives = self._native.envs()
            self._envs = tuple(Env._of(native, self.env_id, self.render_mode, self._given) for native in natives)
            self._watch()
        return self._envs

    def _push_envs(self) -> None:
        """Writes what users have done with the environments that they hold to the vector."""
        assert self._envs is not None
        for env in self._envs:
            env._push_into_vector()
        self._native.set_envs([env._native for env in self._envs])
        self.__dict__["_has_own"] = True

    def _follow_envs(self, is_reset: bool) -> None:
        """Updates the environments that users hold after a step or reset."""
        assert self._envs is not None
        for env, native in zip(self._envs, self._native.envs(), strict=True):
            env._native = native
            env._follow(is_reset)
        self._let_go()

    def __getstate__(self) -> dict[str, Any]:
        state = dict(self.__dict__)
        if self._steps_natively():
            del state["step"]
        if self._envs is not None:
            self._push_envs()
            lasting = [env._lasting() for env in self._envs]
            state |= {"_envs": None, "_keeps_envs": False, "_has_own": True, "_lasting": lasting}
        if state.get("_has_own"):
            state["_native"] = _Stored(self._native)
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        lasting = state.pop("_lasting", ())
        if isinstance(state["_native"], _Stored):  # of `copy.copy`
            rebuild, stored = state["_native"].__reduce__()
            state["_native"] = rebuild(*stored)
        self.__dict__.update(state)
        self._watch()
        if any(lasting):
            for env, objects in zip(self._look_at_envs(), lasting, strict=True):
                env._take_lasting(objects)

    def __setattr__(self, name: str, value: Any) -> None:
        if "_seeds" in self.__dict__:  # it is made
            is_known = name in self.__dict__ or hasattr(type(self), name) or type(self).__module__ != "rustgym.envs"
            if name in spec_of(self.env_id)["defaults"]:
                self.set_attr(name, [value] * self.num_envs)
            elif not is_known:
                gymnasium.logger.warn(f"{type(self).__name__} has no {name}: setting it changes nothing but the attribute")
        super().__setattr__(name, value)

    def _let_go(self) -> None:
        """Drops the environments unless a user has read ``envs``, or holds an object of one of them."""
        if not self._keeps_envs and not any(env._is_watched for env in self._envs or ()):
            self._envs = None
            self._watch()

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """The attribute ``name`` of each environment, or the result of the method of that name."""

        def ask(_: int, env: Env) -> Any:
            value = getattr(env, name)
            return value(*args, **kwargs) if callable(value) else value

        return self._with_each(ask)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """The attribute ``name`` of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Sets the attribute ``name`` of each environment, such as ``state``: to one value, or to the values of a list."""
        if not isinstance(values, list | tuple):
            values = [values] * self.num_envs
        if len(values) != self.num_envs:
            raise ValueError(f"there are {len(values)} values for {self.num_envs} environments")
        self._with_each(lambda index, env: setattr(env, name, values[index]))

    def _with_each(self, ask: Callable[[int, Env], Any]) -> tuple[Any, ...]:
        results = tuple(ask(index, env) for index, env in enumerate(self._look_at_envs()))
        self._push_envs()
        self._let_go()
        return results

    @property
    def state(self) -> npt.NDArray[np.float64]:
        """The states of classic control, shape ``(numbers, num_envs)``: Gymnasium's ``CartPoleVectorEnv.state``. Read-only."""
        names: tuple[str, ...] = getattr(class_of(self.env_id), "state_names", ())
        states = self._native.states() if names else None
        if states is None:
            raise AttributeError(f"the state of {self.env_id} is not an array of numbers, or the vector was not reset yet")
        rows = json.loads(states)
        numbers = np.array([[state[name] for state in rows] for name in names])
        numbers.flags.writeable = False
        return numbers

    @property
    def prev_done(self) -> npt.NDArray[np.bool_]:
        """Whether each environment's episode ended in the last step. Read-only."""
        flags = self._native.done()
        flags.flags.writeable = False
        return flags
