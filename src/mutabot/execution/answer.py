"""The result of a task on another machine as bytes, and the validation of such bytes.

That machine may be broken, of another version, or hostile, so what it sends is checked before it is used.
What it says of its own task is believed, since no other machine has seen that. It can say nothing of other
mutants or other tests, name no file outside the project, and say nothing that would end the campaign.
"""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, is_dataclass
from functools import cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, get_type_hints

from mutabot.evidence.recording import bytes_of, from_bytes
from mutabot.execution.task import Result, Task
from mutabot.frozen import frozen
from mutabot.model import events
from mutabot.model.codec import MOST_DEPTH, from_data, is_too_deep, to_data
from mutabot.model.events import Event, event_from_data, event_to_data

if TYPE_CHECKING:
    from mutabot.execution.task import Executor
    from mutabot.model.job import Job

#: bytes of an answer, and the size of counts: none that makes sense comes near
MOST_BYTES, _MOST = 64 << 20, 10**15
#: integers in the user's own data; greater ones are no fractions that could be compared
_GREATEST = 2**1023
#: fields that are measured by us, and finite
_MEASURED = {"wall", "cpu"}
#: characters of a message, and of a name in it
_SHOWN, _SHOWN_NAME = 200, 100
_OUTCOMES = {"passed", "failed", "skipped", "xfailed", "xpassed"}
#: what only fork servers and processes that cannot be read say, and what only fork parents say
_NEVER = (events.Serving, events.ForkEnded)
_FORKS = (
    events.ForkTestEnd, events.ForkSessionEnd, events.ForkDied, events.Unforked, events.Undiverged,
)  # fmt: skip
#: bytes of a recording, which comes packed
_UNPACKED = 256 << 20


@frozen
class Ending:
    """How the process of a task ended; the fields are as in ``Result``."""

    exit_code: int
    overdue: str | None
    wall: float
    log: str


@dataclass(frozen=True, slots=True)
class Answer:
    """The events of a task that has run on another machine, and how its process ended.

    Attributes:
        events: what its process reported, in that order.
        result: what became of it.
    """

    events: list[Event]
    result: Result

    @classmethod
    def by(cls, executor: Executor, task: Task) -> Answer:
        """Run a task. Raises OSError or JournalError where this machine cannot run it."""
        found: list[Event] = []
        for event in executor.events([task]):
            if isinstance(event, Result):
                return cls(found, event)
            found.append(event[1])
        raise OSError("a task ended without a result")

    def to_bytes(self, root: str) -> bytes:
        """Return the answer as lines of JSON, the first for the result and one for each event.

        ``root``: what the project's folder is called where the answer goes.
        """
        result = self.result
        ending = to_data(Ending(result.exit_code, result.overdue, result.wall, result.log))
        data = (ending, *map(event_to_data, self.events))
        text = "\n".join(json.dumps(line, separators=(",", ":")) for line in data)
        here, there = (json.dumps(path)[1:-1] for path in (result.task.job.root, root))
        return text.replace(here, there).encode()

    @classmethod
    def of(cls, data: bytes, task: Task) -> Answer:
        """Read an answer from bytes. Raises ValueError, with the position, if it is not for this task."""
        if len(data) > MOST_BYTES:
            raise ValueError(f"{len(data)} bytes, more than {MOST_BYTES}")
        first, *lines = data.split(b"\n")
        ending = _decoded(first, "ending", lambda found: from_data(Ending, found))
        found = [_decoded(line, f"events[{index}]", event_from_data) for index, line in enumerate(lines)]
        check_fit(found, task.job)
        result = Result(task)
        for event in found:
            result.take(event)
        result.exit_code, result.overdue = ending.exit_code, ending.overdue
        result.wall, result.log = ending.wall, ending.log
        return cls(found, result)

    def undecided(self) -> tuple[Answer, Task | None]:
        """Return the answer without what a wall-clock limit ended, and the task that runs that here.

        What is slow on another machine may be quick enough on this one, and a time-out is a verdict. Of a
        fork parent, that task has only the mutants whose forks were ended.
        """
        task = self.result.task
        if not task.is_fork_parent:
            return (Answer([], self.result), task) if self.result.overdue is not None else (self, None)
        ended = {
            event.mutant for event in self.events if isinstance(event, events.ForkDied) and event.overdue
        }
        if not ended:
            return self, None
        rest = [event for event in self.events if getattr(event, "mutant", None) not in ended]
        return Answer(rest, self.result), task.only(ended)


def _decoded(line: bytes, place: str, decode: Any) -> Any:
    """Return the content of a line of JSON, with storable texts. Raises ValueError."""
    kind = ""
    try:
        data = _storable(_loaded(line))
        kind = f" ({str(data['type'])[:_SHOWN_NAME]})" if isinstance(data, dict) and "type" in data else ""
        found = decode(data)
        _check_numbers(found)
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
        text = f"{type(error).__name__}: {error}"
        raise ValueError(f"{place}{kind}: {text[:_SHOWN]}") from None
    return found


def _loaded(line: bytes) -> Any:
    if is_too_deep(line):
        raise ValueError(f"lists deeper than {MOST_DEPTH} levels")
    return json.loads(line.decode("utf-8"))


def _storable(value: Any) -> Any:
    """Return a value with storable texts, in which lone surrogates are escaped. Raises ValueError."""
    if isinstance(value, str):
        return value if value.isascii() else value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, list):
        return [_storable(item) for item in value]
    if isinstance(value, dict):
        return {_storable(key): _storable(item) for key, item in value.items()}
    if isinstance(value, int) and abs(value) >= _GREATEST:
        raise ValueError("a number of more than 300 digits")
    return value


def _check_numbers(value: Any) -> None:
    """Raise ValueError for invalid counts and times; the user's own data may contain any number."""
    kind: Any = type(value)
    for name, is_own in _fields(kind).items():
        item = getattr(value, name)
        for part in item if isinstance(item, tuple) else (item,):
            if is_dataclass(part):
                _check_numbers(part)
        if is_own and any(abs(number) > _MOST for number in _integers(item)):
            raise ValueError(f"{name}: {item!r} is not a count")
        if name in _MEASURED and not 0 <= item < math.inf:
            raise ValueError(f"{name}: {item} is not a time")


def _integers(item: Any) -> Iterator[int]:
    if isinstance(item, int):
        yield item
    elif isinstance(item, Mapping | tuple):
        for value in item.values() if isinstance(item, Mapping) else item:
            yield from _integers(value)


@cache
def _fields(kind: Any) -> dict[str, bool]:
    """Return the fields of a dataclass, and whether each is mutabot's own: then its type says all."""
    return {name: "Any" not in str(hint) for name, hint in get_type_hints(kind).items()}


def check_fit(found: Iterable[Event], job: Job) -> None:
    """Raise ValueError for events that this job cannot have caused."""
    forking = job.forking
    mutants = {mutant.id for mutant in forking.mutants} if forking is not None else set()
    sites: set[int] = set()
    for event in found:
        if isinstance(event, _NEVER) or (forking is None and isinstance(event, _FORKS)):
            raise ValueError(f"this task has no {type(event).__name__}")
        for mutant in _mutants(event):
            is_test_control = isinstance(event, events.ForkTestEnd) and event.is_test_control
            if mutant not in mutants and not is_test_control:
                raise ValueError(f"{mutant[:_SHOWN_NAME]!r} is not a mutant of this task")
        makes_tests = job.mutant is not None or isinstance(event, events.ForkTestEnd | events.ForkDied)
        for test in _tests(event):
            if job.tests is not None and test not in job.tests and not makes_tests:
                raise ValueError(f"{test[:_SHOWN_NAME]!r} is not a test of this task")
        for seen in _sites(event):
            _check_file(seen.span.file)
        if isinstance(event, events.SiteSeen):
            sites.add(event.index)
        elif isinstance(event, events.TestEnd):
            _check_end(event, sites)
        elif isinstance(event, events.ForkTestEnd):
            _check_end(event.end, {seen.index for seen in event.sites})


def _mutants(event: Event) -> Iterator[str]:
    match event:
        case events.ForkTestEnd() | events.ForkDied():
            yield event.mutant
        case events.Unforked() | events.ForkSessionEnd():
            yield from event.mutants
        case events.Undiverged():
            yield from event.hits


def _tests(event: Event) -> Iterator[str]:
    match event:
        case events.ForkTestEnd():
            yield event.end.test
        case events.Acted() | events.PlacesReached():
            yield from filter(None, [event.test])  # empty before any test
        case (
            events.TestEnd() | events.TestStart() | events.TestControls() | events.Watched()
            | events.ForkDied() | events.Unforked() | events.Undiverged()
        ):  # fmt: skip
            yield event.test


def _sites(event: Event) -> Iterator[events.SiteSeen]:
    match event:
        case events.SiteSeen():
            yield event
        case events.ForkTestEnd():
            yield from event.sites


def _check_file(name: str) -> None:
    """Raise ValueError for the name of a file outside the project, whose files are read to name places."""
    if PurePosixPath(name).is_absolute() or ".." in PurePosixPath(name).parts or "\0" in name:
        raise ValueError(f"{name[:_SHOWN_NAME]!r} is not a file of the project")


def _check_end(end: events.TestEnd, sites: set[int]) -> None:
    """Check the fields of a test's end whose types are not fixed."""
    if end.outcome not in _OUTCOMES:
        raise ValueError(f"{end.outcome[:_SHOWN_NAME]!r} is not an outcome of a test")
    if end.example is not None and len(end.example) != 2:
        raise ValueError("an example is a pair")
    if not 0 <= end.prepared <= len(end.returned):
        raise ValueError("more was prepared than was returned")
    for row in end.trace:
        if not isinstance(row, list) or len(row) != 4 or type(row[0]) is not int or row[0] not in sites:
            raise ValueError("a call in a trace was never seen")
    for row in end.moments:
        if not (isinstance(row, list) and len(row) == 3 and type(row[0]) is int and isinstance(row[1], dict)):
            raise ValueError("a moment belongs to no test")
    for row in end.returned:
        if not (isinstance(row, list) and len(row) == 2 and isinstance(row[0], str) and _is_returned(row[1])):
            raise ValueError("a returned value is not a value of the protocol")
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
    raise ValueError(f"a recording that cannot be read ({why})")


def _is_returned(value: object) -> bool:
    if isinstance(value, dict):
        return isinstance(value.get("raised"), str)
    return isinstance(value, list) and len(value) == 1
