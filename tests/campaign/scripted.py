"""An executor without processes: it answers each task by the text of a small project and by a script.

What decides over results rather than makes them is tested with it: judge, controls, repeats, plan, reuse,
shards, ``since`` and the search. Sites, traces and which test reaches what are read off the text: a test of
``tests/`` reaches the functions of the program whose names it mentions, and these make their calls in their
order, once. How a test ends as a mutant is what the script says; controls end as they must.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mutabot.campaign.request import Request
from mutabot.execution.interruption import Interruption
from mutabot.execution.task import Executor, Result, Task
from mutabot.families import CONTROL
from mutabot.model import By, Mutant, Operation, Quantity, Span, TextPlace
from mutabot.model.events import (
    Acted,
    CallsAsked,
    Event,
    ForkDied,
    ForkSessionEnd,
    ForkTestEnd,
    PlacesReached,
    SessionEnd,
    SiteSeen,
    TestControls,
    TestEnd,
    TestStart,
    TextsSeen,
    Unforked,
)
from mutabot.model.job import Job
from mutabot.model.program_text import Sighting
from mutabot.model.source_units import Executed, File, is_test_file
from mutabot.operators.command import Fatal, Identity

#: what a robot answers that is asked for a number
READING = 0.5
#: a test that notices its mutant, one that the mutant ends, and one whose robot refuses the mutated command
CHECKED: Mapping[str, Any] = {
    "outcome": "failed", "by": By.CHECK, "exception": "builtins:AssertionError", "message": "assert 1 == 2",
}  # fmt: skip
CRASHED: Mapping[str, Any] = {
    "outcome": "failed", "by": By.EXCEPTION, "exception": "builtins:RuntimeError", "message": "it went wrong",
}  # fmt: skip
REFUSED: Mapping[str, Any] = {**CRASHED, "exception": "robot:Refused", "refused": "out of reach"}
#: a test whose mutant changes nothing
UNCHANGED: Mapping[str, Any] = {"acted": 0}


@dataclass(frozen=True, slots=True)
class Run:
    """One test in one process.

    Attributes:
        test: the test.
        tests: all that the process runs.
        round: the round.
        mutant: the mutant that it is; None for the original.
        before: how often the suite, or this mutant, was run before in this round.
        is_fork: whether it is a fork of the original.
        is_short: whether tests are left out.
    """

    test: str
    tests: tuple[str, ...]
    round: int
    mutant: Mutant | None
    before: int
    is_fork: bool = False
    is_short: bool = False


@dataclass(frozen=True, slots=True)
class Died:
    """The process ends during the test, without a word; ``acted``: after its mutant has changed something."""

    exit_code: int = -9
    overdue: str | None = None
    acted: bool = True


End = Mapping[str, Any] | Died


@dataclass(slots=True)
class Script:
    """How the tests of a project end, which any executor would have to find out.

    Attributes:
        mutated: how a test ends as a mutant: fields of its ``TestEnd`` that are not those of a survivor.
        original: likewise as the original.
        control: likewise as a control; None for the end that it must have.
        test_control: likewise as the identity that is forked for one test alone; None for as the original.
        interrupts: whether somebody interrupts the campaign after an event.
        spread: as in ``Executor``.
        tasks: all tasks until now.
    """

    mutated: Callable[[Run], End] = lambda run: {}
    original: Callable[[Run], End] = lambda run: {}
    control: Callable[[Run], End | None] = lambda run: None
    test_control: Callable[[Run], Mapping[str, Any] | None] = lambda run: None
    interrupts: Callable[[Event], bool] = lambda event: False
    spread: int = 1
    tasks: list[Task] = field(default_factory=list)

    def kill(self, *words: str) -> None:
        """Mutants whose ids contain one of these words are noticed; all others survive."""
        self.mutated = lambda run: CHECKED if any(word in _id(run) for word in words) else {}

    @contextmanager
    def opened(self, request: Request, progress: object) -> Iterator[Executor]:
        """In place of ``open_executor``."""
        yield Scripted(self, _Suite.read(request))

    def end(self, run: Run) -> End:
        if run.mutant is None:
            return self.original(run)
        if run.mutant.family != CONTROL:
            return self.mutated(run)
        found = self.control(run)
        return found if found is not None else CRASHED if run.mutant.operator == Fatal.name else UNCHANGED


@dataclass(slots=True)
class Scripted:
    """The executor; see ``Executor``."""

    script: Script
    suite: _Suite
    remarks: Sequence[str] = ()
    _times: Counter[object] = field(default_factory=Counter)
    _under_way: Iterator[Result | tuple[Task, Event]] = field(default_factory=lambda: iter(()))
    _is_interrupted: bool = False

    @property
    def spread(self) -> int:
        return self.script.spread

    def apart(self) -> AbstractContextManager[Executor]:
        return nullcontext(self)

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        return (event for event in self.events(tasks) if isinstance(event, Result))

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        self._under_way = self._told(tasks)
        for event in self._under_way:
            yield event
            if isinstance(event, tuple) and self.script.interrupts(event[1]):
                self._is_interrupted = True
                raise Interruption

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        while is_awaited() and (event := next(self._under_way, None)) is not None:
            yield event

    def _told(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        for task in tasks:
            self.script.tasks.append(task)
            result = Result(task, wall=0.1)
            for line in self._lines(task.job, result):
                result.take(line)
                yield task, line
            yield result

    def _lines(self, job: Job, result: Result) -> Iterator[Event]:
        tests = job.tests if job.tests is not None else tuple(self.suite.tests)
        before = self._count(job.mutant, job.round)
        found = {
            mutant.id: self._count(mutant, job.round)
            for mutant in (job.forking.mutants if job.forking else ())
        }
        forked: dict[str, int] = {}
        yield from self.suite.sites
        if job.record and job.mutant is None:
            yield CallsAsked(self.suite.imported)
        places = self._places(job)
        if places:
            files = {place.span.file for place in places}
            yield TextsSeen(
                tuple(sorted(files)), tuple(Sighting(place.number, 1, ("number",)) for place in places)
            )
        left_out = job.left_out(job.mutant.id) if job.mutant is not None else frozenset()
        for test in tests:
            if test in left_out:
                continue
            run = Run(test, tests, job.round, job.mutant, before, is_short=bool(left_out))
            yield TestStart(test)
            reached = tuple(
                place.number for place in places if place.span.function in self.suite.tests[test].functions
            )
            if reached:
                yield PlacesReached(test, reached)
            if job.forking is not None:
                yield from self._forks(job, run, found, forked)
            end = self.script.end(run)
            if isinstance(end, Died):
                if job.mutant is not None and end.acted:
                    yield Acted(test)
                result.exit_code, result.overdue = end.exit_code, end.overdue
                return
            ended = self.suite.end(run, end)
            if ended.acted:
                yield Acted(test)
            yield ended
            result.exit_code = result.exit_code or int(ended.outcome == "failed")
            if job.stop_at_kill and ended.is_decided:
                break
        yield from (ForkSessionEnd((mutant,), code) for mutant, code in forked.items())
        yield SessionEnd(0, tuple(self.suite.tests))

    def _forks(
        self, job: Job, fork_parent: Run, found: dict[str, int], forked: dict[str, int]
    ) -> Iterator[Event]:
        """What forks do in one test: from the first on that reaches them, to one that decides."""
        assert job.forking is not None
        due = [
            candidate
            for candidate in job.forking.mutants
            if candidate.id in found and candidate.id not in forked
        ]
        if due := [candidate for candidate in due if self.suite.tests[fork_parent.test].hits(candidate)]:
            control = replace(due[0], family=CONTROL, operator=Identity.name, variant=fork_parent.test)
            run = replace(fork_parent, mutant=control, is_fork=True)
            original = self.script.original(fork_parent)
            end = self.script.test_control(run) or ({} if isinstance(original, Died) else original)
            ended = self.suite.end(run, {**UNCHANGED, **end})
            yield ForkTestEnd(control.id, ended, self.suite.sites, is_test_control=True)
            yield TestControls(fork_parent.test, 1)
        for mutant in job.forking.mutants:
            is_due = mutant.id in forked or self.suite.tests[fork_parent.test].hits(mutant)
            left_out = job.left_out(mutant.id)
            if mutant.id not in found or not is_due or fork_parent.test in left_out:
                continue
            if self._is_interrupted:
                yield Unforked(fork_parent.test, (mutant.id,), "the campaign was interrupted")
                del found[mutant.id]
                forked.pop(mutant.id, None)
                continue
            forked.setdefault(mutant.id, 0)
            run = replace(
                fork_parent, mutant=mutant, before=found[mutant.id], is_fork=True, is_short=bool(left_out)
            )
            end = self.script.end(run)
            if isinstance(end, Died):
                yield ForkDied(mutant.id, run.test, end.exit_code, end.overdue, acted=end.acted)
                del found[mutant.id], forked[mutant.id]
                continue
            ended = self.suite.end(run, end)
            yield ForkTestEnd(mutant.id, ended, self.suite.sites)
            forked[mutant.id] = forked[mutant.id] or int(ended.outcome == "failed")
            if ended.is_decided and not job.forking.every_test:
                del found[mutant.id], forked[mutant.id]

    @staticmethod
    def _places(job: Job) -> list[TextPlace]:
        """The places of the program text that a recording looks at."""
        if job.instrumentation is None or not job.instrumentation.record:
            return []
        return [place for text in job.instrumentation.texts for place in text.places]

    def _count(self, mutant: Mutant | None, round: int) -> int:
        key = mutant.id if mutant is not None else None, round
        self._times[key] += 1
        return self._times[key] - 1


@dataclass(frozen=True, slots=True)
class _Call:
    """A call of an operation in the program's text."""

    site: SiteSeen
    written: dict[str, Any]
    read: dict[str, Any]

    @property
    def trace(self) -> list[Any]:
        return [self.site.index, self.written, self.read, next(iter(self.read.values()), None)]


@dataclass(frozen=True, slots=True)
class _Test:
    """A test of the project.

    Attributes:
        functions: the functions of the program that it mentions.
        calls: what these call.
        place: where it ends, which is where it fails.
        executed: what it executes: these functions, itself, and all of files that are no program; it counts
            for the tests after it, too.
    """

    functions: frozenset[str]
    calls: tuple[_Call, ...]
    place: str
    executed: Executed

    def hits(self, mutant: Mutant) -> int:
        """How often the test reaches a mutant: its call, or the text of a function."""
        span = mutant.site.span
        if mutant.operation:
            return sum(call.site.span == span for call in self.calls)
        return int(span.function in self.functions)


@dataclass(frozen=True, slots=True)
class _Suite:
    """The tests of a project in their order."""

    tests: Mapping[str, _Test]

    @classmethod
    def read(cls, request: Request) -> _Suite:
        """As the files stand now."""
        operations = {
            operation.target.rpartition(".")[2]: operation for operation in request.vocabulary.operations
        }
        program = request.configuration.program
        calls = {
            name: found for file in program for name, found in _functions(request.root, file, operations)
        }
        order = {
            id(call): number
            for number, call in enumerate(call_seen for some in calls.values() for call_seen in some)
        }
        numbered = {
            name: [
                replace(call_seen, site=replace(call_seen.site, index=order[id(call_seen)]))
                for call_seen in some
            ]
            for name, some in calls.items()
        }
        tests = {}
        for path in sorted(request.root.glob("tests/**/*.py")):
            file = path.relative_to(request.root).as_posix()
            for node in ast.walk(_parsed(path)):
                if not isinstance(node, ast.FunctionDef) or not node.name.startswith("test"):
                    continue
                names = {_name(inner) for inner in ast.walk(node)}
                found = tuple(call for name, some in numbered.items() if name in names for call in some)
                functions = frozenset(name for name in numbered if name in names)
                executed = _executed(request.root, program, functions, file, node.name)
                place = f"{file}:{node.end_lineno}"
                tests[f"{file}::{node.name}"] = _Test(functions, found, place, executed)
        return cls(tests)

    @property
    def sites(self) -> tuple[SiteSeen, ...]:
        found = {call.site.index: call.site for test in self.tests.values() for call in test.calls}
        return tuple(found[index] for index in sorted(found))

    @property
    def imported(self) -> tuple[str, ...]:
        """The files of the program of which a test executes anything."""
        return tuple(sorted({file for test in self.tests.values() for file in test.executed}))

    def end(self, run: Run, end: Mapping[str, Any]) -> TestEnd:
        """The report of a test that ends like this, beside what the text says."""
        test = self.tests[run.test]
        hits = test.hits(run.mutant) if run.mutant is not None else 0
        if run.mutant is not None and run.mutant.family == CONTROL and not hits:
            end = {}
        is_failed = end.get("outcome") == "failed"
        usual = {
            "outcome": "passed",
            "hits": hits,
            "acted": hits,
            "operations": len(test.calls),
            "commands": sum(1 for call in test.calls if call.written),
            "wall": 0.01,
            "cpu": 0.01,
            "trace": tuple(call.trace for call in test.calls),
            "example": (0, 1) if hits else None,
            "place": test.place if is_failed else None,
            "executed": test.executed,
        }
        return TestEnd(run.test, **{**usual, **end})


def _executed(
    root: Path, program: Sequence[str], functions: Collection[str], test_file: str, test: str
) -> Executed:
    found: dict[str, tuple[int, ...]] = {}
    for path in sorted(root.glob("**/*.py")):
        name = path.relative_to(root).as_posix()
        file = File(name, path.read_bytes())
        names = set(file.digests)
        if name in program or is_test_file(name):
            wanted = {"", test} if name == test_file else {"", *functions} if name in program else {""}
            names &= wanted
        found[name] = file.lines_of(names)
    return found


def _functions(
    root: Path, file: str, operations: Mapping[str, Operation]
) -> Iterator[tuple[str, list[_Call]]]:
    """The functions of a file with the calls that they make, in their order."""
    for function in ast.walk(_parsed(root / file)):
        if isinstance(function, ast.FunctionDef):
            ends = next(
                (n for n, statement in enumerate(function.body, 1) if isinstance(statement, ast.Return)), None
            )
            reached = (node for statement in function.body[:ends] for node in ast.walk(statement))
            nodes = [node for node in reached if isinstance(node, ast.Call)]
            nodes.sort(key=lambda node: (node.end_lineno or 0, node.end_col_offset or 0))
            found = ((node, operations.get(_name(node.func) or "")) for node in nodes)
            yield (
                function.name,
                [_call(file, function.name, node, call) for node, call in found if call is not None],
            )


def _call(file: str, function: str, node: ast.Call, operation: Operation) -> _Call:
    span = Span(file, node.lineno, node.col_offset, node.end_lineno or 0, node.end_col_offset or 0, function)
    site = SiteSeen(-1, span, operation.target, None, oracle=False, direct=True)
    written = [_literal(argument) for argument in node.args]
    return _Call(site, _values(operation.arguments, written), _values(operation.result, [READING]))


def _literal(node: ast.expr) -> Any:
    """What is written there; what only a run would tell counts as what a robot answers."""
    try:
        return ast.literal_eval(node)
    except ValueError:
        return READING


def _values(quantities: Sequence[Quantity], values: Sequence[Any]) -> dict[str, Any]:
    return {quantity.name: value for quantity, value in zip(quantities, values, strict=False)}


def _name(node: ast.AST) -> str | None:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else None


def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _id(run: Run) -> str:
    return run.mutant.id if run.mutant is not None else ""
