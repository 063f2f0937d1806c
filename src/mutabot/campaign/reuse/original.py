"""Reuse of an earlier campaign's runs of the original.

A run is kept as the events that its process sent, so a baseline is taken from it as from a process. It
depends on its job and on all that any outcome depends on. As every mutant is compared with it, it also
depends on what outcomes leave to the user: environment variables, and the machine, by whose speed the limits
of time are set.
"""

from __future__ import annotations

import os
import platform
import time
import zlib
from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Self

from mutabot.campaign.reuse.parts import Parts, everything_of, installed
from mutabot.execution.processes import usual_environment
from mutabot.execution.task import Executor, Result, Task
from mutabot.journal.records import KeptBaseline, OriginalRun
from mutabot.model.codec import data_digest, to_data
from mutabot.model.event_file import MOST_BYTES, sealed, unsealed

from .snapshot import OpenedFiles, Snapshot, State

if TYPE_CHECKING:
    from mutabot.campaign.baseline.suite_runs import Runs
    from mutabot.campaign.request import Progress, Request
    from mutabot.model.events import Event

#: environment variables by which shells keep their own books
_OF_SHELLS = {"_", "OLDPWD", "SHLVL"}
#: a list of folders that wheels of ROS set in another order each time Python starts
_UNORDERED = "LD_LIBRARY_PATH"
#: the seal shows that a line is whole and of this run; who could change it could seal it as well
_KEY = ""
#: the level at which zlib costs least, and bytes that are unpacked at once
_QUICKLY, _AT_ONCE = 1, 1 << 20


class OriginalRuns:
    """The kept runs of the original; a context manager around the baseline.

    Args:
        request: the campaign.
        kept: what an earlier one left; None for nothing.
        progress: gets a note of how old the reused runs are.

    Attributes:
        installed: see ``keys.installed``, as it is before the baseline.
        before, after: the project's files before and after the baseline.
        opened: the files that its runs open, also those that are reused; None if that is not known.
    """

    def __init__(self, request: Request, kept: KeptBaseline | None, progress: Progress) -> None:
        self._request, self._progress = request, progress
        self.installed = installed(request.root)
        self._beside = {"environment": _environment(), "machine": platform.node()}
        self.before = self.after = Snapshot.take(request.root)
        self.opened: set[str] | None = None
        self._watch = OpenedFiles(request.root, self.before.folders)
        self._kept = kept if kept is not None and self._is_as_now(kept) else None
        self._held = defaultdict[str, deque[OriginalRun]](deque)
        for run in self._kept.runs if self._kept is not None else ():
            self._held[run.task].append(run)
        self._reused: list[OriginalRun] = []
        self._made: list[OriginalRun] = []

    def __enter__(self) -> Self:
        self._watch.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._watch.__exit__(kind, error, trace)
        self.opened = self._watch.opened
        if self._kept is not None and self._reused and self.opened is not None:
            known = self._kept.opened
            self.opened = None if known is None else self.opened | {*known}
        self.after = Snapshot.take(self._request.root, self.before)

    def runs_by(self, executor: Executor, request: Request) -> Runs:
        """Return a source of runs of the original: kept runs where possible, otherwise this executor.

        What is installed elsewhere is not known here: what other machines ran is not kept.

        Args:
            request: the campaign, or the same over a simulation.
        """
        return _KeptRuns(self, executor, request) if request.executor is None else executor

    def keep(self, write: Callable[[KeptBaseline], object]) -> None:
        """Keep the new runs for later campaigns.

        That is nothing if files of the project changed meanwhile: tests may have
        seen any of them.
        """
        if not self._made or self.after != self.before:
            return
        depends = self._depends(self.opened)
        taken = self._kept.taken if self._kept is not None and self._reused else time.time()
        opened = None if self.opened is None else tuple(sorted(self.opened))
        write(KeptBaseline(depends, taken, opened, (*self._reused, *self._made)))

    def held(self, name: str, task: Task) -> tuple[list[Event], Result] | None:
        """Return the events and the result of a kept run; None if none can be read."""
        runs = self._held.get(name)
        if not runs:
            return None
        run = runs.popleft()
        try:
            events = _read(run)
        except ValueError:
            return None
        if not self._reused and self._kept is not None:
            when = time.strftime("%Y-%m-%d %H:%M", time.localtime(self._kept.taken))
            self._progress.note(f"the baseline of {when} still holds; `mutabot run --fresh` takes a new one")
        self._reused.append(run)
        result = Result(task, exit_code=run.exit_code, wall=run.wall)
        for event in events:
            result.take(event)
        return events, result

    def made(self, run: OriginalRun) -> None:
        """Add a run that has ended in an orderly way."""
        self._made.append(run)

    def _is_as_now(self, kept: KeptBaseline) -> bool:
        if self._request.fresh:
            return False
        return kept.depends == self._depends(None if kept.opened is None else set(kept.opened))

    def _depends(self, opened: set[str] | None) -> str:
        state = State.now(self._request, self.before, self.before, opened)
        parts: Parts = {**everything_of(self._request, state.files, self.installed), **self._beside}
        return data_digest(parts)


@dataclass(frozen=True, slots=True)
class _KeptRuns:
    """A source of kept runs, and of an executor's runs for all other tasks."""

    original: OriginalRuns
    executor: Executor
    request: Request

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """Return the events of these tasks, as an executor does."""
        left, notes = [], {}
        for task in tasks:
            name = self._name_of(task)
            found = self.original.held(name, task)
            if found is None:
                left.append(task)
                notes[task.key] = _Note(name)
                continue
            events, result = found
            yield from ((task, event) for event in events)
            yield result
        for entry in self.executor.events(left):
            if isinstance(entry, Result):
                run = notes.pop(entry.task.key).run(entry)
                if run is not None:
                    self.original.made(run)
            else:
                notes[entry[0].key].add(entry[1])
            yield entry

    def _name_of(self, task: Task) -> str:
        """Return a name that is equal for tasks that do the same."""
        request = self.request
        return data_digest([to_data(task.job), task.may_share, request.arguments, request.simulation])


class _Note:
    """A recorder of the events of a run."""

    def __init__(self, name: str) -> None:
        self._name, self._number = name, 0
        self._packing, self._packed = zlib.compressobj(_QUICKLY), list[bytes]()

    def add(self, event: Event) -> None:
        self._number += 1
        self._packed.append(self._packing.compress(sealed(event, self._number, self._name, _KEY)))

    def run(self, result: Result) -> OriginalRun | None:
        """Return the run that has ended; None if it was incomplete."""
        faults = (result.overdue, result.hindered, result.lost, result.untrusted)
        if result.end is None or result.problems or any(faults):
            return None
        events = b"".join((*self._packed, self._packing.flush()))
        return OriginalRun(self._name, result.exit_code, result.wall, events)


def _read(run: OriginalRun) -> list[Event]:
    """Return the events of a run. Raises ValueError if they are damaged."""
    unpacking, rest = zlib.decompressobj(), run.events
    found: list[Event] = []
    line = b""
    try:
        while len(line) <= MOST_BYTES and (part := unpacking.decompress(rest, _AT_ONCE)):
            rest = unpacking.unconsumed_tail
            *lines, line = (line + part).split(b"\n")
            for text in lines:
                number, event = unsealed(text, run.task, _KEY)
                found.append(event)
                if number != len(found):
                    raise ValueError("an event is missing")
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if line or not unpacking.eof:
        raise ValueError("the end is missing")
    return found


def _environment() -> str:
    """Return all environment variables that tests can see, as a digest."""
    found = {name: text for name, text in usual_environment().items() if name not in _OF_SHELLS}
    return data_digest(found | {_UNORDERED: sorted(found.get(_UNORDERED, "").split(os.pathsep))})
