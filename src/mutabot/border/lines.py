"""Report lines: what a worker process tells while it runs a job, one JSON object a line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

from mutabot.model.alternative import Sighting
from mutabot.model.site import Span

from .codec import from_data, to_data
from .test_end import TestEnd


@dataclass(frozen=True, slots=True)
class SiteSeen:
    """A site was reached for the first time in this session; traces refer to it by ``index``.

    ``direct`` is whether the call that stands there is that of the operation itself, rather than of something
    that leads to it; only the baseline finds out.
    """

    index: int
    span: Span
    operation: str
    pattern: str | None
    oracle: bool
    direct: bool = False


@dataclass(frozen=True, slots=True)
class TestStart:
    """A test begins: its fixtures are next."""

    __test__ = False

    test: str


@dataclass(frozen=True, slots=True)
class Watched:
    """The suite itself ends this process with exit code 1 if a test takes too long.

    Attributes:
        test: the test.
        until: from when on, by the clock of ``time.monotonic``, which all processes share.
        text: the limit, in words.
    """

    test: str
    until: float
    text: str


@dataclass(frozen=True, slots=True)
class Acted:
    """The mutant changed something for the first time in this test: proof that mutated code ran.

    ``test`` is empty for a mutant of the program text that did so before any test began.
    ``mutant`` is the branch that says so; None in a session that is one mutant altogether.
    """

    test: str
    mutant: str | None = None


@dataclass(frozen=True, slots=True)
class PlacesReached:
    """Places of the program text that a test reached; those before any test, if ``test`` is empty.

    ``elsewhere``: whether that was in processes below the tests.
    """

    test: str
    places: tuple[int, ...]
    elsewhere: bool = False


@dataclass(frozen=True, slots=True)
class CalledAtImport:
    """Operations of the program that were called before any test began; the trace is like that of a test."""

    trace: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class TextsSeen:
    """What a recording saw of the program text, over all tests.

    Attributes:
        imported: files that were imported, relative to the root.
        sightings: what was seen at each place.
    """

    imported: tuple[str, ...]
    sightings: tuple[Sighting, ...]


@dataclass(frozen=True, slots=True)
class NotInstrumented:
    """A file whose mutants cannot run, because it was imported without its alternatives."""

    file: str
    reason: str


@dataclass(frozen=True, slots=True)
class MutatedCall:
    """A mutated call begins or has ended: tells whether a process died in it."""

    test: str
    began: bool
    mutant: str | None = None


@dataclass(frozen=True, slots=True)
class BranchEnd:
    """A branch has finished its test.

    Attributes:
        mutant: id of the mutant it was.
        end: what the test ended like.
        sites: the sites that the trace refers to.
        shared: simulated seconds it inherited from the trunk, or None without a clock.
    """

    mutant: str
    end: TestEnd
    sites: tuple[SiteSeen, ...] = ()
    shared: float | None = None


@dataclass(frozen=True, slots=True)
class BranchDied:
    """A branch ended without saying how its test ended.

    Attributes:
        mutant: id of the mutant it was.
        test: the test it was in.
        exit_code: its exit code, negative for a signal.
        overdue: which wall-clock limit it exceeded, in words, or None.
        hindered, is_starved: as in ``Result``.
        where: where it was then, if that is known.
    """

    mutant: str
    test: str
    exit_code: int
    overdue: str | None = None
    where: str | None = None
    hindered: str | None = None
    is_starved: bool = False


@dataclass(frozen=True, slots=True)
class Unbranched:
    """A test in which it was not safe to fork: these mutants need a process of their own there."""

    test: str
    mutants: tuple[str, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Undiverged:
    """Mutants of the program text that were reached in a trunk's test and always had the original's value.

    The trunk itself has run this test for them.

    Attributes:
        test: the test, which is about to end.
        hits: evaluations of the mutant's place in it, by mutant id.
    """

    test: str
    hits: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class TokensHeld:
    """How many tokens a trunk and its branches hold: what the pool gets back if the trunk dies."""

    held: int


@dataclass(frozen=True, slots=True)
class Problem:
    """Something in the vocabulary does not fit the program.

    Attributes:
        source: where the vocabulary says so.
        key: the key below the source.
        text: what is wrong.
        name, known: the name that does not exist and those that do, where it is about a name.
    """

    source: str
    key: str
    text: str
    name: str | None = None
    known: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Remark:
    """Something about the vocabulary that the user should know; the program can be tested all the same.

    Attributes:
        source: where the vocabulary says so.
        key: the key below the source.
        text: what there is to say, and what to do about it.
    """

    source: str
    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.source} · {self.key}: {self.text}"


@dataclass(frozen=True, slots=True)
class Serving:
    """A fork server has collected its tests and waits for jobs; or it does not, for a ``reason``."""

    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Copied:
    """A fork server has forked a copy of itself, process ``pid``, for the job that came last."""

    pid: int


@dataclass(frozen=True, slots=True)
class CopyEnded:
    """A copy of a fork server has ended, with an exit code that is negative for a signal."""

    pid: int
    exit_code: int


@dataclass(frozen=True, slots=True)
class SessionEnd:
    """The session has ended in an orderly way.

    Attributes:
        exit_status: pytest's exit status.
        collected: node ids of the tests collected, in order.
        errors: texts of collection errors.
        not_private: why its files were not its own, though that was asked for; None if they were.
    """

    exit_status: int
    collected: tuple[str, ...] = ()
    errors: tuple[str, ...] = ()
    not_private: str | None = None


@dataclass(frozen=True, slots=True)
class Untrusted:
    """What a process reports cannot be relied on: said of it by whoever reads its pipe.

    Attributes:
        reason: in words.
    """

    reason: str


Line = (
    SiteSeen
    | TestStart
    | Watched
    | Acted
    | PlacesReached
    | CalledAtImport
    | TextsSeen
    | NotInstrumented
    | MutatedCall
    | TestEnd
    | BranchEnd
    | BranchDied
    | Unbranched
    | Undiverged
    | TokensHeld
    | Problem
    | Remark
    | Serving
    | Copied
    | CopyEnded
    | SessionEnd
    | Untrusted
)

#: the kinds of line by their names
LINES: dict[str, type[Any]] = {kind.__name__: kind for kind in get_args(Line)}


def line_to_data(line: Line) -> dict[str, Any]:
    """JSON-like data of a report line, with its type."""
    data: dict[str, Any] = to_data(line)
    return {"type": type(line).__name__, **data}


def line_from_data(data: dict[str, Any]) -> Line:
    """The report line in such data.

    Raises KeyError for a type that is not known, TypeError or ValueError for data that does not fit it.
    """
    if not isinstance(data, dict):
        raise TypeError(f"a report line is an object, not {type(data).__name__}")
    kind = LINES[data["type"]]
    line: Line = from_data(kind, {key: value for key, value in data.items() if key != "type"})
    return line
