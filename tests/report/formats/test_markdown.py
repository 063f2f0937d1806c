"""Markdown: scores, survivors and what is not judged, with every text as it was."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from mutabot.model import LeftOut, Outcome, Verdict
from mutabot.report.texts import portable
from report.material import HOSTILE, made, shown, stored, with_text
from results import samples


def cells(text: str) -> list[list[str]]:
    """The cells of all tables, as a reader of the page sees them."""
    page = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"]).render(text)
    rows = re.findall(r"<tr>\n(.*?)</tr>", page, re.DOTALL)
    found = []
    for row in rows:
        inner = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, re.DOTALL)
        assert not any("<" in cell for cell in inner), row
        found.append([html.unescape(cell) for cell in inner])
    return found


def test_scores_are_given_per_family_and_role(tmp_path: Path) -> None:
    rows = cells(made("markdown", stored(tmp_path)))
    assert rows[1] == ["robot · program", "3", "58.3 % (3–98 %)", "25.0 %", "3 of 5"]
    assert rows[2][:2] == ["robot · oracle", "2"]


def test_survivors_come_worst_first_with_place_and_reason(tmp_path: Path) -> None:
    text = made("markdown", stored(tmp_path))
    assert "### 2 survivors" in text
    assert "### 1 mutant not covered, since no test reaches the place" in text
    rows = [row for row in cells(text) if len(row) == 6 and row[5].endswith(("of 1", "of 2"))]
    assert [row[0] for row in rows] == ["2"]
    assert "- 1 survivor without a measured effect: mutant 4" in text
    assert rows[0][1:4] == ["mission.py:2", "skip", "gripper.command: do nothing"]
    assert rows[0][4] == "box_position.x: 0.8 instead of 0.488 (off by 0.312)"
    assert text.endswith("`mutabot suggest` searches for checks that kill survivors.\n\n")


def test_what_is_not_judged_says_why(tmp_path: Path) -> None:
    ends = (
        Outcome(samples.SKIP.id, 0, Verdict.REFUSED, message="out of reach"),
        Outcome(samples.REVERSE.id, 0, Verdict.ERROR, message="NaN"),
    )
    text = made("markdown", stored(tmp_path, outcomes=ends, finish="interrupted"))
    assert "**This campaign is not complete** (interrupted): 2 of 10 outcomes are known." in text
    assert "### Not counted in the score: 1 error, 1 refused" in text
    rows = [row for row in cells(text) if len(row) == 5 and row[0] in "12"]
    assert [row[0] for row in rows] == ["1", "2"]
    assert "### 3 mutants not run yet" in text
    assert rows[1][4] == "refused in round 1, not run in round 2: out of reach"


@pytest.mark.parametrize("text", HOSTILE)
def test_every_text_is_shown_as_it_is(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    found = cells(made("markdown", campaign))
    clean = portable(campaign).mutants[1]
    row = next(row for row in found if row[0] == "2")
    assert len(row) == 6
    assert shown([row[3], row[4]]) == shown([clean.mutant.description, clean.why])


def test_of_many_survivors_it_says_how_many_are_not_shown(tmp_path: Path) -> None:
    mutants = tuple(
        samples.mutant(number, f"made-{number}", samples.MOVE, "dx", "other") for number in range(1, 131)
    )
    ends = tuple(Outcome(mutant.id, 0, Verdict.SURVIVED) for mutant in mutants)
    text = made("markdown", stored(tmp_path, mutants=mutants, outcomes=ends))
    assert "and 30 more, which the command line prints." in text
    assert len([row for row in cells(text) if row[1].startswith("mission.py")]) == 100


def test_without_survivors_it_says_so_only_if_something_was_valid(tmp_path: Path) -> None:
    assert "No survivors" in made("markdown", stored(tmp_path / "a", outcomes=samples.OUTCOMES[:2]))
    assert "No survivors" not in made("markdown", stored(tmp_path / "b", outcomes=()))
    part = stored(tmp_path / "c", outcomes=samples.OUTCOMES[:2], finish="interrupted")
    assert "### No survivors so far\n" in made("markdown", part)


def test_what_is_left_out_is_counted_by_reason(tmp_path: Path) -> None:
    assert samples.LEFT_OUT[0] == LeftOut(samples.LEFT_OUT[0].id, "arm.move_by: reverse dy", "it is always 0")
    assert "### 2 mutants left out: it is always 0\n" in made("markdown", stored(tmp_path))
