"""What Dask's workers run for a campaign. Each function takes bytes of JSON, and gives such bytes.

A unit has its process while it is wanted, and it is told whether what it says is this machine's fault. A
bundle is unpacked once on each machine, by whichever worker there comes first. Who uses one holds a lock on
it, which the system takes back when that process dies. What nobody holds is removed by the next to come, and
by the last to leave.
"""

from __future__ import annotations

import errno
import fcntl
import io
import os
import re
import shutil
import signal
import socket
import tarfile
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mutabot.errors import JournalError
from mutabot.execution.remains import OWNER, end_abandoned
from mutabot.execution.task import Result, Task
from mutabot.execution.workers import Workers
from mutabot.model.events import Event

from .environment import apply
from .unit import Ground, Introduction, Misfit, UnitAnswer, WorkUnit

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
class WorkerSession:
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

    def answer(self, unit: WorkUnit, look: Callable[[], None]) -> bytes:
        """Run a unit. ``look`` is called several times a second, and raises Unwanted if it is to end."""
        here, there = str(self.root), self.ground.root
        with self._lock:
            try:
                answer = self._answered(unit, look)
            except Unwanted:
                self._close()
                answer = UnitAnswer(fault="the worker was asked to stop")
            except (OSError, JournalError) as error:
                self._close()
                answer = UnitAnswer(fault=str(error), is_unfit=True)
                here = there  # the folders that it names are this machine's
            self._used = time.monotonic()
        return self._fitting(replace(answer, ticket=unit.ticket).data(here, there), unit)

    def _fitting(self, data: bytes, unit: WorkUnit) -> bytes:
        """The answer if the controller will take it: what processes report is in the hands of mutants."""
        try:
            UnitAnswer.of(data, unit)
        except Misfit as error:
            lost = f"what its process reported cannot be used: {error}"
            return UnitAnswer(lost=lost, ticket=unit.ticket).data("/", "/")
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

    def _answered(self, unit: WorkUnit, look: Callable[[], None]) -> UnitAnswer:
        apply(self.ground.environment, (str(self.root / path) for path in self.ground.paths))
        job = replace(unit.task.job, root=str(self.root))
        task = replace(unit.task, job=job)
        lines, result = self._run(task, look)
        fault = self._fault(result)
        if fault is not None:
            return UnitAnswer.of_result(lines, result, fault)
        self.proven.update(end.test for end in result.ends if end.outcome != "failed")
        unproven = [
            end.test for end in result.ends if end.outcome == "failed" and end.test not in self.proven
        ]
        if unproven:
            unfit = self._why_unfit(task, unproven[0], look)
            if unfit is not None:
                return replace(UnitAnswer.of_result(lines, result, unfit), is_unfit=True)
        return UnitAnswer.of_result(lines, result)

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
            return result.death()
        return None

    def _why_unfit(self, task: Task, test: str, look: Callable[[], None]) -> str | None:
        """Whether a test fails here without any mutant, as it does not where the baseline was taken."""
        tests = task.job.tests or ()
        leading = tests[: tests.index(test) + 1] if test in tests else tests
        job = replace(
            task.job, tests=leading, mutant=None, forking=None, stop_at_kill=False, instrumentation=None,
            record=False, evidence=False,
        )  # fmt: skip
        plain = replace(task, job=job, is_fork_parent=False, may_share=False)
        _, result = self._run(plain, look)
        ended = next((end for end in result.ends if end.test == test), None)
        if ended is not None and ended.outcome != "failed":
            self.proven.update(end.test for end in result.ends if end.outcome != "failed")
            return None
        why = ended.message if ended is not None else result.death()
        return f"{test} fails there without any mutant: {(why or 'no reason given').splitlines()[0]}"


_LOCK = ".lock"


class Store:
    """The bundles in a folder of ours.

    Args:
        folder: where they are; made if it is not there.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if folder.stat().st_uid != os.getuid():
            raise PermissionError(f"{folder} belongs to somebody else")
        self._held: dict[str, int] = {}
        self._parts: dict[str, dict[int, bytes]] = {}

    def place(self, digest: str) -> Path:
        """Where a bundle is."""
        return self._folder / digest

    def has(self, digest: str) -> bool:
        """Whether a bundle is there; from now on this process uses it."""
        self.hold(digest)
        return self.place(digest).is_dir()

    def hold(self, digest: str) -> None:
        """Use a bundle, and no other any more."""
        for other in set(self._held) - {digest}:
            self.leave(other)
        if digest not in self._held:
            self._held[digest] = _shared(self._folder / (digest + _LOCK))
        self._sweep()

    def leave(self, digest: str) -> None:
        """Use a bundle no longer."""
        descriptor = self._held.pop(digest, None)
        if descriptor is not None:
            os.close(descriptor)
        self._sweep()

    def take(self, digest: str, index: int, count: int, part: bytes) -> None:
        """Take a part of a bundle, and unpack it with the last one."""
        parts = self._parts.setdefault(digest, {})
        parts[index] = part
        if len(parts) < count:
            return
        del self._parts[digest]
        data = b"".join(parts[number] for number in range(count))
        made = Path(tempfile.mkdtemp(prefix="new-", dir=self._folder))
        try:
            with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as tar:
                tar.extractall(made, filter="data")
            made.rename(self.place(digest))
        except OSError:
            if not self.place(digest).is_dir():  # another worker of this machine was first
                raise
        finally:
            shutil.rmtree(made, ignore_errors=True)

    def _sweep(self) -> None:
        """Remove bundles that nobody uses."""
        for lock in self._folder.glob("*" + _LOCK):
            digest = lock.name.removesuffix(_LOCK)
            if digest not in self._held:
                with _alone(lock) as is_alone:
                    if is_alone:
                        shutil.rmtree(self.place(digest), ignore_errors=True)
                        lock.unlink(missing_ok=True)


def _shared(lock: Path) -> int:
    """A descriptor that holds a lock with others; of the file that is there, not of one just removed."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        fcntl.flock(descriptor, fcntl.LOCK_SH)
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(descriptor), lock.stat()):
                return descriptor
        os.close(descriptor)


@contextmanager
def _alone(lock: Path) -> Iterator[bool]:
    """Whether nobody else holds a lock, which is held meanwhile."""
    try:
        descriptor = os.open(lock, os.O_RDWR | os.O_CLOEXEC)
    except OSError:
        yield False
        return
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
        else:
            yield True
    finally:
        os.close(descriptor)


#: seconds between two looks for what is idle
_PERIOD = 20.0
#: seconds that a folder may be without an owner, since it is just being made
_YOUNG = 60.0
#: the answer of functions that have nothing to say
TAKEN = b"{}"
_sessions: dict[str, WorkerSession] = {}
_stores: dict[Path, Store] = {}


def introduce(digest: str, inner: str) -> bytes:
    """Say who this worker is, and whether it has a bundle. An empty digest asks for none."""
    has = bool(digest) and _store().has(digest)
    if has:
        _clear_up(_store().place(digest) / inner / ".mutabot")
    return Introduction(Workers.versions(), has).data()


def receive(digest: str, index: int, count: int, part: bytes) -> bytes:
    """Take a part of a bundle."""
    store = _store()
    store.hold(digest)
    store.take(digest, index, count, part)
    return TAKEN


def run_unit(data: bytes) -> bytes:
    """Run a unit."""
    unit = WorkUnit.of(data)
    digest = unit.ground.digest
    session = _sessions.get(digest)
    if session is None or session.ground != unit.ground:
        leave("")
        session = _sessions[digest] = WorkerSession(_store().place(digest), unit.ground)
        _watch(session)
    return session.answer(unit, _look_of(_worker()))


def leave(digest: str) -> bytes:
    """Keep nothing of a campaign; ``digest`` names the bundle that goes as well."""
    for session in list(_sessions.values()):
        session.close()
    _sessions.clear()
    if digest:
        _store().leave(digest)
    return TAKEN


def _worker() -> Any:
    from distributed import get_worker  # noqa: PLC0415  # only workers have it for sure

    return get_worker()


def _store() -> Store:
    """The bundles of this machine, beside Dask's own folders."""
    folder = (
        Path(_worker().local_directory).resolve().parent / f"mutabot-{os.getuid()}-{socket.gethostname()}"
    )
    if folder not in _stores:
        _stores[folder] = Store(folder)
    return _stores[folder]


def _clear_up(home: Path) -> None:
    """End and remove what workers of this machine have left that were killed."""
    end_abandoned(home)
    for folder in home.glob("work-*"):
        with suppress(OSError):
            if not (folder / OWNER).exists() and time.time() - folder.stat().st_mtime > _YOUNG:
                shutil.rmtree(folder, ignore_errors=True)


def _look_of(worker: Any) -> Any:
    """What raises Unwanted once the unit that runs now is wanted no more."""
    key = worker.get_current_task()

    def look() -> None:
        task = worker.state.tasks.get(key)
        is_closing = worker.status.name in {"closing", "closed", "failed", "stopping"}
        if is_closing or task is None or task.state != "executing":
            raise Unwanted

    return look


def _watch(session: WorkerSession) -> None:
    """Let a session that has become idle keep no processes."""

    def watch() -> None:
        if session in _sessions.values():
            session.close_if_idle()
            _later(watch)

    _later(watch)


def _later(action: Any) -> None:
    timer = threading.Timer(_PERIOD, action)
    timer.daemon = True
    timer.start()
