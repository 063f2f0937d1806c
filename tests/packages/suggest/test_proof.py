"""A failure of a test is blamed on the check that failed; else on all that were added to the test."""

from __future__ import annotations

import pytest

from mutabot_suggest.checks import CheckProposal, Monitor
from mutabot_suggest.project import PlaceInTest
from mutabot_suggest.proof import failing, in_test

FILE = "tests/test_it.py"
PLACE = PlaceInTest("pytest", FILE, f"{FILE}::test_it")
ELSEWHERE = PlaceInTest("pytest", FILE, f"{FILE}::test_other")
LOW = Monitor(place=PLACE, owner="cell", condition="x < 1", name="x stays below 1", distance=1.0)
LOWER = Monitor(place=ELSEWHERE, owner="cell", condition="x < 15", name="x stays below 15", distance=1.0)
TEXTS = {FILE: "\n".join(["def test_it():", LOW.statement, "    assert run(cell)"])}


@pytest.mark.parametrize(
    ("line", "message", "blamed"),
    [
        (2, "", [LOW]),
        (3, "assert not True", []),
        (3, "'x stays below 15' broke at t=4 s", [LOWER]),
        (9, "", []),
    ],
)
def test_a_check_is_blamed_by_its_line_or_by_its_name(
    line: int, message: str, blamed: list[CheckProposal]
) -> None:
    assert failing([LOW, LOWER], f"{FILE}:{line}", message, TEXTS) == blamed


def test_where_no_check_failed_all_in_the_test_are_without_proof() -> None:
    assert in_test([LOW, LOWER], f"{PLACE.node}[red]") == [LOW]
    assert in_test([LOW, LOWER], "tests/test_more.py::test_it") == [LOW, LOWER]
