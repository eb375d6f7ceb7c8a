"""Exceptions for actions and calls that Gymnasium's environments refuse, each in its own way."""

from __future__ import annotations

import gymnasium

__all__ = ["InvalidAction", "InvalidArgument", "ResetNeeded"]


class InvalidAction(gymnasium.error.InvalidAction, AssertionError, KeyError, IndexError, TypeError, ValueError):
    """An invalid action. Gymnasium's environments raise one of these classes."""

    __str__ = Exception.__str__


class InvalidArgument(ValueError, AssertionError, KeyError):
    """An invalid argument, option or state. Gymnasium's environments raise one of these classes."""

    __str__ = Exception.__str__


class ResetNeeded(gymnasium.error.ResetNeeded, AssertionError, AttributeError):
    """A step before the first reset. Gymnasium's environments raise one of these classes."""
