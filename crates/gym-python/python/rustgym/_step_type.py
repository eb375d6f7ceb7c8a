"""dm_env's types of time steps, which infos of the Control Suite have."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["StepType"]

try:
    from dm_env import StepType
except ImportError:

    class StepType(IntEnum):  # type: ignore[no-redef]
        """dm_env's, with its names and values."""

        FIRST = 0
        MID = 1
        LAST = 2
