"""Whose doing an exception is: that of a mutant's own code, or of what the program and its robot do."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from traceback import walk_tb
from types import FrameType

from mutabot.runtime.interception.trace import Locator

#: modules that stand in for the robot in tests
_MOCKS = "unittest.mock"


@dataclass(frozen=True, slots=True)
class Origin:
    """Tells exceptions of a mutant's own code from all others.

    Attributes:
        module: the module that the mutant's code stands in; with it, all of its package.
        robots: the modules of the operations that are mutated.
        locator: knows the files of the program and its tests.
    """

    module: str
    robots: Collection[str]
    locator: Locator

    def is_own(self, error: BaseException) -> bool:
        """Whether the mutant's code raised it, be it in a library that it called.

        The frame nearest to the raise decides that is the mutant's, the robot's, the program's or the tests'.
        """
        for frame, _ in reversed(list(walk_tb(error.__traceback__))):
            if (is_own := self._is_own(frame)) is not None:
                return is_own
        return False

    def _is_own(self, frame: FrameType) -> bool | None:
        """Whose a frame is; None for those that say nothing, such as libraries'."""
        name = str(frame.f_globals.get("__name__", ""))
        if name in self.robots:
            return False
        if _is_within(name, self.module.rpartition(".")[0] or self.module):
            return True
        if name.startswith(_MOCKS) or any(_is_within(name, one.partition(".")[0]) for one in self.robots):
            return False
        file = frame.f_code.co_filename
        relative = self.locator.relative(file)
        is_users = not (relative.startswith("..") or "site-packages" in relative or file.startswith("<"))
        return False if is_users or self.locator.role(file) is not None else None


def _is_within(name: str, package: str) -> bool:
    return name == package or name.startswith(f"{package}.")
