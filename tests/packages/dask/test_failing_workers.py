"""A worker at which units fail gets no more of them, and a lost unit goes to another worker."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any

import pytest

from mutabot.execution.answer import Answer
from mutabot.execution.task import Result
from mutabot_dask import dispatch as dispatching
from mutabot_dask.dispatch import Dispatch
from mutabot_dask.link import WorkerReply
from mutabot_dask.unit import Introduction, WorkUnit

from .test_answers import FakeCluster, FakeLink, good, packed, task

pytestmark = pytest.mark.needs("dask")
#: whether a unit fails at a worker, by the number of its mutant
Fails = Callable[[str, int], bool]


class Link(FakeLink):
    """Workers of which some fail."""

    def __init__(self, names: tuple[str, ...], fails: Fails) -> None:
        super().__init__({})
        self.workers = dict.fromkeys(names, 1)
        self.given: list[tuple[str, int]] = []
        self._fails, self._ids = fails, count(1)

    def ask(self, worker: str, function: Callable[..., bytes], *given: Any) -> int:
        number = next(self._ids)
        if function.__name__ != "run_unit":
            self.replies.put(WorkerReply(number, Introduction({}, has=True).data()))
            return number
        asked = WorkUnit.of(given[0])
        assert asked.task.job.mutant is not None
        mutant = asked.task.job.mutant.number
        self.given.append((worker, mutant))
        failed = self._fails(worker, mutant)
        self.replies.put(
            WorkerReply(number, None, "no space")
            if failed
            else WorkerReply(number, packed(good(asked.ticket)))
        )
        return number


def ran(names: tuple[str, ...], fails: Fails, units: int = 14) -> tuple[FakeCluster, Link, dict[int, Result]]:
    there = FakeCluster({})
    link = Link(names, fails)
    there.link = there.roster.link = link  # type: ignore[assignment]
    dispatch = Dispatch(there, iter([task(number) for number in range(1, units + 1)]))  # type: ignore[arg-type]
    return (
        there,
        link,
        {
            answer.result.task.key: answer.result
            for answer in dispatch.answers()
            if isinstance(answer, Answer)
        },
    )


@pytest.mark.parametrize("bad", [("bad",), ("bad", "worse"), ("bad", "worse", "worst")])
def test_a_worker_at_which_two_units_fail_gets_no_more(bad: tuple[str, ...]) -> None:
    there, link, results = ran((*bad, "good"), lambda worker, mutant: worker != "good")
    assert all(result.lost is None for result in results.values())
    assert len(results) == 14
    for worker in bad:
        assert sum(name == worker for name, _ in link.given) == 2
        assert any(f"worker {worker} is not used: 2 units failed there" in text for text in there.told)
    assert there.roster.usable == ["good"]


def test_no_unit_goes_twice_to_a_worker_that_it_was_lost_at() -> None:
    _, link, results = ran(("one", "two", "three"), lambda worker, mutant: mutant == 5)
    tries = [worker for worker, mutant in link.given if mutant == 5]
    assert set(tries[:3]) == {"one", "two", "three"}
    assert len(tries) == dispatching.TRIES
    assert results[5].lost is not None


def test_units_that_fail_everywhere_leave_no_worker_out() -> None:
    there, _, results = ran(("one", "two"), lambda worker, mutant: mutant in (8, 9, 10, 11))
    assert {number for number, result in results.items() if result.lost is not None} == {8, 9, 10, 11}
    assert there.roster.usable == ["one", "two"]


def test_a_worker_that_fails_later_is_left_out_as_well() -> None:
    """As one whose disk has become full."""
    seen: list[int] = []

    def fails(worker: str, mutant: int) -> bool:
        seen.append(mutant)
        return worker == "one" and len(seen) > 6

    there, _, results = ran(("one", "two"), fails)
    assert all(result.lost is None for result in results.values())
    assert there.roster.usable == ["two"]
