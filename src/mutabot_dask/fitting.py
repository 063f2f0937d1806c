"""Whether an answer speaks of its unit alone, and can be judged.

What a worker says of its own unit is believed: nobody else saw it. It can say nothing of other mutants or
other tests, name no file outside the project, and nothing that would end the campaign.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath

from mutabot.border.events import (
    Acted,
    BranchDied,
    BranchEnd,
    BranchFinished,
    Copied,
    Event,
    ForkEnded,
    MutatedCall,
    PlacesReached,
    Serving,
    SiteSeen,
    TestStart,
    Unbranched,
    Undiverged,
    Watched,
)
from mutabot.border.job import Job
from mutabot.border.test_end import TestEnd
from mutabot.evidence.recording import bytes_of, from_bytes

from .checked import Misfit

_OUTCOMES = {"passed", "failed", "skipped", "xfailed", "xpassed"}
#: what only fork servers say
_NEVER = (Serving, Copied, ForkEnded)
_BRANCHES = (BranchEnd, BranchFinished, BranchDied, Unbranched, Undiverged)
#: bytes of a recording, which comes packed
_UNPACKED = 256 << 20


def check_fit(lines: Iterable[Event], job: Job) -> None:
    """Raises Misfit for lines that this job cannot have made."""
    branching = job.branching
    mutants = {one.id for one in branching.mutants} if branching is not None else set()
    sites: set[int] = set()
    for line in lines:
        if isinstance(line, _NEVER) or (branching is None and isinstance(line, _BRANCHES)):
            raise Misfit(f"this unit has no {type(line).__name__}")
        for mutant in _mutants(line):
            if mutant not in mutants:
                raise Misfit(f"{mutant[:100]!r} is no mutant of this unit")
        for test in _tests(line):
            if job.tests is not None and test not in job.tests:
                raise Misfit(f"{test[:100]!r} is no test of this unit")
        for seen in _sites(line):
            _check_file(seen.span.file)
        if isinstance(line, SiteSeen):
            sites.add(line.index)
        elif isinstance(line, TestEnd):
            _check_end(line, sites)
        elif isinstance(line, BranchEnd):
            _check_end(line.end, {seen.index for seen in line.sites})


def _mutants(line: Event) -> Iterator[str]:
    match line:
        case BranchEnd() | BranchDied():
            yield line.mutant
        case Unbranched() | BranchFinished():
            yield from line.mutants
        case Undiverged():
            yield from line.hits


def _tests(line: Event) -> Iterator[str]:
    match line:
        case TestEnd() | TestStart() | Watched() | BranchDied() | Unbranched() | Undiverged():
            yield line.test
        case BranchEnd():
            yield line.end.test
        case Acted() | MutatedCall() | PlacesReached() if line.test:  # empty before any test
            yield line.test


def _sites(line: Event) -> Iterator[SiteSeen]:
    match line:
        case SiteSeen():
            yield line
        case BranchEnd():
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
