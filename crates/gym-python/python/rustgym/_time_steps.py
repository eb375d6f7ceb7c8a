"""What shimmy's infos of the Control Suite have of dm_env's time steps, for vectors: ``timestep.discount``, ``timestep.step_type``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode

from rustgym._specs import class_of
from rustgym._step_type import StepType

if TYPE_CHECKING:
    from rustgym.vector_env import VectorEnv

__all__ = ["TimeSteps"]

_START = {"timestep.discount": None, "timestep.step_type": StepType.FIRST}


class TimeSteps:
    """Adds a vector's time steps to its infos.

    Args:
        num_envs: How many environments there are.
        max_episode_steps: The limit around each environment, which dm_env's time steps do not know of; ``None`` or -1 for none.
        env_id: The id of the environments.
        kwargs: Their arguments.
    """

    def __init__(self, num_envs: int, max_episode_steps: int | None, env_id: str, kwargs: dict[str, Any]) -> None:
        # an environment has taken as many steps as both numbers say together
        self._elapsed = np.zeros(num_envs, np.int64)
        self._together = 0
        self._has_ended = np.zeros(num_envs, np.bool_)
        self._is_due = False
        # the columns while no episode ends or starts; nobody can write to them, so each step hands them out
        types = np.array([StepType.MID] * num_envs, dtype=object)
        self._ongoing = self._columns(np.ones(num_envs), types, np.ones(num_envs, np.bool_))
        for column in self._ongoing.values():
            column.flags.writeable = False
        self._limit = -1
        if max_episode_steps is not None and max_episode_steps >= 0:
            env = class_of(env_id)(**kwargs)
            if max_episode_steps < round((env.arguments["time_limit"] or np.inf) / env.dt):
                self._limit = max_episode_steps

    def reset(self, envs: VectorEnv, infos: dict[str, Any], mask: list[bool] | None) -> None:
        """Adds to the infos of a reset of the environments with a true value in ``mask``."""
        started = np.flatnonzero(np.ones(envs.num_envs) if mask is None else mask)
        self._elapsed[started], self._has_ended[started] = -self._together, False
        for index in started:
            envs._add_info(infos, _START, index)

    def step(self, envs: VectorEnv, terminated: Any, truncated: Any, infos: dict[str, Any], ids: Any = None) -> None:
        """Adds to the infos of a step of the environments ``ids``; of all unless given."""
        ended = terminated | truncated
        # in most steps no episode ends or starts: those take the shortest way
        if ids is None and not self._is_due and not np.count_nonzero(ended):
            self._together += 1
            infos.update(self._ongoing)
            return
        rows = np.arange(envs.num_envs) if ids is None else np.asarray(ids)
        mode, due = envs.autoreset_mode, self._has_ended[rows]
        self._elapsed[rows] += 1
        self._has_ended[rows] = ended
        self._is_due = bool(self._has_ended.any())
        discounts = np.where(terminated, 0.0, 1.0)
        is_last = terminated | truncated & (self._elapsed[rows] + self._together != self._limit)
        types = np.array([StepType.LAST if last else StepType.MID for last in is_last], dtype=object)
        starts = due if mode is AutoresetMode.NEXT_STEP else ended & (mode is AutoresetMode.SAME_STEP)
        self._elapsed[rows[starts]] = -self._together
        if ids is None and not starts.any():
            infos.update(self._columns(discounts, types, np.ones(envs.num_envs, np.bool_)))
            return
        infos.pop("final_info", None), infos.pop("_final_info", None)
        for row, index in enumerate(rows):
            info = {"timestep.discount": float(discounts[row]), "timestep.step_type": types[row]}
            if starts[row] and mode is AutoresetMode.SAME_STEP:
                envs._add_info(infos, {"final_info": info}, index)
            envs._add_info(infos, _START if starts[row] else info, index)

    def _columns(self, discounts: Any, types: Any, where: Any) -> dict[str, Any]:
        discount, step_type = "timestep.discount", "timestep.step_type"
        return {discount: discounts, f"_{discount}": where, step_type: types, f"_{step_type}": where}
