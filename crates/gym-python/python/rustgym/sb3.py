"""Vectors with the interface of Stable-Baselines3's vectors.

    import rustgym.sb3
    from stable_baselines3 import PPO

    model = PPO("MlpPolicy", rustgym.sb3.VecEnv("LunarLander-v3", num_envs=16), seed=0).learn(1_000_000)

Needs stable-baselines3, which nothing else in rustgym does. Put ``VecMonitor`` around it to see returns in the log.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv as BaseVecEnv

from rustgym.vector_env import VectorEnv

__all__ = ["VecEnv"]

# what a vector calls what all of its environments have
_SHARED = {"action_space": "single_action_space", "observation_space": "single_observation_space"}


class VecEnv(BaseVecEnv):
    """A ``rustgym.VectorEnv`` as a vector of Stable-Baselines3.

    Args:
        env_id: An id of the Rust registry, as for ``rustgym.VectorEnv``.
        num_envs: The number of environments.
        kwargs: The other arguments of ``rustgym.VectorEnv``.

    ``seed`` before ``reset`` seeds environment ``i`` with ``seed + i``, like SB3's ``DummyVecEnv``, so that trainings are
    reproducible.
    """

    def __init__(self, env_id: str, num_envs: int = 1, **kwargs: Any) -> None:
        self.envs = VectorEnv(env_id, num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **kwargs)
        self.metadata = self.envs.metadata
        self._actions: Any = None
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    def reset(self) -> Any:
        """Starts episodes in all environments and returns their first observations."""
        seeds = self._seeds if any(seed is not None for seed in self._seeds) else None
        options = next((options for options in self._options if options), None)
        observations, infos = self.envs.reset(seed=seeds, options=options)
        self.reset_infos = self._rows(infos)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: Any) -> None:
        """Stores the actions for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Takes a step: observations, rewards (``float32``), dones (``bool``), and a list with an info for each environment."""
        observations, rewards, terminated, truncated, infos = self.envs.step(self._actions)
        dones = terminated | truncated
        rows = self._rows(infos)
        for i in np.flatnonzero(dones):
            rows[i]["terminal_observation"] = infos["final_obs"][i]
            rows[i]["TimeLimit.truncated"] = bool(truncated[i] and not terminated[i])
        return observations, rewards.astype(np.float32), dones, rows

    def _rows(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        """A list with the info of each environment. It belongs to the same episode as the environment's observation."""
        rows: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for key, column in infos.items():
            mask = infos.get(f"_{key}")
            if mask is not None and key not in ("final_obs", "final_info"):
                for i in np.flatnonzero(mask):
                    rows[i][key] = column[i]
        return rows

    def close(self) -> None:
        """Closes all environments."""
        self.envs.close()

    def get_images(self) -> Sequence[Any]:
        """The picture of each environment."""
        return list(self.envs.render() or [])

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of some environments."""
        shared = _SHARED.get(attr_name, attr_name)
        if shared in vars(self.envs):  # environments need not be separate for it
            return [getattr(self.envs, shared) for _ in self._get_indices(indices)]
        values = self.envs.get_attr(attr_name)
        return [values[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Sets an attribute of some environments, such as ``state``."""
        wanted = set(self._get_indices(indices))
        self.envs._with_each(lambda i, env: setattr(env, attr_name, value) if i in wanted else None)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method of some environments."""
        wanted = list(self._get_indices(indices))

        def ask(i: int, env: Any) -> Any:
            return getattr(env, method_name)(*method_args, **method_kwargs) if i in wanted else None

        results = self.envs._with_each(ask)
        return [results[i] for i in wanted]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Always false: environments have none of Gymnasium's wrappers."""
        return [False for _ in self._get_indices(indices)]
