"""The ids: as they are in ``rustgym.registry``, under ``rustgym/`` in Gymnasium's, and on request there as they are, too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeVar

import gymnasium
from gymnasium import VectorizeMode, logger
from gymnasium.envs.registration import EnvSpec, get_env_id
from gymnasium.envs.registration import registry as gymnasium_registry

from rustgym._specs import SPECS, entry_point

__all__ = ["ids", "make", "make_vec", "namespaced", "pprint_registry", "register", "registry", "spec"]

NAMESPACE = "rustgym/"

_Function = TypeVar("_Function", bound=Callable[..., Any])

# Python's environments through Rust are of no use in Python: Gymnasium has its own, which `import shimmy` registers anew
_NOT_OURS = ("GymV21Environment", "GymV26Environment")


def ids() -> list[str]:
    """The ids of the Rust registry, sorted: the ids that ``rustgym.make`` accepts."""
    return [env_id for env_id in SPECS if not env_id.startswith(_NOT_OURS)]


def namespaced(env_id: str) -> str:
    """The name of an id in Gymnasium's registry: ``rustgym/CartPole-v1``, and for ``ALE/Pong-v5`` ``rustgym/ALE-Pong-v5``."""
    return NAMESPACE + env_id.replace("/", "-")


def _spec(name: str, env_id: str, has_vector: bool) -> EnvSpec:
    row = SPECS[env_id]
    return EnvSpec(
        name,
        entry_point=entry_point(env_id),
        reward_threshold=row["reward_threshold"],
        nondeterministic=row["nondeterministic"],
        max_episode_steps=row["max_episode_steps"],
        kwargs=dict(row["kwargs"]),
        vector_entry_point=entry_point(env_id) + "_Vector" if has_vector else None,
    )


class Registry(MutableMapping[str, EnvSpec]):
    """The registry as ``rustgym.make`` sees it: Gymnasium's, with our environments under their own ids.

    Whatever is put into it takes the place of ours; what is deleted from it is gone from Gymnasium's registry as well.
    """

    def __init__(self) -> None:
        self._ours = {env_id: _spec(env_id, env_id, has_vector=True) for env_id in ids()}
        # the id of the newest version, by the id without one
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
        """Our spec for an id, with or without version; ``None`` where the id is not one of ours. Warns as Gymnasium does."""
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


#: The registry as ``rustgym.make`` sees it.
registry = Registry()


def register(id: str | None = None, *args: Any, replace: bool = False, **kwargs: Any) -> None:
    """Puts our environments into Gymnasium's registry; ``import rustgym`` does so under ``rustgym/``.

    Args:
        id: The id of an environment of yours: with it this is ``gymnasium.register``, with the arguments of that. An id that
            is one of ours means yours from then on.
        replace: With ``True`` also under Gymnasium's own ids, such as ``CartPole-v1``, for all that ``gymnasium.make`` and
            libraries on top of it do from then on; and under those that this version of Gymnasium lacks, whose specs keep
            ids such as ``rustgym/Taxi-v3``. ``make_vec`` then gives the numbers of ``SyncVectorEnv``: sub-environment ``i``
            is seeded with ``seed + i``.
    """
    if id is not None:
        gymnasium.register(id, *args, **kwargs)
        registry._ours.pop(id, None)
        return
    if args or kwargs:
        raise TypeError("register() takes an id and the arguments of gymnasium.register, or `replace` alone")
    if replace and find_spec("ale_py"):
        # it registers its games when it is first imported: a later import would put them over ours
        import_module("ale_py")
    for env_id in ids():
        name = namespaced(env_id)
        if name not in gymnasium_registry:
            gymnasium_registry[name] = _spec(name, env_id, has_vector=True)
        if replace:
            old = gymnasium_registry.get(env_id)
            # an id without a vector of its own keeps none: `make_vec` then makes Gymnasium's SyncVectorEnv of ours
            has_vector = old is not None and old.vector_entry_point is not None
            # a wrong version gets suggestions by the specs' ids, and Gymnasium suggests none that it lacks
            is_theirs = old is not None and old.id == env_id
            gymnasium_registry[env_id] = _spec(env_id if is_theirs else name, env_id, has_vector)


def _ours(env_id: Any) -> Any:
    """The spec of an id if it is one of ours, with or without version; otherwise what was given."""
    return (registry.find(env_id) or env_id) if isinstance(env_id, str) else env_id


def _like(function: Callable[..., Any]) -> Callable[[_Function], _Function]:
    """Appends Gymnasium's own description of a function."""

    def add(ours: _Function) -> _Function:
        ours.__doc__ = f"{ours.__doc__}\n\n    As ``gymnasium.{function.__name__}``:\n\n{function.__doc__}"
        return ours

    return add


@_like(gymnasium.make)
def make(
    id: str | EnvSpec,
    max_episode_steps: int | None = None,
    disable_env_checker: bool | None = None,
    **kwargs: Any,
) -> gymnasium.Env[Any, Any]:
    """Makes an environment in Gymnasium's wrappers: one of ours where we have the id, else Gymnasium's."""
    return gymnasium.make(_ours(id), max_episode_steps, disable_env_checker, **kwargs)


@_like(gymnasium.make_vec)
def make_vec(
    id: str | EnvSpec,
    num_envs: int = 1,
    vectorization_mode: VectorizeMode | str | None = None,
    vector_kwargs: dict[str, Any] | None = None,
    wrappers: Sequence[Callable[[gymnasium.Env[Any, Any]], gymnasium.Wrapper[Any, Any, Any, Any]]] | None = None,
    **kwargs: Any,
) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    """Makes a vector of environments: one of ours where we have the id, else Gymnasium's."""
    return gymnasium.make_vec(_ours(id), num_envs, vectorization_mode, vector_kwargs, wrappers, **kwargs)


@_like(gymnasium.spec)
def spec(env_id: str) -> EnvSpec:
    """The spec of an id: of ours where we have it, else Gymnasium's."""
    found = _ours(env_id)
    return found if isinstance(found, EnvSpec) else gymnasium.spec(found)


@_like(gymnasium.pprint_registry)
def pprint_registry(print_registry: Any = registry, **kwargs: Any) -> str | None:
    """Prints the ids, ours among them."""
    return gymnasium.pprint_registry(print_registry, **kwargs)
