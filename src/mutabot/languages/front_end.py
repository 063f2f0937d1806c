"""The contract of a language's front end: what mutabot must know of the language to have sites in it.

A site is a call at its exact place. Beside the running program somebody must say where the call stands that
is under way, and outside, without running anything, what is written there. Both is asked of the front end of
the file's language, and nothing else is.

A language is one file in this folder with its front end as ``FRONT_END``; it is found there. It runs beside
the robot program too, so it may import the standard library and ``mutabot.model`` only. ``python.py`` is the
one there is; a program in another language is run by an interpreter in Python, whose frames its front end
knows. Mutants of the program text are Python's alone, as the operators on it are.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import FrameType
from typing import NamedTuple, Protocol

from mutabot.model.mutant import Extent


class Position(NamedTuple):
    """Where a call stands in its file.

    Attributes:
        extent: from where to where; lines are 1-based, columns 0-based and in UTF-8 bytes.
        function: name of the function it stands in; the language says what one is called.
    """

    extent: Extent
    function: str


class Name(NamedTuple):
    """How a site's id calls it.

    Attributes:
        text: what is called, as written, on one line and not too long.
        occurrence: 1-based number among those with this text in this function.
    """

    text: str
    occurrence: int


class FrontEnd(Protocol):
    """A language that robot programs are written in."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """How its files end, such as ``.py``."""

    def names(self, source: str) -> Mapping[Extent, Name]:
        """Names of all that may be a site in a file.

        Raises SyntaxError or ValueError for a file that it cannot read.
        """

    def file_of(self, frame: FrameType) -> str | None:
        """The file of this language that a frame carries out; None if it is no frame of its own."""

    def position_of(self, frame: FrameType) -> Position:
        """Where the call stands that such a frame is making.

        Asked at every call of an operation; of Python once for each place.
        """
