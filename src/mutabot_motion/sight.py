"""The contract of a way to look at what is recorded: a format, or a viewer."""

from __future__ import annotations

from typing import Protocol

from .shown import Shown


class Sight(Protocol):
    """One way to look at it.

    It is made before anything is read, and raises UsageError then if it cannot be done.
    """

    def show(self, shown: Shown) -> str:
        """Do it. Returns what there is now, in words. Raises UsageError where it fails."""
