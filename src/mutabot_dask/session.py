"""One unit on a worker: its process while it is wanted, and whether what it says is this machine's fault."""

from __future__ import annotations

import errno
import re
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from mutabot.border.events import Event
from mutabot.campaign.workers.task import Result, Task, death
from mutabot.campaign.workers.workers import Workers
from mutabot.errors import JournalError

from .checked import Misfit
from .environment import apply
from .unit import Answer, Ground, Unit

#: signals by which systems end processes: for want of memory, or since somebody else needs the machine
_BY_OTHERS = {-signal.SIGKILL, -signal.SIGTERM}
#: bytes that must be free on the disks of a worker
_ROOM = 1 << 20
_FULL = re.compile(rf"\[Errno ({errno.ENOSPC}|{errno.EDQUOT}|{errno.EROFS})\]")
#: seconds after which a worker without units keeps no processes any more
_IDLE = 60.0


class Unwanted(Exception):  # noqa: N818  # it is no error
    """Nobody waits for this unit any more."""


@dataclass(slots=True)
class Session:
    """What a worker keeps from one unit to the next.

    Args:
        place: where the bundle is.
        ground: what its units stand on.

    Attributes:
        proven: tests that have passed here: what they find is not this machine's fault.
    """

    place: Path
    ground: Ground
    proven: set[str] = field(default_factory=set)
    _workers: Workers | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _used: float = 0.0

    def answer(self, unit: Unit, look: Callable[[], None]) -> bytes:
        """Run a unit. ``look`` is called several times a second, and raises Unwanted if it is to end."""
        here, there = str(self.root), self.ground.root
        with self._lock:
            try:
                answer = self._answered(unit, look)
            except Unwanted:
                self._close()
                answer = Answer(fault="the worker was asked to stop")
            except (OSError, JournalError) as error:
                self._close()
                answer = Answer(fault=str(error), is_unfit=True)
                here = there  # the folders that it names are this machine's
            self._used = time.monotonic()
        return self._fitting(replace(answer, ticket=unit.ticket).data(here, there), unit)

    def _fitting(self, data: bytes, unit: Unit) -> bytes:
        """The answer if the controller will take it: what processes report is in the hands of mutants."""
        try:
            Answer.of(data, unit)
        except Misfit as error:
            lost = f"what its process reported cannot be used: {error}"
            return Answer(lost=lost, ticket=unit.ticket).data("/", "/")
        return data

    def close(self) -> None:
        """End what it keeps."""
        with self._lock:
            self._close()

    def close_if_idle(self) -> None:
        """End what it keeps if no unit has come for a while."""
        if self._lock.acquire(blocking=False):
            try:
                if time.monotonic() - self._used >= _IDLE:
                    self._close()
            finally:
                self._lock.release()

    @property
    def root(self) -> Path:
        """The project's folder here."""
        return self.place / self.ground.inner

    def _answered(self, unit: Unit, look: Callable[[], None]) -> Answer:
        apply(self.ground.environment, (str(self.root / path) for path in self.ground.paths))
        job = replace(unit.task.job, root=str(self.root))
        task = replace(unit.task, job=job)
        lines, result = self._run(task, look)
        fault = self._fault(result)
        if fault is not None:
            return Answer.of_result(lines, result, fault)
        self.proven.update(end.test for end in result.ends if end.outcome != "failed")
        unproven = [
            end.test for end in result.ends if end.outcome == "failed" and end.test not in self.proven
        ]
        if unproven:
            unfit = self._why_unfit(task, unproven[0], look)
            if unfit is not None:
                return replace(Answer.of_result(lines, result, unfit), is_unfit=True)
        return Answer.of_result(lines, result)

    def _run(self, task: Task, look: Callable[[], None]) -> tuple[list[Event], Result]:
        workers = self._opened()
        workers.look = look
        lines: list[Event] = []
        for event in workers.events([task]):
            if isinstance(event, Result):
                return lines, event
            lines.append(event[1])
        raise OSError("a unit ended without a result")

    def _opened(self) -> Workers:
        if self._workers is None:
            arguments = tuple(one.replace(self.ground.root, str(self.root)) for one in self.ground.arguments)
            self._workers = Workers(self.root, arguments, jobs=1)
        return self._workers

    def _close(self) -> None:
        if self._workers is not None:
            self._workers.__exit__(None, None, None)
            self._workers = None

    def _fault(self, result: Result) -> str | None:
        """What went wrong that has nothing to do with the mutant, as far as one can tell."""
        full = next((one.message for one in result.ends if one.message and _FULL.search(one.message)), None)
        if full is not None:
            return full.splitlines()[0]
        for folder in {str(self.root), tempfile.gettempdir()}:
            if shutil.disk_usage(folder).free < _ROOM:
                return f"no room is left on the disk of {folder}"
        if result.end is None and result.overdue is None and result.exit_code in _BY_OTHERS:
            return death(result)
        return None

    def _why_unfit(self, task: Task, test: str, look: Callable[[], None]) -> str | None:
        """Whether a test fails here without any mutant, as it does not where the baseline was taken."""
        tests = task.job.tests or ()
        leading = tests[: tests.index(test) + 1] if test in tests else tests
        job = replace(
            task.job, tests=leading, mutant=None, branching=None, stop_at_kill=False, instrumentation=None,
            record=False, evidence=False,
        )  # fmt: skip
        plain = replace(task, job=job, is_trunk=False, may_share=False, begins_warm=False)
        _, result = self._run(plain, look)
        ended = next((end for end in result.ends if end.test == test), None)
        if ended is not None and ended.outcome != "failed":
            self.proven.update(end.test for end in result.ends if end.outcome != "failed")
            return None
        why = ended.message if ended is not None else death(result)
        return f"{test} fails there without any mutant: {(why or 'no reason given').splitlines()[0]}"
