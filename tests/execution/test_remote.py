"""What an executor of other machines runs there, and what stays on this one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from mutabot.execution.answer import Answer
from mutabot.execution.remote import RemoteExecutor
from mutabot.execution.task import Result, Task
from mutabot.model import Mutant, Role, Site, Span, Vocabulary
from mutabot.model.deadline import Limit
from mutabot.model.events import Event, ForkDied, SessionEnd
from mutabot.model.job import Forking, Job

SITE = Site(Span("mission.py", 2, 4, 2, 20, "run"), "arm.move_by", 1, Role.PROGRAM)


def mutant(number: int) -> Mutant:
    return Mutant(number, "robot", "reverse", SITE, "robot:Arm.move_by", None, f"dx{number}", "", "")


def task(key: str, mutant: Mutant | None, *, alone: bool = False) -> Task:
    job = Job("/cell", ("mission.py",), (), Vocabulary(()), 1, 0, tests=("a", "b"), mutant=mutant)
    return Task(key, job, alone=alone)


def fork_parent() -> Task:
    found = task("forks", None)
    forking = Forking((mutant(1), mutant(2)), limit=Limit(1.0))
    return replace(found, job=replace(found.job, forking=forking), is_fork_parent=True)


class Here:
    """This machine: it runs whatever it is given."""

    spread, remarks = 1, ()

    def __init__(self) -> None:
        self.ran: list[Task] = []

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        for given in tasks:
            self.ran.append(given)
            yield Result(given, log="here")


class There(RemoteExecutor):
    """Another machine, which stops taking tasks where ``end`` gives no answer."""

    spread, remarks = 2, ()

    def __init__(self, end: Callable[[Task], Answer | None]) -> None:
        self.here = Here()
        super().__init__(self.here)  # type: ignore[arg-type]
        self._end = end

    def answers(self, tasks: Iterator[Task]) -> Iterator[Answer | Task]:
        for given in tasks:
            found = self._end(given)
            yield found or given
            if found is None:
                return


def answer(task: Task) -> Answer:
    return Answer([SessionEnd()], Result(task, log="there"))


def where(found: Iterable[Result | tuple[Task, Event]]) -> dict[str, str]:
    return {event.task.key: event.log for event in found if isinstance(event, Result)}


def test_the_original_and_what_nothing_may_run_beside_stay_here() -> None:
    there = There(answer)
    tasks = [task("mutant", mutant(1)), task("original", None), task("alone", mutant(1), alone=True)]
    found = list(there.events(tasks))
    assert where(found) == {"mutant": "there", "original": "here", "alone": "here"}
    assert [event[0].key for event in found if not isinstance(event, Result)] == ["mutant"]


def test_no_other_machine_is_asked_for_the_original() -> None:
    def refuse(task: Task) -> Answer:
        raise AssertionError(task.key)

    assert where(There(refuse).events([task("original", None)])) == {"original": "here"}


def test_what_a_wall_clock_ended_there_is_run_again_here() -> None:
    there = There(lambda task: Answer([SessionEnd()], Result(task, overdue="1 s of wall clock", log="there")))
    assert list(there.events([task("mutant", mutant(1))])) == [Result(task("mutant", mutant(1)), log="here")]


def test_of_forks_that_a_wall_clock_ended_there_only_these_are_run_again_here() -> None:
    died = [ForkDied(mutant(1).id, "a", -9, overdue="1 s"), ForkDied(mutant(2).id, "a", -9)]
    there = There(lambda task: Answer([*died], Result(task, log="there")))
    found = list(there.events([fork_parent()]))
    assert [event[1] for event in found if not isinstance(event, Result)] == [died[1]]
    assert where(found) == {"forks": "here"}
    (again,) = there.here.ran
    assert again.job.forking is not None
    assert [candidate.id for candidate in again.job.forking.mutants] == [mutant(1).id]


def test_what_other_machines_give_back_or_do_not_take_runs_here() -> None:
    there = There(lambda task: answer(task) if task.key == "first" else None)
    tasks = [task(key, mutant(1)) for key in ("first", "given back", "not taken")]
    assert where(there.events(tasks)) == {"first": "there", "given back": "here", "not taken": "here"}
