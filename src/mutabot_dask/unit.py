"""What goes to a worker and comes back, as JSON in bytes: a unit of work, and its answer, which is checked.

Workers may be broken, of another version, or hostile: before anything is made of data that they sent it is
looked at whether these are what they should be. What does not fit is told in words that name the place. What
a worker says of its own unit is believed: nobody else saw it. It can say nothing of other mutants or other
tests, name no file outside the project, and nothing that would end the campaign.
"""

from __future__ import annotations

import json
import math
import os
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, is_dataclass, replace
from functools import cache
from pathlib import PurePosixPath
from typing import Any, TypeVar, get_type_hints

from mutabot.evidence.recording import bytes_of, from_bytes
from mutabot.execution.task import Result, Task
from mutabot.model.codec import from_data, to_data
from mutabot.model.events import (
    EVENTS,
    Acted,
    Event,
    ForkDied,
    ForkEnded,
    ForkSessionEnd,
    ForkTestEnd,
    PlacesReached,
    Serving,
    SiteSeen,
    TestControls,
    TestEnd,
    TestStart,
    Undiverged,
    Unforked,
    Watched,
    event_to_data,
)
from mutabot.model.job import Job

#: bytes of an answer, levels of lists in it, and the size of counts: none that makes sense comes near
MOST_BYTES, _DEEPEST, _MOST = 64 << 20, 64, 10**15
#: integers in the user's own data; greater ones are no fractions that could be compared
_GREATEST = 2**1023
#: fields that are measured by us, and finite
_MEASURED = {"wall", "cpu"}
#: characters of a message
_SHOWN = 200

T = TypeVar("T")


class Misfit(ValueError):  # noqa: N818  # it is a finding
    """Data that are not what they should be."""


def read(data: bytes) -> Any:
    """What stands in bytes of JSON, with texts that can be stored. Raises Misfit."""
    if len(data) > MOST_BYTES:
        raise Misfit(f"{len(data)} bytes, more than {MOST_BYTES}")
    try:
        return _plain(json.loads(data.decode("utf-8")), 0)
    except RecursionError:
        raise Misfit(f"lists deeper than {_DEEPEST} levels") from None
    except UnicodeDecodeError:
        raise Misfit("no text in UTF-8") from None
    except Misfit:
        raise
    except ValueError as error:
        raise Misfit(f"no JSON ({error})"[:_SHOWN]) from None


def checked(kind: type[T], data: Any) -> T:
    """The value of a type in such data. Raises Misfit."""
    try:
        found = from_data(kind, data)
        _check_numbers(found)
    except (TypeError, ValueError, KeyError, OverflowError) as error:
        text = str(error) if isinstance(error, Misfit) else f"{type(error).__name__}: {error}"
        raise Misfit(text[:_SHOWN]) from None
    return found


def _plain(value: Any, depth: int) -> Any:
    """A value with storable texts: of characters that come in halves only the whole ones."""
    if depth > _DEEPEST:
        raise Misfit(f"lists deeper than {_DEEPEST} levels")
    if isinstance(value, str):
        return value if value.isascii() else value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, list):
        return [_plain(item, depth + 1) for item in value]
    if isinstance(value, dict):
        return {_plain(key, depth): _plain(item, depth + 1) for key, item in value.items()}
    if isinstance(value, int) and abs(value) >= _GREATEST:
        raise Misfit("a number of more than 300 digits")
    return value


def _check_numbers(value: Any) -> None:
    """Raise Misfit for counts and times that are none; the user's own data may hold any number."""
    kind: Any = type(value)
    for name, is_own in _fields(kind).items():
        item = getattr(value, name)
        for one in item if isinstance(item, tuple) else (item,):
            if is_dataclass(one):
                _check_numbers(one)
        if is_own and any(abs(number) > _MOST for number in _integers(item)):
            raise Misfit(f"{name}: {item!r} is no count")
        if name in _MEASURED and not 0 <= item < math.inf:
            raise Misfit(f"{name}: {item} is no time")


def _integers(item: Any) -> Iterator[int]:
    if isinstance(item, int):
        yield item
    elif isinstance(item, Mapping | tuple):
        for one in item.values() if isinstance(item, Mapping) else item:
            yield from _integers(one)


@cache
def _fields(kind: Any) -> dict[str, bool]:
    """The fields of a dataclass, and whether each is mutabot's own: then its type says all."""
    return {name: "Any" not in str(hint) for name, hint in get_type_hints(kind).items()}


@dataclass(frozen=True, slots=True)
class Ground:
    """What all units of a campaign stand on.

    Attributes:
        digest: of the bundle, which is its name.
        root: the project's folder on the controller's machine.
        inner: the project's folder in the bundle.
        arguments: the project's pytest arguments.
        environment: variables that the controller decides; None for those that are not to be set.
        paths: folders of the bundle that modules come from.
    """

    digest: str
    root: str
    inner: str
    arguments: tuple[str, ...]
    environment: Mapping[str, str | None]
    paths: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WorkUnit:
    """One task, on its ground. The key of the task stays with the controller.

    ``ticket`` is what the answer must bear: who was not given the unit does not know it.
    """

    ground: Ground
    task: Task
    ticket: str = ""

    def data(self) -> bytes:
        """It as bytes."""
        return _bytes(replace(self, task=replace(self.task, key=None)))

    @classmethod
    def of(cls, data: bytes) -> WorkUnit:
        """The unit in such bytes."""
        return from_data(cls, json.loads(data))


@dataclass(frozen=True, slots=True)
class UnitAnswer:
    """What became of a unit.

    Attributes:
        lines: what its process reported.
        exit_code, overdue, wall, log: as in ``Result``.
        fault: why it says nothing about the mutant, if it does not: the fault of the worker or its machine.
        is_unfit: whether that worker is of no use to the campaign any more.
        lost: as in ``Result``.
        ticket: of the unit.
    """

    lines: tuple[Any, ...] = ()
    exit_code: int = 0
    overdue: str | None = None
    wall: float = 0.0
    log: str = ""
    fault: str | None = None
    is_unfit: bool = False
    lost: str | None = None
    ticket: str = ""

    @classmethod
    def of_result(cls, lines: Iterable[Event], result: Result, fault: str | None = None) -> UnitAnswer:
        """The answer with what a worker process told and came to."""
        return cls(
            tuple(map(event_to_data, lines)), result.exit_code, result.overdue,
            result.wall, result.log, fault,
        )  # fmt: skip

    def data(self, here: str, there: str) -> bytes:
        """It as bytes, in which the folder ``here`` is called as the controller calls it, ``there``."""
        return _bytes(self).replace(_in_json(here), _in_json(there))

    @classmethod
    def of(cls, data: bytes, unit: WorkUnit) -> tuple[UnitAnswer, list[Event]]:
        """The answer in such bytes, and its events. Raises Misfit if it is none to this unit."""
        answer = checked(cls, read(data))
        if answer.ticket != unit.ticket:
            raise Misfit("it is the answer to something else")
        lines = [_line(index, line) for index, line in enumerate(answer.lines)]
        check_fit(lines, unit.task.job)
        return answer, lines

    def result(self, task: Task, lines: Iterable[Event]) -> Result:
        """The result of a task of which this is the answer."""
        found = Result(task)
        for line in lines:
            found.take(line)
        found.exit_code, found.overdue = self.exit_code, self.overdue
        found.wall, found.log, found.lost = self.wall, self.log, self.lost
        return found


@dataclass(frozen=True, slots=True)
class Introduction:
    """What a worker says of itself.

    Attributes:
        versions: what it runs with, as keys of outcomes have it.
        has: whether it has the bundle.
    """

    versions: Mapping[str, str] = field(default_factory=dict)
    has: bool = False

    def data(self) -> bytes:
        """It as bytes."""
        return _bytes(self)

    @classmethod
    def of(cls, data: bytes) -> Introduction:
        """The introduction in such bytes. Raises Misfit."""
        return checked(cls, read(data))


def _line(index: int, data: Any) -> Event:
    kind = EVENTS.get(str(data.get("type"))) if isinstance(data, dict) else None
    if kind is None:
        raise Misfit(f".lines[{index}] is no report line")
    try:
        line: Event = checked(kind, {name: value for name, value in data.items() if name != "type"})
    except Misfit as error:
        raise Misfit(f".lines[{index}] ({kind.__name__}): {error}") from None
    return line


def _bytes(value: Any) -> bytes:
    return json.dumps(to_data(value), separators=(",", ":")).encode()


def _in_json(path: str) -> bytes:
    return json.dumps(os.fspath(path))[1:-1].encode()


_OUTCOMES = {"passed", "failed", "skipped", "xfailed", "xpassed"}
#: what only fork servers say
_NEVER = (Serving, ForkEnded)
_FORKS = (ForkTestEnd, ForkSessionEnd, ForkDied, Unforked, Undiverged)
#: bytes of a recording, which comes packed
_UNPACKED = 256 << 20


def check_fit(lines: Iterable[Event], job: Job) -> None:
    """Raises Misfit for lines that this job cannot have made."""
    forking = job.forking
    mutants = {one.id for one in forking.mutants} if forking is not None else set()
    sites: set[int] = set()
    for line in lines:
        if isinstance(line, _NEVER) or (forking is None and isinstance(line, _FORKS)):
            raise Misfit(f"this unit has no {type(line).__name__}")
        for mutant in _mutants(line):
            is_test_control = isinstance(line, ForkTestEnd) and line.is_test_control
            if mutant not in mutants and not is_test_control:
                raise Misfit(f"{mutant[:100]!r} is no mutant of this unit")
        makes_tests = job.mutant is not None or isinstance(line, ForkTestEnd | ForkDied)
        for test in _tests(line):
            if job.tests is not None and test not in job.tests and not makes_tests:
                raise Misfit(f"{test[:100]!r} is no test of this unit")
        for seen in _sites(line):
            _check_file(seen.span.file)
        if isinstance(line, SiteSeen):
            sites.add(line.index)
        elif isinstance(line, TestEnd):
            _check_end(line, sites)
        elif isinstance(line, ForkTestEnd):
            _check_end(line.end, {seen.index for seen in line.sites})


def _mutants(line: Event) -> Iterator[str]:
    match line:
        case ForkTestEnd() | ForkDied():
            yield line.mutant
        case Unforked() | ForkSessionEnd():
            yield from line.mutants
        case Undiverged():
            yield from line.hits


def _tests(line: Event) -> Iterator[str]:
    match line:
        case TestEnd() | TestStart() | TestControls() | Watched() | ForkDied() | Unforked() | Undiverged():
            yield line.test
        case ForkTestEnd():
            yield line.end.test
        case Acted() | PlacesReached() if line.test:  # empty before any test
            yield line.test


def _sites(line: Event) -> Iterator[SiteSeen]:
    match line:
        case SiteSeen():
            yield line
        case ForkTestEnd():
            yield from line.sites


def _check_file(name: str) -> None:
    """Files of the project are read to name the places in them."""
    if PurePosixPath(name).is_absolute() or ".." in PurePosixPath(name).parts or "\0" in name:
        raise Misfit(f"{name[:100]!r} is no file of the project")


def _check_end(end: TestEnd, sites: set[int]) -> None:
    """What a test ended like, as far as its fields are of no fixed type."""
    if end.outcome not in _OUTCOMES:
        raise Misfit(f"{end.outcome[:100]!r} is no outcome of a test")
    if end.example is not None and len(end.example) != 2:
        raise Misfit("an example is a pair")
    if not 0 <= end.prepared <= len(end.returned):
        raise Misfit("more was prepared than was returned")
    for row in end.trace:
        if not isinstance(row, list) or len(row) != 4 or type(row[0]) is not int or row[0] not in sites:
            raise Misfit("a call in a trace is none that was seen")
    for row in end.moments:
        if not (isinstance(row, list) and len(row) == 3 and type(row[0]) is int and isinstance(row[1], dict)):
            raise Misfit("a moment is none of a test")
    for row in end.returned:
        if not (isinstance(row, list) and len(row) == 2 and isinstance(row[0], str) and _is_returned(row[1])):
            raise Misfit("what a function returned is no value")
    if end.recording is not None:
        _check_recording(end.recording)


def _check_recording(text: str) -> None:
    try:
        packed = zlib.decompressobj()
        packed.decompress(bytes_of(text), _UNPACKED)
        if not packed.unconsumed_tail:
            from_bytes(bytes_of(text))
            return
        why = f"more than {_UNPACKED} bytes"
    except Exception as error:  # whatever is in it
        why = type(error).__name__
    raise Misfit(f"a recording that cannot be read ({why})")


def _is_returned(value: object) -> bool:
    if isinstance(value, dict):
        return isinstance(value.get("raised"), str)
    return isinstance(value, list) and len(value) == 1
