"""The ids: in ``rustgym.registry`` unchanged; in Gymnasium's registry under ``rustgym/`` and, on request, unchanged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import gymnasium
from gymnasium import VectorizeMode, logger
from gymnasium.envs.registration import EnvSpec, get_env_id
from gymnasium.envs.registration import registry as gymnasium_registry

from rustgym._specs import REPLACED, SPECS, entry_point, native, registered, theirs

__all__ = ["ids", "make", "make_vec", "namespaced", "pprint_registry", "register", "registry", "spec"]

NAMESPACE = "rustgym/"

# wrappers of Gymnasium's environments, which are of no use in Python: `import shimmy` registers its own
_NOT_OURS = ("GymV21Environment", "GymV26Environment")


def ids() -> list[str]:
    """The ids of the Rust registry, sorted: the ids that ``rustgym.make`` accepts."""
    return [env_id for env_id in SPECS if not env_id.startswith(_NOT_OURS)]


def namespaced(env_id: str) -> str:
    """The name of an id in Gymnasium's registry: ``rustgym/CartPole-v1``, and for ``ALE/Pong-v5`` ``rustgym/ALE-Pong-v5``."""
    return NAMESPACE + env_id.replace("/", "-")


# the arguments that ale-py's specs have, in its order
_OF_ATARI = "game repeat_action_probability full_action_space frameskip max_num_frames_per_episode".split()


def _kwargs(row: dict[str, Any]) -> dict[str, Any]:
    """An id's arguments as its package registers them."""
    given = {name: tuple(value) if isinstance(value, list) else value for name, value in row["kwargs"].items()}
    if row["crate"] == "gym-atari":
        given = {**{name: given.get(name, row["defaults"][name]) for name in _OF_ATARI}, **given}
    return given


def _spec(name: str, env_id: str, has_vector: bool) -> EnvSpec:
    row = SPECS[env_id]
    return EnvSpec(
        name,
        entry_point=entry_point(env_id),
        reward_threshold=row["reward_threshold"],
        nondeterministic=row["nondeterministic"],
        max_episode_steps=row["max_episode_steps"],
        kwargs=_kwargs(row),
        vector_entry_point=entry_point(env_id) + "_Vector" if has_vector else None,
    )


class Registry(MutableMapping[str, EnvSpec]):
    """The registry that ``rustgym.make`` uses: Gymnasium's, with this package's environments under their own ids.

    A spec that a user adds replaces this package's. Deleting a spec deletes it from Gymnasium's registry too.
    """

    def __init__(self) -> None:
        self._ours = {env_id: _spec(env_id, env_id, has_vector=True) for env_id in ids()}
        # for each id without version: the id of its newest version
        self._latest: dict[str, str] = {}
        for spec in sorted(self._ours.values(), key=lambda spec: spec.version or 0):
            if spec.version is not None:
                self._latest[get_env_id(spec.namespace, spec.name, None)] = spec.id

    def __getitem__(self, env_id: str) -> EnvSpec:
        return self._ours[env_id] if env_id in self._ours else gymnasium_registry[env_id]

    def __setitem__(self, env_id: str, spec: EnvSpec) -> None:
        gymnasium_registry[env_id] = spec
        self._ours.pop(env_id, None)

    def __delitem__(self, env_id: str) -> None:
        if self._ours.pop(env_id, None) is None or env_id in gymnasium_registry:
            del gymnasium_registry[env_id]

    def __iter__(self) -> Iterator[str]:
        return iter({**gymnasium_registry, **self._ours})

    def __len__(self) -> int:
        return len({*gymnasium_registry, *self._ours})

    def __repr__(self) -> str:
        return repr(dict(self))

    def find(self, env_id: str) -> EnvSpec | None:
        """This package's spec for an id, with or without version, or ``None``. Warns of old versions as Gymnasium does."""
        spec = self._ours.get(env_id)
        if spec is None:
            if ":" in env_id or (latest := self._latest.get(env_id)) not in self._ours:
                return None
            logger.warn(
                f"Using the latest versioned environment `{latest}` instead of the unversioned environment `{env_id}`."
            )
            return self._ours[latest]
        latest = self._latest.get(get_env_id(spec.namespace, spec.name, None))
        if latest != env_id and latest in self._ours:
            version = self._ours[latest].version
            logger.deprecation(
                f"The environment {env_id} is out of date. You should consider upgrading to version `v{version}`."
            )
        return spec

    def is_ours_alone(self, namespace: str) -> bool:
        """Whether this package has environments of a namespace of which Gymnasium knows nothing."""
        ours, theirs = ({spec.namespace for spec in specs.values()} for specs in (self._ours, gymnasium_registry))
        return namespace in ours - theirs


#: The registry that ``rustgym.make`` uses.
registry = Registry()


def register(id: str | None = None, *args: Any, replace: bool = False, **kwargs: Any) -> None:
    """Registers this package's environments in Gymnasium's registry. ``import rustgym`` registers them under ``rustgym/``.

    Args:
        id: The id of your own environment. With it, this function is ``gymnasium.register``, with the same arguments; an id
            of this package then stands for your environment.
        replace: With ``True``, registers them also under Gymnasium's own ids, such as ``CartPole-v1``, so that
            ``gymnasium.make`` and libraries on top of it use them. Ids that this version of Gymnasium lacks are registered
            too; their specs keep ids such as ``rustgym/Taxi-v3``. ``make_vec`` then seeds like ``SyncVectorEnv``:
            sub-environment ``i`` with ``seed + i``.
    """
    if id is not None:
        gymnasium.register(id, *args, **kwargs)
        registry._ours.pop(id, None)
        return
    if args or kwargs:
        raise TypeError("register() takes an id and the arguments of gymnasium.register, or `replace` alone")
    if replace and find_spec("ale_py"):
        # the first import of ale_py registers its games: import it now, before this package replaces them
        import_module("ale_py")
    for env_id in ids():
        name = namespaced(env_id)
        if name not in gymnasium_registry:
            gymnasium_registry[name] = _spec(name, env_id, has_vector=True)
        if replace:
            old = gymnasium_registry.get(env_id)
            # an id that has no vector in Gymnasium gets none here: `make_vec` then makes a `SyncVectorEnv` of this package's
            # environment
            has_vector = old is not None and old.vector_entry_point is not None
            # for a wrong version, Gymnasium suggests the ids of specs: specs of ids that only this package has keep `rustgym/`
            is_theirs = old is not None and old.id == env_id
            if (spec := registered(env_id)) is not None:
                REPLACED[env_id] = spec
            gymnasium_registry[env_id] = _spec(env_id if is_theirs else name, env_id, has_vector)


def _ours(env_id: Any) -> Any:
    """This package's spec of an id, with or without version; otherwise ``env_id`` itself."""
    if not isinstance(env_id, str):
        return env_id
    found = registry.find(env_id)
    if found is None and registry.is_ours_alone(env_id.rpartition("/")[0]):
        native.describe(env_id)  # raises an error that suggests similar ids
    return found or env_id


def make(
    id: str | EnvSpec,
    max_episode_steps: int | None = None,
    disable_env_checker: bool | None = None,
    **kwargs: Any,
) -> gymnasium.Env[Any, Any]:
    """Makes an environment in Gymnasium's wrappers: this package's if it has the id, else Gymnasium's.

        >>> import rustgym
        >>> env = rustgym.make("FrozenLake-v1", max_episode_steps=20, map_name="8x8")
        >>> env
        <TimeLimit<OrderEnforcing<PassiveEnvChecker<FrozenLakeEnv<FrozenLake-v1>>>>>
        >>> observation, info = env.reset(seed=42)

    Args:
        id: Such as ``"CartPole-v1"``; ``rustgym.ids()`` lists this package's. ``"module:Name-v0"`` imports ``module`` first, which
            registers the id. Without ``-v1`` it is the newest version. Or a spec, such as ``env.spec`` of another environment.
        max_episode_steps: The steps after which an episode is truncated, instead of the number registered; -1 for never.
        disable_env_checker: With ``True`` there is no ``PassiveEnvChecker``, which checks the first reset, step and picture.
        kwargs: The environment's arguments, which ``help(type(env.unwrapped))`` describes, and ``render_mode``: one of
            ``env.metadata["render_modes"]``, or one with ``_list``, which collects the pictures of an episode.

    Returns:
        The environment in Gymnasium's wrappers. ``env.unwrapped`` is the one within, a ``rustgym.Env`` if it is this package's.

    Raises:
        gymnasium.error.Error: for an id that is not registered; the message suggests similar ones.
        TypeError: for an argument that the environment does not have.
        ValueError: for an argument with a bad value.
    """
    return gymnasium.make(_ours(id), max_episode_steps, disable_env_checker, **kwargs)


def make_vec(
    id: str | EnvSpec,
    num_envs: int = 1,
    vectorization_mode: VectorizeMode | str | None = None,
    vector_kwargs: dict[str, Any] | None = None,
    wrappers: Sequence[Callable[[gymnasium.Env[Any, Any]], gymnasium.Wrapper[Any, Any, Any, Any]]] | None = None,
    **kwargs: Any,
) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    """Makes a vector of environments: this package's if it has the id, else Gymnasium's.

        >>> import rustgym
        >>> envs = rustgym.make_vec("CartPole-v1", num_envs=64)
        >>> observations, infos = envs.reset(seed=42)
        >>> observations.shape
        (64, 4)

    Args:
        id: As of ``make``.
        num_envs: How many environments there are.
        vectorization_mode: ``"vector_entry_point"`` for this package's vector, which is also the default; ``"sync"`` and
            ``"async"`` for Gymnasium's vectors around single environments. A game of Atari gives ale-py's own vector if
            ``"vector_entry_point"`` is asked for and that package is installed.
        vector_kwargs: Arguments of Gymnasium's vectors.
        wrappers: Of each environment in Gymnasium's vectors.
        kwargs: The environment's arguments, and those of ``rustgym.VectorEnv``, such as ``kind`` and ``autoreset_mode``.

    Raises:
        gymnasium.error.Error: for an id that is not registered; the message suggests similar ones.
        TypeError: for an argument that neither the vector nor the environment has.
        ValueError: for an argument with a bad value.
    """
    spec = _ours(id)
    is_of_ale = isinstance(spec, EnvSpec) and spec.id in SPECS and spec.id.startswith("ALE/")
    if is_of_ale and vectorization_mode in (VectorizeMode.VECTOR_ENTRY_POINT, VectorizeMode.VECTOR_ENTRY_POINT.value):
        spec = theirs(spec.id) or spec
    return gymnasium.make_vec(spec, num_envs, vectorization_mode, vector_kwargs, wrappers, **kwargs)


def spec(env_id: str) -> EnvSpec:
    """The spec of an id: this package's if it has the id, else Gymnasium's.

        >>> import rustgym
        >>> rustgym.spec("CartPole-v1").max_episode_steps
        500

    Raises:
        gymnasium.error.Error: for an id that is not registered; the message suggests similar ones.
    """
    found = _ours(env_id)
    return found if isinstance(found, EnvSpec) else gymnasium.spec(found)


def pprint_registry(print_registry: Any = None, **kwargs: Any) -> str | None:
    """Prints the ids, including this package's.

    Args:
        print_registry: The registry whose ids are printed; ``rustgym.registry`` unless given.
        kwargs: As of Gymnasium's function: ``num_cols``, ``exclude_namespaces``, and ``disable_print``, with which the text is
            returned.
    """
    return gymnasium.pprint_registry(registry if print_registry is None else print_registry, **kwargs)
