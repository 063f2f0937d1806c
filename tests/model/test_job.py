"""What processes below the tests are told of a job."""

from __future__ import annotations

from typing import Any

from mutabot.model import Clock, Instrumentation, Mutant, Operation, Role, Site, Span, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.job import Job

SITE = Site(Span("a.py", 1, 0, 1, 3, "f"), "x", 1, Role.PROGRAM)
MUTANT = Mutant(1, "conventional", "AOR", SITE, "", None, None, "+", "")
PARTS: dict[str, Any] = {
    "root": "/project", "program": ("a.py",), "oracle": (), "seed": 1, "round": 0, "tests": ("t",),
    "simulated": {"t": 20.0}, "extensions": {"operators": {"x": "package:X"}},
    "instrumentation": Instrumentation(()),
}  # fmt: skip


def test_processes_below_a_fork_get_what_they_need() -> None:
    job = Job(vocabulary=Vocabulary(), reaching={"m": (0,)}, **PARTS)
    below = job.below(MUTANT, Activation.of_text(1, 0))
    assert (below.mutant, below.tests, below.reaching, below.simulated) == (MUTANT, None, {}, {})
    assert below.active == {MUTANT.id: Activation.of_text(1, 0)}
    assert job.is_of_text


def test_where_calls_are_seen_they_count_for_the_limits_of_tests() -> None:
    operations = (Operation("robot:Arm.move", ()),)
    for vocabulary in (Vocabulary(operations=operations), Vocabulary(clock=Clock("robot:now"))):
        below = Job(vocabulary=vocabulary, **PARTS).below(MUTANT, Activation.of_text(1, 0))
        assert (below.simulated, below.extensions) == (PARTS["simulated"], PARTS["extensions"])
