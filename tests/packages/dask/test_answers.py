"""Whatever a worker answers: its unit has a result, and so has every other."""

from __future__ import annotations

import copy
import json
import queue
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import observation
from mutabot.campaign.comparison import compare
from mutabot.execution.answer import MOST_BYTES, Answer
from mutabot.execution.task import Result, Task
from mutabot.model import Mutant, Role, Site, Span, Vocabulary
from mutabot.model.codec import to_data
from mutabot.model.events import (
    Acted,
    Called,
    Event,
    ForkEnded,
    ForkTestEnd,
    SessionEnd,
    SiteSeen,
    TestEnd,
    TestStart,
    event_to_data,
)
from mutabot.model.job import Forking, Job
from mutabot.model.mutant import Place
from mutabot_dask.bundle import Bundle
from mutabot_dask.dispatch import Dispatch
from mutabot_dask.link import WorkerReply
from mutabot_dask.roster import Roster
from mutabot_dask.unit import Introduction, InvalidData, SharedData, UnitAnswer, WorkUnit
from mutabot_dask.worker_side import WorkerSession

from .hostile import ODD

SPAN = Span("mission.py", 2, 4, 2, 20, "run")
SITE = Site(SPAN, "arm.move_by", 1, Role.PROGRAM)
TEST = "tests/test_mission.py::test_run"
END = TestEnd(
    TEST, "passed", message="no — none", hits=2, acted=1, away={"outside range": 1}, example=(0.5, -0.5),
    operations=2, commands=1, wall=0.2, cpu=0.1, simulated=2.0, probes={"robot:Arm.x": 0.25}, prepared=1,
    trace=([0, [0.5], None, None], [0, {"dx": -0.5}, [0.25], None]),
    returned=(["arm", [1.5]], ["run", {"raised": "no way"}]), moments=([1, {"robot:Arm.x": 0.5}, True],),
)  # fmt: skip
SITE_LINE, END_LINE = 0, 4
GROUND = SharedData("digest", "/of/the/controller", "", (), {})


def mutant(number: int) -> Mutant:
    return Mutant(number, "robot", "reverse", SITE, "robot:Arm.move_by", None, f"dx{number}", "", "")


def task(number: int) -> Task:
    job = Job(GROUND.root, ("mission.py",), (), Vocabulary(()), 1, 0, tests=(TEST,), mutant=mutant(number))
    return Task(number, job)


def unit(ticket: str = "ticket") -> WorkUnit:
    return WorkUnit(GROUND, task(1), ticket)


def fork_parent(ticket: str = "ticket") -> WorkUnit:
    job = replace(unit().task.job, mutant=None, forking=Forking((mutant(1),)))
    return WorkUnit(GROUND, Task(None, job, is_fork_parent=True), ticket)


def good(ticket: str = "ticket") -> dict[str, Any]:
    """The data of an answer that fits."""
    events = (
        SiteSeen(0, SPAN, "robot:Arm.move_by", None, False),
        Called(0, [0.25], None),
        Acted(""),
        TestStart(TEST),
        END,
        SessionEnd(0, (TEST,)),
    )
    sent = UnitAnswer(Answer([*events], Result(task(1), wall=0.5)), ticket=ticket).data(GROUND.root)
    said, ending, *lines = map(json.loads, sent.splitlines())
    return {"said": said, "ending": ending, "lines": lines}


def packed(data: Any) -> bytes:
    lines = data["lines"] if isinstance(data["lines"], list) else [data["lines"]]
    return b"\n".join(json.dumps(line).encode() for line in (data["said"], data["ending"], *lines))


def changed(change: Callable[[dict[str, Any]], Any]) -> bytes:
    data = good()
    change(data)
    return packed(data)


def events_of(data: bytes, unit: WorkUnit) -> list[Event]:
    """The events in an answer."""
    found = UnitAnswer.of(data, unit).found
    assert found is not None
    return found.events


def test_what_a_worker_saw_arrives() -> None:
    answer = UnitAnswer.of(packed(good()), unit()).found
    assert answer is not None
    found = answer.result
    assert [to_data(end) for end in found.ends] == [to_data(END)]
    assert found.end == SessionEnd(0, (TEST,))


_WRONG: dict[str, bytes] = {
    "no JSON": b"{",
    "no UTF-8": b'{"ticket": "\xff"}',
    "another form of Unicode": json.dumps({"ticket": "ticket"}).encode("utf-16"),
    "no object": b"[]",
    "a line alone": packed(good()).partition(b"\n")[0],
    "a huge line": b'{"ticket": "' + b"x" * (1 << 21) + b'"}',
    "deep": b'{"ticket":' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    "a deep event": packed(good()) + b"\n" + b"[" * 100_000 + b"]" * 100_000,
    "a number of 5,000 digits": b'{"ticket":' + b"9" * 5000 + b"}",
    "an event with a number of 5,000 digits": packed(good()) + b'\n{"type":' + b"9" * 5000 + b"}",
    "a number that is no fraction": changed(
        lambda a: a["lines"][END_LINE]["trace"].append([0, [10**400], None, None])
    ),
    "an answer to something else": packed(good("another")),
    "an unknown field of the message": changed(lambda a: a["said"].update(verdict="killed")),
    "a fault that is no text": changed(lambda a: a["said"].update(fault=7)),
    "an unknown field": changed(lambda a: a["ending"].update(verdict="killed")),
    "a time that is none": changed(lambda a: a["ending"].update(wall=float("nan"))),
    "a time before its beginning": changed(lambda a: a["lines"][END_LINE].update(wall=-1.0)),
    "true for a number": changed(lambda a: a["ending"].update(exit_code=True)),
    "a huge count": changed(lambda a: a["lines"][END_LINE].update(hits=2**70)),
    "a text for a list": changed(lambda a: a.update(lines="abc")),
    "a line of no kind": changed(lambda a: a["lines"].append({"type": "Verdict"})),
    "a line that is no object": changed(lambda a: a["lines"].append(7)),
    "a kind that is no text": changed(lambda a: a["lines"].append({"type": ["TestEnd"]})),
    "a line without its test": changed(lambda a: a["lines"][END_LINE].pop("test")),
    "a line of fork servers": changed(lambda a: a["lines"].append(event_to_data(ForkEnded(1, 1)))),
    "an outcome of a mutant of others": changed(
        lambda a: a["lines"].append(event_to_data(ForkTestEnd(mutant(2).id, END)))
    ),
    "an outcome that there is not": changed(lambda a: a["lines"][END_LINE].update(outcome="great")),
    "a file of others": changed(lambda a: a["lines"][SITE_LINE]["span"].update(file="/etc/passwd")),
    "a file above": changed(lambda a: a["lines"][SITE_LINE]["span"].update(file="../secret.py")),
    "a call at no site": changed(lambda a: a["lines"][END_LINE]["trace"].append([5, None, None, None])),
    "a call that is none": changed(lambda a: a["lines"][END_LINE]["trace"].append(5)),
    "a moment that is none": changed(lambda a: a["lines"][END_LINE].update(moments=[[1]])),
    "a value that was not returned": changed(lambda a: a["lines"][END_LINE].update(returned=[["run", []]])),
    "a recording that is none": changed(lambda a: a["lines"][END_LINE].update(recording="AAAA")),
}  # fmt: skip


@pytest.mark.parametrize("data", _WRONG.values(), ids=_WRONG.keys())
def test_what_is_no_answer_to_a_unit_is_reported(data: bytes) -> None:
    with pytest.raises(InvalidData, match=r".{4}"):
        UnitAnswer.of(data, unit())


def test_an_answer_of_absurd_size_is_not_read() -> None:
    with pytest.raises(InvalidData, match=f"more than {MOST_BYTES}"):
        UnitAnswer.of(packed(good()) + b" " * MOST_BYTES, unit())


def test_a_fork_parent_reports_its_own_mutants_only() -> None:
    data = good()
    data["lines"].append(event_to_data(ForkTestEnd(mutant(1).id, replace(END, trace=()))))
    assert sum(isinstance(line, ForkTestEnd) for line in events_of(packed(data), fork_parent())) == 1
    data["lines"].append(event_to_data(ForkTestEnd(mutant(2).id, replace(END, trace=()))))
    with pytest.raises(InvalidData, match="is not a mutant of this task"):
        UnitAnswer.of(packed(data), fork_parent())


def test_the_unmutated_program_has_the_tests_of_its_unit_and_a_mutant_may_make_others() -> None:
    data = changed(lambda a: a["lines"][END_LINE].update(test="tests/test_other.py::test"))
    with pytest.raises(InvalidData, match="is not a test of this task"):
        UnitAnswer.of(data, fork_parent())
    ends = [line for line in events_of(data, unit()) if isinstance(line, TestEnd)]
    assert [line.test for line in ends] == ["tests/test_other.py::test"]


def test_texts_can_be_stored() -> None:
    data = changed(lambda a: a["lines"][END_LINE].update(message="half \ud83d a sign", exception="\x00"))
    (found,) = (line for line in events_of(data, unit()) if isinstance(line, TestEnd))
    assert found.message == "half \\ud83d a sign"


def test_a_worker_does_not_send_what_would_not_be_taken(tmp_path: Path) -> None:
    """What its process reports is the mutant's doing, not the worker's: it is not left out for it."""
    session = WorkerSession(tmp_path, GROUND)
    data = session._acceptable(changed(lambda a: a["lines"][END_LINE].update(hits="many")), unit())
    answer = UnitAnswer.of(data, unit())
    assert answer.lost is not None
    assert "events[4] (TestEnd): TypeError: a whole number was expected, not str" in answer.lost


def odd_bytes(random: random.Random) -> bytes:
    """Bytes at random, or an answer with something at random in it."""
    if random.random() < 0.3:
        return random.randbytes(random.randrange(300))
    data = packed(good("*"))
    if random.random() < 0.4:
        place = random.randrange(len(data))
        return data[:place] + random.randbytes(random.randrange(1, 4)) + data[place + random.randrange(4) :]
    tree = good("*")
    for _ in range(random.randrange(1, 4)):
        holder, key = random.choice(list(_places(tree)))
        holder[key] = copy.deepcopy(random.choice(ODD))
    return packed(tree)


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in list(items):
        yield tree, key
        yield from _places(value)


class FakeLink:
    """Workers that answer at once: every second unit rightly, the others with something odd."""

    is_lost = False
    address = "tls://nowhere:1"

    def __init__(self, odd: dict[int, bytes]) -> None:
        self.replies: queue.SimpleQueue[WorkerReply] = queue.SimpleQueue()
        self.workers = {f"tls://worker{number}:1": 1 for number in range(len(odd) + 5)}
        self._odd, self._numbers = odd, count(1)

    def ask(self, worker: str, function: Callable[..., bytes], *given: Any) -> int:
        number = next(self._numbers)
        answer = Introduction({}, has=True).data()
        if function.__name__ == "run_unit":
            asked = WorkUnit.of(given[0])
            data = packed(good(asked.ticket))
            assert asked.task.job.mutant is not None
            if asked.task.job.mutant.number in self._odd:
                odd = self._odd[asked.task.job.mutant.number]
                data = odd.replace(b'"ticket": "*"', b'"ticket": "' + asked.ticket.encode() + b'"')
            answer = data
        self.replies.put(WorkerReply(number, answer))
        return number

    def forget(self, *numbers: int) -> None:
        pass


class FakeCluster:
    """A cluster that is only asked."""

    done, ground = 0, GROUND

    def __init__(self, odd: dict[int, bytes]) -> None:
        self.told: list[str] = []
        self.link = FakeLink(odd)
        self.roster = Roster(self.link, {}, self.tell, Bundle("digest", "", b"", 0, ()))  # type: ignore[arg-type]

    def tell(self, text: str) -> None:
        self.told.append(text)

    def restart_workers(self) -> None:
        pass


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.whole)])
def test_a_thousand_odd_answers_cost_no_other_outcome(seed: int) -> None:
    chance = random.Random(seed)
    odd = {2 * number: odd_bytes(chance) for number in range(1, 501)}
    there = FakeCluster(odd)
    dispatch = Dispatch(there, iter([task(number) for number in range(1, 1001)]))  # type: ignore[arg-type]
    results = {
        answer.result.task.key: answer.result for answer in dispatch.answers() if isinstance(answer, Answer)
    }
    assert set(results) == set(range(1, 1001))
    for number, found in results.items():
        if number not in odd:
            assert [to_data(end) for end in found.ends] == [to_data(END)]
            continue
        if found.lost is not None:
            assert not found.ends
            continue
        # it is an answer of a worker that may say so: whatever is made of it raises nothing
        place = Place(SITE, "robot:Arm.move_by", None)
        original = observation(END, {0: place})
        for end in found.ends:
            compare(original, observation(end, {site.index: place for site in found.sites}))
            json.dumps(to_data(end)).encode()
    lost = [found for found in results.values() if found.lost is not None]
    assert len(lost) > 300
    assert len(there.roster.refusals) == len(lost)
    assert all("does not fit" in str(found.lost) for found in lost)
    assert all(text.isprintable() for text in there.told)
    assert len(there.told) <= 11
