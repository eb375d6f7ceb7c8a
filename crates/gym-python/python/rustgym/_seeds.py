"""Resets of a vector with seeds that the user gives: each reset takes the next seed, also an automatic one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode

from rustgym.env import checked_seed

__all__ = ["Seeds"]


class Seeds:
    """Resets the environments of a vector whose Rust side does not reset automatically.

    Args:
        seeds: The seeds in the order of use. If a step resets several environments, they take seeds in the order of their
            indices.
        mode: When an environment whose episode has ended is reset.
    """

    def __init__(self, seeds: Iterable[int], mode: AutoresetMode) -> None:
        self._seeds = iter(seeds)
        self._count = 0
        self._mode = mode
        # the environments that the next step resets, and their seeds
        self._due: dict[int, str] = {}

    def take(self, indices: Iterable[int], n: int) -> list[str | None]:
        """A list of ``n`` elements: the next seeds for the environments ``indices``, ``None`` for the others."""
        seeds: list[str | None] = [None] * n
        for index in indices:
            try:
                seed = next(self._seeds)
            except StopIteration:
                raise gymnasium.error.Error(
                    f"the {self._count} seeds are used up: give as many as there are resets, or an iterator such as itertools.count()"
                ) from None
            seeds[index] = str(checked_seed(seed, f"Seed {self._count}"))
            self._count += 1
        return seeds

    def forget(self, indices: Iterable[int]) -> None:
        """Cancels due resets of environments that the user has reset."""
        for index in indices:
            self._due.pop(index, None)

    def step(
        self, native: Any, actions: Any, n: int, ongoing: dict[str, Any] | None
    ) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Takes a step, and resets environments as ``mode`` says. ``ongoing`` joins the infos if no episode ends."""
        observations, rewards, terminated, truncated, infos = native.step(actions, ongoing)
        if self._due:
            # the environments that are due took part in this step; the reset undoes that
            mask, seeds = self._mask(self._due, n), [self._due.get(index) for index in range(n)]
            fresh, fresh_infos = native.reset(None, seeds, None, mask.tolist())
            observations = _rows(fresh, observations, mask)
            rewards[mask], terminated[mask], truncated[mask] = 0.0, False, False
            infos = _merged(infos, fresh_infos, mask)
            self._due = {}
        ended = terminated | truncated
        if self._mode is AutoresetMode.DISABLED or not ended.any():
            return observations, rewards, terminated, truncated, infos
        indices = np.flatnonzero(ended)
        seeds = self.take(indices, n)
        fresh, fresh_infos = native.reset(None, seeds, None, ended.tolist())
        if self._mode is AutoresetMode.NEXT_STEP:
            # the native vector refuses a step before this reset; the next step resets again with the same seed
            self._due = {int(index): seeds[index] or "" for index in indices}
            return observations, rewards, terminated, truncated, infos
        last = np.full(n, None, dtype=object)
        for index in indices:
            last[index] = _row(observations, int(index))
        final_infos = _only(infos, ended)
        infos = _merged(infos, fresh_infos, ended)
        infos = {"final_obs": last, "_final_obs": ended.copy(), "final_info": final_infos, "_final_info": ended.copy(), **infos}
        return _rows(fresh, observations, ended), rewards, terminated, truncated, infos

    @staticmethod
    def _mask(indices: Iterable[int], n: int) -> npt.NDArray[np.bool_]:
        mask = np.zeros(n, np.bool_)
        mask[list(indices)] = True
        return mask


def _row(batch: Any, index: int) -> Any:
    if isinstance(batch, dict):
        return {key: _row(part, index) for key, part in batch.items()}
    if isinstance(batch, tuple):
        return tuple(_row(part, index) for part in batch)
    row = batch[index]
    return row.copy() if isinstance(row, np.ndarray) else row


def _rows(new: Any, old: Any, mask: npt.NDArray[np.bool_]) -> Any:
    """The rows of ``new`` where ``mask`` is true, else those of ``old``."""
    if isinstance(old, dict):
        return {key: _rows(new[key], part, mask) for key, part in old.items()}
    if isinstance(old, tuple):
        if len(old) == len(mask) and not isinstance(old[0], np.ndarray):  # a value for each environment
            return tuple(n if m else o for n, o, m in zip(new, old, mask, strict=True))
        return tuple(_rows(n, o, mask) for n, o in zip(new, old, strict=True))
    return np.where(mask.reshape(-1, *[1] * (old.ndim - 1)), new, old)


def _only(infos: dict[str, Any], mask: npt.NDArray[np.bool_]) -> dict[str, Any]:
    """The infos of the environments in ``mask``; zeros for the others."""
    kept: dict[str, Any] = {}
    for key, column in infos.items():
        if isinstance(column, dict):
            kept[key] = _only(column, mask)
        elif key.startswith("_") and key[1:] in infos:
            kept[key] = column & mask
        else:
            kept[key] = column.copy()
            kept[key][~mask] = None if column.dtype == object else 0
    return kept


def _merged(infos: dict[str, Any], fresh: dict[str, Any], mask: npt.NDArray[np.bool_]) -> dict[str, Any]:
    """The infos of a step; for the environments in ``mask``, those of a reset."""
    merged = _only(infos, ~mask)
    for key, column in fresh.items():
        if key not in merged:
            merged[key] = column
        elif isinstance(column, dict):
            merged[key] = _merged(infos[key], column, mask)
        else:
            merged[key][mask] = column[mask]
    empty = [key for key, column in merged.items() if f"_{key}" in merged and not np.any(merged[f"_{key}"])]
    for key in empty:
        del merged[key], merged[f"_{key}"]
    return merged
