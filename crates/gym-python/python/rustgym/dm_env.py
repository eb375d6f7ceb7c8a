"""The environments with the interface of DeepMind's ``dm_env``.

    import rustgym.dm_env

    env = rustgym.dm_env.make("CartPole-v1", seed=0)
    timestep = env.reset()
    while not timestep.last():
        timestep = env.step(0)

Needs dm_env, which nothing else in rustgym does.
"""

from __future__ import annotations

from typing import Any

import dm_env
import numpy as np
from dm_env import specs
from gymnasium import spaces

from rustgym.env import entropy
from rustgym.registration import make as make_env

__all__ = ["Environment", "make", "spec_of"]


def spec_of(space: spaces.Space[Any], name: str = "") -> Any:
    """The spec of a space's elements: a ``dict`` for a ``Dict``, a ``tuple`` for a ``Tuple``.

    Raises:
        TypeError: for a space that has no spec in dm_env.
    """
    match space:
        case spaces.Box():
            return specs.BoundedArray(space.shape, space.dtype, space.low, space.high, name)
        case spaces.Discrete() if space.start == 0:
            return specs.DiscreteArray(int(space.n), space.dtype, name)
        case spaces.Discrete():
            return specs.BoundedArray((), space.dtype, space.start, space.start + space.n - 1, name)
        case spaces.MultiDiscrete():
            return specs.BoundedArray(space.shape, space.dtype, space.start, space.start + space.nvec - 1, name)
        case spaces.MultiBinary():
            return specs.BoundedArray(space.shape, space.dtype, 0, 1, name)
        case spaces.Text():
            return specs.StringArray((), name=name)
        case spaces.Dict():
            return {key: spec_of(member, str(key)) for key, member in space.spaces.items()}
        case spaces.Tuple():
            return tuple(spec_of(member, f"{name}{i}") for i, member in enumerate(space.spaces))
        case _:
            raise TypeError(f"dm_env has no spec for {space}")


def _element(space: spaces.Space[Any], value: Any) -> Any:
    """An observation in the structure of its spec."""
    if isinstance(space, spaces.Dict):
        return {key: _element(member, value[key]) for key, member in space.spaces.items()}
    if isinstance(space, spaces.Tuple):
        return tuple(_element(member, part) for member, part in zip(space.spaces, value, strict=True))
    return value if isinstance(space, spaces.Text) else np.asarray(value, space.dtype)


class Environment(dm_env.Environment):
    """A Gymnasium environment as one of ``dm_env``.

    A time step has discount 0 if the episode terminated, and 1 if it was truncated, for instance by a time limit. The step
    after the last of an episode starts the next episode, and ignores its action.

    Args:
        env: The environment, with the wrappers of ``rustgym.make``.
        seed: The seed of the first episode; later episodes continue its random numbers. By default the operating system seeds
            it.
    """

    def __init__(self, env: Any, seed: int | None = None) -> None:
        self.env = env
        #: The info of the last reset or step.
        self.info: dict[str, Any] = {}
        self._seed = entropy() if seed is None else seed
        self._is_first = self._is_due = True

    def reset(self) -> dm_env.TimeStep:
        """Starts an episode and returns its first time step."""
        observation, self.info = self.env.reset(seed=self._seed if self._is_first else None)
        self._is_first = self._is_due = False
        return dm_env.restart(self._seen(observation))

    def step(self, action: Any) -> dm_env.TimeStep:
        """Takes a step, or starts an episode if the last has ended."""
        if self._is_due:
            return self.reset()
        observation, reward, terminated, truncated, self.info = self.env.step(action)
        self._is_due = terminated or truncated
        reward, observation = float(reward), self._seen(observation)
        if terminated:
            return dm_env.termination(reward, observation)
        if truncated:
            return dm_env.truncation(reward, observation)
        return dm_env.transition(reward, observation)

    def _seen(self, observation: Any) -> Any:
        return _element(self.env.observation_space, observation)

    def observation_spec(self) -> Any:
        """The form of observations."""
        return spec_of(self.env.observation_space, "observation")

    def action_spec(self) -> Any:
        """The form of actions."""
        return spec_of(self.env.action_space, "action")

    def reward_spec(self) -> Any:
        """The form of rewards."""
        return specs.Array((), np.float64, "reward")

    def close(self) -> None:
        """Closes the window, if there is one."""
        self.env.close()


def make(env_id: str, seed: int | None = None, **kwargs: Any) -> Environment:
    """Makes the environment of an id.

    Args:
        env_id: As of ``rustgym.make``.
        seed: As of ``Environment``.
        kwargs: The other arguments of ``rustgym.make``.
    """
    return Environment(make_env(env_id, **kwargs), seed)
