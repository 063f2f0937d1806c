"""What no check kills is told with what differs, and with what is no difference."""

from __future__ import annotations

import pytest

from mutabot.model import Mutant, Role, Site, Span
from mutabot.suggest.candidates import candidates
from mutabot.suggest.measure import Measured
from mutabot.suggest.project import Project
from mutabot.suggest.readings import PROBE, Reading
from mutabot.suggest.style import Place
from mutabot.suggest.suggest import why_unsolved

SITE = Site(Span("mission.py", 1, 0, 1, 5, "run"), "arm.go", 1, Role.PROGRAM)
MUTANT = Mutant(1, "robot", "skip", SITE, "robot:go", None, None, "", "arm.go: do nothing")
PLACE = Place("pytest", "tests/test_it.py", "tests/test_it.py::test_it")


def measured(originals: list[float], mutant: float, tolerance: float) -> Measured:
    """One reading of one test, in as many rounds as there are values; the mutant is run in the first."""
    return Measured(
        originals={PLACE: {(round, PLACE.node): {"box.x": value} for round, value in enumerate(originals)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): {"box.x": mutant}}}},
        readings={PLACE: [Reading("box.x", PROBE, tolerance)]},
    )


@pytest.mark.parametrize(
    ("mutant", "tolerance", "said"),
    [
        (0.1, 0.001, "nothing differs"),
        (0.103, 0.001, "box.x differs by 0.003, the original itself spreads 0.005"),
        (0.103, 0.01, "box.x differs by 0.003, its tolerance is 0.01"),
    ],
)
def test_a_difference_within_the_spread_kills_nothing_and_is_told(
    mutant: float, tolerance: float, said: str
) -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], mutant, tolerance)
    assert candidates(Project(None), found) == []  # type: ignore[arg-type]  # no project is needed for an end
    assert why_unsolved(MUTANT, found, [], _Unproven()).reason.startswith(said)  # type: ignore[arg-type]


@pytest.mark.parametrize(("mutant", "kills"), [(10.72, False), (10.73, True)])
@pytest.mark.parametrize("seen", [{}, {"step box.x": 0.01}])
def test_what_comes_in_steps_may_be_one_step_off(mutant: float, kills: bool, seen: dict[str, float]) -> None:
    """As a time of a simulation: all runs end at the same tick, and then one ends at the next."""
    found = measured([10.71] * 20, mutant, 0.001)
    if seen:
        found.originals = {PLACE: {key: {"box.x": 10.7, **seen} for key in found.originals[PLACE]}}
        found.mutants = {PLACE: {MUTANT.id: {(0, PLACE.node): {"box.x": mutant - 0.01, **seen}}}}
    assert bool(candidates(Project(None), found)) is kills  # type: ignore[arg-type]


def test_a_difference_beyond_the_band_is_a_check() -> None:
    found = measured([0.1, 0.105, 0.102, 0.104, 0.101, 0.103], 0.5, 0.001)
    (check,) = candidates(Project(None), found)  # type: ignore[arg-type]
    assert check.trials == {(MUTANT.id, 0)}
    assert check.statement.startswith("assert box.x == pytest.approx(0.102")


@pytest.mark.parametrize(("label", "other"), [("red", "blue"), (1, 2), (True, False)])
def test_what_differs_by_design_is_held_against_what_decides_it(label: object, other: object) -> None:
    reads = [{"colour": one, "box.x": 1.0 if one == label else 5.0} for one in [label, other] * 6]
    found = Measured(
        originals={PLACE: {(round, PLACE.node): read for round, read in enumerate(reads)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): {"colour": label, "box.x": 5.0}}}},
        readings={PLACE: [Reading("box.x", PROBE, 0.001), Reading("colour", PROBE, 0.001)]},
    )
    (check,) = candidates(Project(None), found)  # type: ignore[arg-type]
    assert check.expected.label == "colour"
    assert check.lines[-1] == "assert box.x == pytest.approx(expected, abs=0.001)"


def test_what_no_label_decides_may_be_as_far_from_something_else() -> None:
    places = [0.1234567 * number % 1 for number in range(12)]
    reads = [{"target.x": place, "box.x": place + 0.2} for place in places]
    found = Measured(
        originals={PLACE: {(round, PLACE.node): read for round, read in enumerate(reads)}},
        mutants={PLACE: {MUTANT.id: {(0, PLACE.node): {"target.x": places[0], "box.x": places[0]}}}},
        readings={PLACE: [Reading("box.x", PROBE, 0.001), Reading("target.x", PROBE, 0.001)]},
    )
    statements = {check.statement for check in candidates(Project(None), found)}  # type: ignore[arg-type]
    assert "assert box.x - target.x == pytest.approx(0.2, abs=0.001)" in statements


class _Unproven:
    """A proof in which nothing failed."""

    failed: dict[object, str] = {}  # noqa: RUF012
