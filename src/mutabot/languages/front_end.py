"""The contract of a language's front end.

A site is a call at its exact place. A front end finds where the running call stands, and, without running
anything, what is written there.

Python's is here; a package brings others under ``languages`` of its ``Extension``. An interpreter in Python
runs a program in another language, and its front end knows the interpreter's frames. A front end works beside
the robot program too: what it imports is imported there.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import FrameType
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from mutabot.model.mutant import Extent


class FrontEnd(Protocol):
    """A language that robot programs are written in.

    It may say what reports mark in its files, as ``highlighting``: an ECMAScript regular expression of three
    groups, texts, comments and words of the language, and its flags.

    It may say what its files consist of, as ``units``: a function of a file's content that returns
    ``TextUnit`` by name. What runs such a file then raises an audit event ``mutabot.executed`` for each unit
    that it begins, with the file's absolute path and the unit's number.
    """

    @property
    def suffixes(self) -> tuple[str, ...]:
        """How its files end, such as ``.py``, in lower case; capital letters in a file's name are equal."""

    def text_of(self, content: bytes) -> str:
        """Return the text of a file, decoded as the language requires.

        Raises SyntaxError or ValueError for a file that it cannot read.
        """

    def names(self, source: str) -> Mapping[Extent, tuple[str, int]]:
        """Return names of all possible sites in a file: a text, and its occurrence.

        A site's id has both. The text is what is called, as written, on one line and not too long; the
        occurrence is the 1-based number among those with this text in this function. Extents are those of
        ``position_of``.

        Raises SyntaxError or ValueError for a file that it cannot read.
        """

    def file_of(self, frame: FrameType) -> str | None:
        """Return the file of this language that a frame executes; None if the frame executes none."""

    def position_of(self, frame: FrameType) -> tuple[Extent, str]:
        """Return the position of the call that such a frame is making: its extent, and its function's name.

        An extent is the first line (1-based), first column, last line and last column (0-based, in UTF-8
        bytes). The language says what a function is called.

        Asked at every call of an operation; of Python once for each place.
        """
