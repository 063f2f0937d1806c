"""The line of a ladder: what these rounds showed, and nothing between the magnitudes."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.thresholds.thresholds import describe_violations, ladder_line, magnitude_text
from results.thresholds import journals


@pytest.mark.parametrize(
    ("rounds", "line"),
    [
        (["SSSSCCC"] * 5, "noticed from 20 mm, not at 10 mm (all 5 rounds)"),
        (["CCCCCCC"] * 5, "noticed from the smallest tried, 1 mm (all 5 rounds)"),
        (["SSSSSSS"] * 5, "not noticed up to 100 mm (all 5 rounds)"),
        (["-------"] * 5, "no test reaches it (all 5 rounds)"),
        (["-......"] * 5, "no test reaches it (all 5 rounds)"),
        (
            ["SSSSSCC"] * 3 + ["SSSSCCC"] * 2,
            "noticed in 2 of 5 rounds from 20 mm, in all 5 from 50 mm; in none up to 10 mm",
        ),
        (
            ["SCCCCCC", "SSCCCCC", "SSSCCCC", "SSSSCCC", "SSSSSCC"],
            "noticed in 1 of 5 rounds from 2 mm, in 3 of 5 from 10 mm, in all 5 from 50 mm; "
            "in none up to 1 mm",
        ),
        (
            ["CCCCCCC"] * 2 + ["SSCCCCC"] * 3,
            "noticed in 2 of 5 rounds from the smallest tried, 1 mm, in all 5 from 5 mm",
        ),
        (
            ["SSSSCCC"] * 3 + ["SSSSSSS"] * 2,
            "noticed in 3 of 5 rounds from 20 mm; not noticed up to 100 mm (2 of 5 rounds)",
        ),
        (
            ["SSSSCRR"] + ["SSSSSRR"] * 4,
            "noticed in 1 of 5 rounds from 20 mm; "
            "not noticed up to 20 mm, refused from 50 mm (4 of 5 rounds)",
        ),
        (["SSSSRRR"] * 2, "not noticed up to 10 mm, refused from 20 mm (all 2 rounds)"),
        (["SSSSNNN"] * 2, "not noticed up to 10 mm, without effect above (all 2 rounds)"),
        (["SSSSCRR"] * 2, "noticed from 20 mm, not at 10 mm (all 2 rounds)"),
        (["SSSSTXC"], "noticed from 20 mm, not at 10 mm (1 round)"),
        (["...SC.."] * 2, "noticed from 20 mm, not at 10 mm (all 2 rounds)"),
    ],
)
def test_the_line_of_a_ladder(tmp_path: Path, rounds: list[str], line: str) -> None:
    assert ladder_line(journals.ladder(tmp_path, *rounds)) == line


@pytest.mark.parametrize(
    ("letters", "why"),
    [
        ("RRRRRRR", "the robot refuses every magnitude that was tried"),
        ("NNNNNNN", "has no effect"),
        ("UUUUUUU", "is unstable"),
        ("EEEEEEE", "ended in error"),
        (".......", "was not run"),
        ("SSS....", "is not judged to the end of the ladder"),
        ("SSSSU..", "is not judged to the end of the ladder"),
    ],
)
def test_a_ladder_of_which_nothing_is_known_says_why(tmp_path: Path, letters: str, why: str) -> None:
    found = journals.ladder(tmp_path, letters, letters)
    assert found.why_unjudged == why
    assert found.counted == ()


def test_what_is_unstable_inside_a_bracket_does_not_open_it(tmp_path: Path) -> None:
    found = journals.ladder(tmp_path, "SSSUCCC")
    assert ladder_line(found) == "noticed from 20 mm, not at 5 mm (1 round)"


def test_a_larger_fault_that_is_missed_is_reported(tmp_path: Path) -> None:
    found = journals.ladder(tmp_path, "SSSSCCC", "SSSSCCC", "SSCSSCC")
    assert list(describe_violations(found)) == ["noticed at 5 mm, survives 20 mm, round 3"]
    assert (
        ladder_line(found) == "noticed in 2 of 3 rounds from 20 mm, in all 3 from 50 mm; in none up to 10 mm"
    )


@pytest.mark.parametrize(
    ("magnitude", "unit", "text"),
    [
        (20.0, "mm", "20 mm"),
        (0.05, "fraction", "5 %"),
        (5.0, "percent", "5 %"),
        (3.0, None, "3"),
        (0.1, "s", "0.1 s"),
    ],
)
def test_magnitudes_have_the_unit_that_people_read(magnitude: float, unit: str | None, text: str) -> None:
    assert magnitude_text(magnitude, unit) == text


def test_the_axis_of_a_turn_is_named(tmp_path: Path) -> None:
    found = journals.ladder(tmp_path, "SSSCCCC", direction="z-", unit="deg")
    assert found.name == "arm.move_by dx z −"


def test_other_operators_than_an_offset_are_named(tmp_path: Path) -> None:
    found = journals.ladder(tmp_path, "SSSCCCC", operator="lag", direction="", unit="ms")
    assert found.name == "arm.move_by dx lag"
