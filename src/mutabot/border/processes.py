"""What processes below the tests tell: each has a file of its own, with one JSON object a line.

A file needs nobody who listens, and what is in it stays when its process dies. The test process reads the
files when a test ends, and the controller if the test process did not get that far. Times are those of
``time.monotonic``, which all processes share.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, get_args

from .codec import from_data
from .lines import MutatedCall, NotInstrumented, Problem, Remark, SiteSeen, TextsSeen

#: the folder of these files, in the home of the test process
FOLDER = "processes"
#: environment variable that names this folder; Python processes that find it look for what they are to do
VARIABLE = "MUTABOT_PROCESSES"
#: file in it with what wakes a process: see ``inside.processes.startup.sitecustomize``
WAKE = "wake"
#: file in it with the number of the running test in its first eight bytes; 0 before any
NOW = "now"
#: file in it with the tests' node ids, one a line as JSON, in the order of their numbers from 1
TESTS = "tests"
#: how the files of the processes end
SUFFIX = ".jsonl"


@dataclass(frozen=True, slots=True)
class Began:
    """A process has begun to tell.

    Attributes:
        pid, parent, group: its number, its parent's, and that of its process group.
        command: its command line.
        test: number of the test that was running.
        unable: why nothing in it can be seen; None if it can.
    """

    pid: int
    parent: int
    group: int
    command: tuple[str, ...]
    time: float
    test: int = 0
    unable: str | None = None


@dataclass(frozen=True, slots=True)
class Node:
    """A node of this name lives in the process."""

    name: str


@dataclass(frozen=True, slots=True)
class Called:
    """A call of an operation; the fields from ``site`` on are those of a trace."""

    test: int
    time: float
    site: int
    written: Any
    read: Any
    answer: Any = None


@dataclass(frozen=True, slots=True)
class RefusedCall:
    """The robot refused a call of the original: its site, and its number there in this process, from 1."""

    test: int
    site: int
    number: int


@dataclass(frozen=True, slots=True)
class Live:
    """A call of the original returned the robot's own memory: its site."""

    test: int
    site: int


@dataclass(frozen=True, slots=True)
class Did:
    """What the mutant did since the last time: counts are to be added up.

    Attributes:
        hits, acted, away, example, invalid, failure: as in ``TestEnd``.
        refused: how the robot refused a mutated call; None if it did not.
        is_final: whether this refusal decides about a test that fails, since it was told as data.
        parts: the mutants of which it is made that changed something.
    """

    test: int
    time: float
    hits: int = 0
    acted: int = 0
    away: Mapping[str, int] = field(default_factory=dict)
    example: tuple[Any, ...] | None = None
    invalid: bool = False
    failure: str | None = None
    refused: str | None = None
    is_final: bool = False
    parts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Places:
    """Places of the program text that were reached for the first time in a test."""

    test: int
    places: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Used:
    """What the process used of a test's budget by now: the last line counts."""

    test: int
    operations: int
    commands: int
    simulated: float | None = None


@dataclass(frozen=True, slots=True)
class Exceeded:
    """A limit was exceeded, in words."""

    test: int
    text: str


@dataclass(frozen=True, slots=True)
class Raised:
    """An exception that nobody caught ended the process, or one of its threads.

    Attributes:
        exception, text: its type as ``module:Name`` and what it says.
        is_refusal: whether it is the robot's refusal of a mutated call.
        failure: the simulator's failure, or None.
        in_thread: whether only a thread ended.
    """

    test: int
    time: float
    exception: str
    text: str
    is_refusal: bool = False
    failure: str | None = None
    in_thread: bool = False


@dataclass(frozen=True, slots=True)
class Found:
    """Targets of the vocabulary, and modules that it names, that the process has."""

    targets: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Signalled:
    """The process sends a signal to another, or to a group (negative); -1 and no number: to somebody."""

    pid: int
    number: int


@dataclass(frozen=True, slots=True)
class Ended:
    """The process ends in an orderly way."""

    time: float


Entry = (
    Began
    | Node
    | SiteSeen
    | Called
    | RefusedCall
    | Live
    | Did
    | MutatedCall
    | Places
    | TextsSeen
    | NotInstrumented
    | Problem
    | Remark
    | Used
    | Exceeded
    | Raised
    | Found
    | Signalled
    | Ended
)

_ENTRIES: dict[str, type[Any]] = {kind.__name__: kind for kind in get_args(Entry)}


def entry_of(line: bytes | str) -> Entry | None:
    """The entry in a line; None for one that was not written to its end, or is none."""
    try:
        data = json.loads(line)
        kind = _ENTRIES[data.pop("type")]
        entry: Entry = from_data(kind, data)
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None
    return entry


def tests_in(folder: Path) -> list[str]:
    """Node ids of the tests by their numbers; the empty one stands for before any."""
    try:
        text = (folder / TESTS).read_text(encoding="utf-8")
        return ["", *(str(json.loads(line)) for line in text.splitlines())]
    except (OSError, ValueError):
        return [""]


def _bytes_of(file: Path) -> bytes:
    try:
        return file.read_bytes() if file.is_file() else b""
    except OSError:  # somebody has deleted it, or nobody may read it
        return b""


def acted_in(home: Path) -> list[str]:
    """Tests in which a process below the tests says that the mutant changed something."""
    folder = home / FOLDER
    tests = tests_in(folder)
    found: dict[str, None] = {}
    for file in sorted(folder.glob(f"*{SUFFIX}")):
        for line in _bytes_of(file).splitlines():
            if not line.startswith((b'{"type":"Did"', b'{"type":"MutatedCall"')):
                continue
            match entry_of(line):
                case Did(acted=acted, test=test) if acted and 0 <= test < len(tests):
                    found[tests[test]] = None
                case MutatedCall(began=True, test=name):
                    found[name] = None
    return list(found)
