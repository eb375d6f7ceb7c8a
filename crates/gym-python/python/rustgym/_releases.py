"""Releases of MuJoCo: whose numbers an environment has."""

from __future__ import annotations

from functools import cache

from gymnasium import logger


def is_of(installed: str, versions: list[str]) -> bool:
    """Whether ``versions`` has the installed version, in full or by its first two numbers."""
    return installed in versions or ".".join(installed.split(".")[:2]) in versions


@cache
def tell_other(own: str, installed: str, name: str | None) -> None:
    """Logs once that Gymnasium's numbers differ, because it computes with another version of MuJoCo."""
    hint = f'make it with mujoco="{name}" for these' if name else "whose numbers rustgym does not repeat"
    logger.warn(
        f"the environment has the numbers of MuJoCo {own}, and Gymnasium has those of the installed mujoco {installed}: {hint}"
    )
