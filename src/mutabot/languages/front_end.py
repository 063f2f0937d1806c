"""The contract of a language's front end, and the front ends there are.

A site is a call at its exact place. A front end tells where the running call stands, and, without running
anything, what is written there.

A language is one file in this folder with its front end as ``FRONT_END``. It runs beside the robot program
too, so it may import the standard library and ``mutabot.model`` only. An interpreter in Python runs a program
in another language; its front end knows the interpreter's frames. Only Python has mutants of its text.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import import_module
from types import FrameType
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from pathlib import Path

    from mutabot.model.mutant import Extent


class SourcePosition(NamedTuple):
    """Where a call stands in its file.

    Attributes:
        extent: from where to where; lines are 1-based, columns 0-based and in UTF-8 bytes.
        function: name of the function it stands in; the language says what one is called.
    """

    extent: Extent
    function: str


class SiteName(NamedTuple):
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

    def names(self, source: str) -> Mapping[Extent, SiteName]:
        """Names of all that may be a site in a file.

        Raises SyntaxError or ValueError for a file that it cannot read.
        """

    def file_of(self, frame: FrameType) -> str | None:
        """The file of this language that a frame carries out; None if it is no frame of its own."""

    def position_of(self, frame: FrameType) -> SourcePosition:
        """Where the call stands that such a frame is making.

        Asked at every call of an operation; of Python once for each place.
        """


@cache
def front_ends() -> tuple[FrontEnd, ...]:
    """All of them; Python is the last, since the frames of an interpreter are Python's as well."""
    files = os.listdir(os.path.dirname(__file__))
    names = {file[:-3] for file in files if file.endswith(".py")} - {"__init__", "front_end", "python"}
    return tuple(import_module(f"{__package__}.{name}").FRONT_END for name in (*sorted(names), "python"))


def front_end_of(file: str) -> FrontEnd:
    """That of a file's language, by how the file ends; files of no known language are taken for Python."""
    return next((one for one in front_ends() if file.endswith(one.suffixes)), front_ends()[-1])


def program_files(root: Path, program: Iterable[str]) -> list[str]:
    """The program's files among the configured files and folders, relative to ``root``, each once."""
    suffixes = tuple(suffix for one in front_ends() for suffix in one.suffixes)
    files: dict[str, None] = {}
    for name in program:
        path = root / name
        found = (
            [file for file in path.rglob("*") if file.name.endswith(suffixes)] if path.is_dir() else [path]
        )
        files |= dict.fromkeys(file.relative_to(root).as_posix() for file in sorted(found))
    return list(files)
