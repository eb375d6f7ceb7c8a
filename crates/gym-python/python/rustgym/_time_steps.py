"""What shimmy's infos of the Control Suite have of dm_env's time steps, for vectors: ``timestep.discount``, ``timestep.step_type``."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

from rustgym import _native
from rustgym._specs import class_of
from rustgym._step_type import StepType

__all__ = ["TimeSteps"]

_DISCOUNT, _STEP_TYPE = "timestep.discount", "timestep.step_type"
_START = {_DISCOUNT: None, _STEP_TYPE: StepType.FIRST}


class TimeSteps:
    """Adds a vector's time steps to its infos.

    Args:
        native: The native vector.
        num_envs: How many environments there are.
        autoreset_mode: When an environment whose episode has ended is reset.
        max_episode_steps: The limit around each environment, which dm_env's time steps do not know of; ``None`` or -1 for none.
        env_id: The id of the environments.
        kwargs: Their arguments.
    """

    def __init__(
        self,
        native: _native.Vector,
        num_envs: int,
        autoreset_mode: AutoresetMode,
        max_episode_steps: int | None,
        env_id: str,
        kwargs: dict[str, Any],
    ) -> None:
        self._native, self._mode = native, autoreset_mode
        # makes columns of infos as Gymnasium's vectors do
        self._envs: gymnasium.vector.VectorEnv[Any, Any, Any] = gymnasium.vector.VectorEnv()
        self._envs.num_envs = num_envs
        # an environment has taken as many steps as both numbers say together
        self._elapsed = np.zeros(num_envs, np.int64)
        self._together = 0
        self._has_ended = np.zeros(num_envs, np.bool_)
        # the columns while no episode ends or starts; nobody can write to them, so each step hands them out
        types = np.array([StepType.MID] * num_envs, dtype=object)
        self._mid_columns = self._columns(np.ones(num_envs), types, np.ones(num_envs, np.bool_))
        for column in self._mid_columns.values():
            column.flags.writeable = False
        #: What the infos of a step have if no episode ends; ``None`` if one starts.
        self.ongoing: dict[str, Any] | None = self._mid_columns
        self._limit = -1
        if max_episode_steps is not None and max_episode_steps >= 0:
            env = class_of(env_id)(**kwargs)
            if max_episode_steps < np.round((env.arguments["time_limit"] or np.inf) / env.dt):
                self._limit = max_episode_steps

    def reset(self, infos: dict[str, Any], mask: list[bool] | None) -> None:
        """Adds to the infos of a reset of the environments with a true value in ``mask``."""
        started = np.flatnonzero(np.ones(self._envs.num_envs) if mask is None else mask)
        self._elapsed[started], self._has_ended[started] = -self._together, False
        for index in started.tolist():
            self._envs._add_info(infos, _START, index)

    def step(self, actions: Any) -> Any:
        """The vector's step, if nothing else is to be added to the native one."""
        result = self._native.step(actions, self.ongoing)
        self.add(*result[2:])
        return result

    def add(self, terminated: Any, truncated: Any, infos: dict[str, Any], ids: Any = None) -> None:
        """Adds to the infos of a step of the environments ``ids``; of all unless given."""
        if _DISCOUNT in infos:  # they have `ongoing`, as in most steps
            self._together += 1
            return
        envs, mode = self._envs, self._mode
        ended = terminated | truncated
        rows = np.arange(envs.num_envs) if ids is None else np.asarray(ids)
        due = self._has_ended[rows]
        self._elapsed[rows] += 1
        self._has_ended[rows] = ended
        self.ongoing = None if self._has_ended.any() else self._mid_columns
        discounts = np.where(terminated, 0.0, 1.0)
        is_last = terminated | truncated & (self._elapsed[rows] + self._together != self._limit)
        types = np.array([StepType.LAST if last else StepType.MID for last in is_last], dtype=object)
        starts = due if mode is AutoresetMode.NEXT_STEP else ended & (mode is AutoresetMode.SAME_STEP)
        self._elapsed[rows[starts]] = -self._together
        if starts.any() or ids is not None:
            infos.pop("final_info", None), infos.pop("_final_info", None)
        if mode is AutoresetMode.SAME_STEP:
            for row in np.flatnonzero(starts):
                info = {_DISCOUNT: float(discounts[row]), _STEP_TYPE: types[row]}
                envs._add_info(infos, {"final_info": info}, rows[row])
        types[starts] = StepType.FIRST
        infos.update(self._columns(*self._filled(rows, discounts, types, starts)))

    def _filled(self, rows: Any, discounts: Any, types: Any, starts: Any) -> tuple[Any, Any, Any]:
        """The columns of the environments ``rows`` as Gymnasium's vectors fill them: a start has no discount, which is ``None`` in a
        column that begins with one, and NaN in a column that begins with a number."""
        num_envs = self._envs.num_envs
        no_discount, unset = (None, None) if starts[:1].any() else (np.nan, 0.0)
        all_discounts = np.full(num_envs, unset)
        all_discounts[rows] = np.where(starts, no_discount, discounts)
        all_types, where = np.full(num_envs, None), np.zeros(num_envs, np.bool_)
        all_types[rows], where[rows] = types, True
        return all_discounts, all_types, where

    def _columns(self, discounts: Any, types: Any, where: Any) -> dict[str, Any]:
        return {_DISCOUNT: discounts, f"_{_DISCOUNT}": where, _STEP_TYPE: types, f"_{_STEP_TYPE}": where}
