"""The functions that Dask's workers run for a campaign; all take plain values or bytes and return bytes.

A unit has its process while it is wanted, and its answer says whether its failure is this machine's fault.
The project is unpacked into the folder that Dask gives a worker. Dask removes it when the worker ends, or
when the next one comes if it was killed.
"""

from __future__ import annotations

import errno
import io
import re
import shutil
import signal
import tarfile
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mutabot.api.processes import Answer, Result, Task, Workers
from mutabot.api.reports import MutabotError

from .environment import apply
from .unit import Introduction, InvalidData, SharedData, UnitAnswer, WorkUnit

#: signals by which systems end processes: for want of memory, or since others need the machine
_BY_OTHERS = {-signal.SIGKILL, -signal.SIGTERM}
#: bytes that must be free on the disks of a worker
_ROOM = 1 << 20
_FULL = re.compile(rf"\[Errno ({errno.ENOSPC}|{errno.EDQUOT}|{errno.EROFS})\]")
#: seconds after which a worker without units keeps no processes any more
_IDLE = 60.0
#: the answer of functions that have nothing to say
TAKEN = b"{}"


class Cancelled(Exception):  # noqa: N818  # it is no error
    """The unit's result is no longer needed."""


@dataclass(slots=True)
class WorkerSession:
    """The state that a worker keeps between units.

    Args:
        place: where the bundle is.
        ground: what its units stand on.

    Attributes:
        proven: tests that have passed here: what they find is not this machine's fault.
    """

    place: Path
    ground: SharedData
    proven: set[str] = field(default_factory=set)
    _workers: Workers | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _timer: threading.Timer | None = None

    @property
    def root(self) -> str:
        """The project's folder on this worker."""
        return str(self.place / self.ground.inner)

    def answer(self, unit: WorkUnit, look: Callable[[], None]) -> bytes:
        """Run a unit. ``look`` is called several times a second, and raises Cancelled to end it."""
        with self._lock:
            self._close_later(None)
            try:
                answer = self._answered(unit.task.in_folder(self.root), look)
            except Cancelled:
                self._close()
                answer = UnitAnswer(fault="the worker was asked to stop")
            except (OSError, MutabotError) as error:
                self._close()
                answer = UnitAnswer(fault=str(error), is_unfit=True)
            self._close_later(_IDLE)
        return self._acceptable(replace(answer, ticket=unit.ticket).data(self.ground.root), unit)

    def _acceptable(self, data: bytes, unit: WorkUnit) -> bytes:
        """Return the answer if the controller will accept it, since mutants may tamper with it."""
        try:
            UnitAnswer.of(data, unit)
        except InvalidData as error:
            lost = f"what its process reported cannot be used: {error}"
            return UnitAnswer(lost=lost, ticket=unit.ticket).data("")
        return data

    def close(self) -> None:
        """End the session's processes."""
        with self._lock:
            self._close_later(None)
            self._close()

    def _close_later(self, seconds: float | None) -> None:
        """End the session's processes after this many seconds; None cancels that."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if seconds is not None:
            self._timer = threading.Timer(seconds, self.close)
            self._timer.daemon = True
            self._timer.start()

    def _answered(self, task: Task, look: Callable[[], None]) -> UnitAnswer:
        apply(self.ground.environment, (f"{self.root}/{path}" for path in self.ground.paths))
        found = self._run(task, look)
        fault = self._fault(found.result)
        if fault is not None:
            return UnitAnswer(found, fault)
        ends = found.result.ends
        self.proven.update(end.test for end in ends if end.outcome != "failed")
        unproven = [end.test for end in ends if end.outcome == "failed" and end.test not in self.proven]
        fault = self._why_unfit(task, unproven[0], look) if unproven else None
        return UnitAnswer(found, fault, is_unfit=fault is not None)

    def _run(self, task: Task, look: Callable[[], None]) -> Answer:
        if self._workers is None:
            arguments = (argument.replace(self.ground.root, self.root) for argument in self.ground.arguments)
            self._workers = Workers(Path(self.root), arguments, jobs=1)
        self._workers.look = look
        return Answer.by(self._workers, task)

    def _close(self) -> None:
        if self._workers is not None:
            self._workers.__exit__(None, None, None)
            self._workers = None

    def _fault(self, result: Result) -> str | None:
        """Return a failure of this machine rather than of the mutant; None if none is known."""
        full = next((end.message for end in result.ends if end.message and _FULL.search(end.message)), None)
        if full is not None:
            return full.splitlines()[0]
        for folder in {self.root, tempfile.gettempdir()}:
            if shutil.disk_usage(folder).free < _ROOM:
                return f"no room is left on the disk of {folder}"
        if result.end is None and result.overdue is None and result.exit_code in _BY_OTHERS:
            return result.death()
        return None

    def _why_unfit(self, task: Task, test: str, look: Callable[[], None]) -> str | None:
        """Return how a test fails here without any mutant, unlike in the baseline; None if it does not."""
        result = self._run(task.without_mutant(test), look).result
        ended = next((end for end in result.ends if end.test == test), None)
        if ended is not None and ended.outcome != "failed":
            self.proven.update(end.test for end in result.ends if end.outcome != "failed")
            return None
        why = ended.message if ended is not None else result.death()
        return f"{test} fails there without any mutant: {(why or 'no reason given').splitlines()[0]}"


class Store:
    """The bundle on a worker: one campaign's at a time, in the worker's own folder.

    Args:
        folder: where it is unpacked.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._parts: dict[int, bytes] = {}
        self._digest = ""

    def place(self, digest: str) -> Path:
        """Return the path of a bundle."""
        return self._folder / f"mutabot-{digest}"

    def has(self, digest: str) -> bool:
        """Return whether a bundle exists; remove any other one."""
        if digest != self._digest:
            self.clear()
            self._digest = digest
        return self.place(digest).is_dir()

    def clear(self) -> None:
        """Remove the bundle."""
        self._parts.clear()
        shutil.rmtree(self.place(self._digest), ignore_errors=True)

    def take(self, digest: str, index: int, count: int, part: bytes) -> None:
        """Store a part of a bundle, and unpack the bundle with the last part."""
        if self.has(digest):
            return
        self._parts[index] = part
        if len(self._parts) < count:
            return
        data = b"".join(self._parts.pop(number) for number in range(count))
        made = Path(tempfile.mkdtemp(prefix="mutabot-new-", dir=self._folder))
        try:
            with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as tar:
                tar.extractall(made, filter="data")
            made.rename(self.place(digest))
        finally:
            shutil.rmtree(made, ignore_errors=True)


_sessions: list[WorkerSession] = []
_stores: dict[str, Store] = {}


def introduce(digest: str) -> bytes:
    """Return this worker's versions, and whether it has a bundle. An empty digest asks for none."""
    has = bool(digest) and _store().has(digest)
    return Introduction(Workers.versions(), has).data()


def receive(digest: str, index: int, count: int, part: bytes) -> bytes:
    """Store a part of a bundle."""
    _store().take(digest, index, count, part)
    return TAKEN


def run_unit(data: bytes) -> bytes:
    """Run a unit."""
    unit = WorkUnit.of(data)
    if not _sessions or _sessions[0].ground != unit.ground:
        _end_sessions()
        _sessions.append(WorkerSession(_store().place(unit.ground.digest), unit.ground))
    return _sessions[0].answer(unit, _cancellation_check(_worker()))


def leave() -> bytes:
    """Delete everything kept for a campaign."""
    _end_sessions()
    _store().clear()
    return TAKEN


def _end_sessions() -> None:
    while _sessions:
        _sessions.pop().close()


def _worker() -> Any:
    from distributed import get_worker  # noqa: PLC0415  # only workers have it for sure

    return get_worker()


def _store() -> Store:
    folder = _worker().local_directory
    return _stores.setdefault(folder, Store(Path(folder).resolve()))


def _cancellation_check(worker: Any) -> Any:
    """Return a function that raises Cancelled once the running unit is no longer needed."""
    key = worker.get_current_task()

    def look() -> None:
        task = worker.state.tasks.get(key)
        is_closing = worker.status.name in {"closing", "closed", "failed", "stopping"}
        if is_closing or task is None or task.state != "executing":
            raise Cancelled

    return look
