"""Runs one task at a time on the hardware: confirmed, between two safe states, and under a heartbeat.

A stop has three parts, in this order: no command gets leave any more; the processes of the tests are killed;
the safe state is called.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

from mutabot.api.processes import Request, Result, Task, Workers
from mutabot.api.reports import MutabotError, UsageError

from .attendant import Attendant
from .log import NAME, HardwareLog
from .permission import Permissions
from .rehearsal import Rehearsal

if TYPE_CHECKING:
    from .tables import HardwareTable, Surprise, Unasked

#: seconds that a heartbeat, and a way into the safe state, may take
_BEAT, _SAFE = 1.0, 60.0


class HardwareStoppedError(MutabotError):
    """The campaign was stopped; the hardware is in its safe state, or the message says that this failed."""

    exit_code = 4


@dataclass(slots=True)
class Heartbeat:
    """Repeatedly checks the hardware's health, and reports it to the test processes.

    Attributes:
        missing: what went wrong; None while all is well.
    """

    attendant: Attendant
    leave: Permissions
    function: str
    period: float
    missing: str | None = None
    _over: threading.Event = field(default_factory=threading.Event)
    _thread: threading.Thread | None = None

    def __enter__(self) -> Self:
        self._ask()
        self._thread = threading.Thread(target=self._go_on, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        if self._thread is not None:
            self._thread.join()

    def _go_on(self) -> None:
        while self.missing is None and not self._over.wait(self.period):
            self._ask()

    def _ask(self) -> None:
        self.missing = self.attendant.call(self.function, _BEAT)
        if self.missing is not None:
            self.leave.stop(f"no heartbeat: {self.missing}")


@dataclass(slots=True)
class HardwareExecutor:
    """Runs tasks on the hardware, see ``mutabot.api.processes.Request``; ``opened`` makes an executor.

    Attributes:
        spread, remarks: as executors have them.
    """

    request: Request
    table: HardwareTable
    unasked: Unasked
    leave: Permissions
    notify: Callable[[str], None]
    log: HardwareLog
    rehearsal: Rehearsal
    spread: int = 1
    remarks: Sequence[str] = ()
    #: seconds that each test of the original took, at most
    _seconds: dict[str, float] = field(default_factory=dict)

    @classmethod
    @contextmanager
    def opened(
        cls, request: Request, table: HardwareTable, unasked: Unasked, notify: Callable[[str], None]
    ) -> Iterator[Self]:
        """Open an executor whose processes may send commands until it is closed. Raises UsageError."""
        if unasked == "ask" and not sys.stdin.isatty():
            raise UsageError(
                "hardware: each mutant needs a confirmation, but this is no terminal: use --hardware yes"
            )
        home = request.journal_path.parent
        home.mkdir(exist_ok=True)
        journal = request.root / table.rehearsal if table.rehearsal is not None else None
        log = HardwareLog(home / NAME)
        with Permissions(log) as leave:
            executor = cls(request, table, unasked, leave, notify, log, Rehearsal.read(journal))
            executor._check()
            yield executor

    def _check(self) -> None:
        with Attendant(self.request.root) as attendant:
            attendant.check((self._safe_state, self._heartbeat))

    @property
    def _safe_state(self) -> str:
        return self.table.safe_state or ""  # ``HardwareChoice.fitted`` has refused a table without them

    @property
    def _heartbeat(self) -> str:
        return self.table.heartbeat or ""

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield results in the order in which tasks ran."""
        return (event for event in self.events(tasks) if isinstance(event, Result))

    def events(self, tasks: Iterable[Task]) -> Iterator[Any]:
        """Yield each event as it comes. Raises HardwareStoppedError at a surprise."""
        unfinished = self.log.unfinished()
        for task in self._ordered(tasks):
            why = self._why_not(task, unfinished)
            if why is not None:
                yield Result(task, lost=why)
                continue
            result = None
            for event in self._run_safely(task):
                result = event if isinstance(event, Result) else result
                yield event
            surprise = self._surprise(result) if result is not None else None
            if surprise is not None:
                raise self._stopped(surprise)

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Any]:
        """Yield nothing: no run continues after an interruption."""
        return iter(())

    def apart(self) -> AbstractContextManager[HardwareExecutor]:
        """Return the same hardware, since there is no other."""
        return _itself(self)

    def _ordered(self, tasks: Iterable[Task]) -> Iterable[Task]:
        """Return the tasks: the original first, then mutants from the most harmless on."""
        waiting = list(tasks)
        return sorted(waiting, key=self._harm)

    def _harm(self, task: Task) -> tuple[float, float]:
        mutant = task.job.mutant
        if mutant is None:
            return -1.0, 0.0
        return self.rehearsal.of(mutant.id).harm, mutant.magnitude or 0.0

    def _why_not(self, task: Task, unfinished: frozenset[str]) -> str | None:
        """Return why a task is not run; None if it is. Raises HardwareStoppedError if the user stops."""
        mutant = task.job.mutant
        is_again = mutant is not None and mutant.id in unfinished
        if is_again and self.unasked == "yes":
            return (
                "it was begun before and stopped, and no motion is repeated unasked: --hardware ask or repeat"
            )
        if self.unasked != "ask":
            return None
        return None if self._ask(task, is_again=is_again) else "it was not confirmed"

    def _ask(self, task: Task, *, is_again: bool) -> bool:
        print("\n".join(self._description(task, is_again=is_again)), file=sys.stderr)
        while True:
            # a line of its own: the bar is drawn anew below it, over what is typed
            print("  run it? type y, n, or q to quit, and Enter", file=sys.stderr, flush=True)
            answer = sys.stdin.readline().strip().lower()
            if answer in ("y", "yes", "n", "no"):
                return answer.startswith("y")
            if answer in ("q", "quit", ""):
                raise HardwareStoppedError("hardware: stopped by the user; nothing was moving")

    def _description(self, task: Task, *, is_again: bool) -> Iterator[str]:
        """Yield the lines that describe a mutant to the user before it runs."""
        mutant, tests = task.job.mutant, task.job.tests
        which = "all tests" if tests is None else f"{len(tests)} {'test' if len(tests) == 1 else 'tests'}"
        if mutant is None:
            yield f"hardware: the original program, {which}"
            return
        name = f"mutant {mutant.number}" if mutant.number else f"the {mutant.operator} control"
        yield f"hardware: {name}, {mutant.site.place}, {which}"
        yield f"  what        {mutant.description}"
        if mutant.magnitude is not None:
            yield f"  difference  {mutant.magnitude:g} {mutant.unit or ''}"
        yield f"  rehearsal   {self.rehearsal.of(mutant.id).text}"
        if is_again:
            yield "  before      it was begun before and did not come to its end"

    def _run_safely(self, task: Task) -> Iterator[Any]:
        """Run a task between two safe states."""
        mutant = task.job.mutant
        name: dict[str, Any] = {"original": list(task.job.tests or ())}
        if mutant is not None:
            name = {"mutant": mutant.id}
        with ExitStack() as stack:
            attendant = stack.enter_context(Attendant(self.request.root))
            self._make_safe(attendant, "before")
            beat = Heartbeat(attendant, self.leave, self._heartbeat, self.table.period)
            self.log.write(begin=True, **name)
            try:
                with beat, self.request.on_this_machine(self.notify) as workers:
                    yield from self._watched(workers, beat, replace(task, may_share=False))
            except BaseException as error:
                self.leave.stop(f"the campaign was stopped: {type(error).__name__}")
                self.log.write(stop=True, **{f"of {kind}": value for kind, value in name.items()})
                raise
            finally:
                self._make_safe_after(attendant)
            self.log.write(end=True, **name)

    def _watched(self, workers: Workers, beat: Heartbeat, task: Task) -> Iterator[Any]:
        def look() -> None:
            if beat.missing is not None:
                raise HardwareStoppedError(f"hardware: no heartbeat: {beat.missing}")

        workers.look = look
        look()
        with self.leave.given():
            yield from workers.events([task])
        look()

    def _make_safe(self, attendant: Attendant, when: str) -> None:
        why = attendant.call(self._safe_state, _SAFE)
        self.log.write(safe=when, failed=why)
        if why is not None:
            self.leave.stop(f"the safe state was not reached: {why}")
            raise HardwareStoppedError(f"hardware: the safe state was not reached: {why}")

    def _make_safe_after(self, attendant: Attendant) -> None:
        """Bring the hardware into its safe state in any case; by another process if this one has ended."""
        why = attendant.call(self._safe_state, _SAFE)
        if why is not None:
            with Attendant(self.request.root) as another:
                self._make_safe(another, "after")
        else:
            self.log.write(safe="after", failed=None)

    def _surprise(self, result: Result) -> str | None:
        """Return what stops the campaign after this run; None if nothing does."""
        found = self._found_in(result)
        if result.task.job.mutant is None:
            for end in result.ends:
                self._seconds[end.test] = max(end.wall, self._seconds.get(end.test, 0.0))
            found.pop("time", None)
        asked: tuple[Surprise, ...] = self.table.stop
        return next((text for kind, text in found.items() if kind in asked), None)

    def _found_in(self, result: Result) -> dict[str, str]:
        found: dict[str, str] = {}
        for end in result.ends:
            if end.guarded is not None:
                found.setdefault("guard", f"a guard kept a command back: {end.guarded}")
            usual = self._seconds.get(end.test)
            if usual is not None and end.wall > self.table.slower * usual + 1.0:
                found.setdefault("time", f"{end.test} took {end.wall:.1f} s, the original {usual:.1f} s")
        if result.overdue is not None:
            found.setdefault("time", result.overdue)
        elif result.end is None:
            found.setdefault("process", result.death())
        return found

    def _stopped(self, surprise: str) -> HardwareStoppedError:
        self.leave.stop(surprise)
        self.log.write(surprise=surprise)
        return HardwareStoppedError(
            f"hardware: stopped at a surprise: {surprise}. The hardware is in its safe state, and what is "
            "known is kept: the next run goes on after it"
        )


@contextmanager
def _itself(executor: HardwareExecutor) -> Iterator[HardwareExecutor]:
    yield executor
