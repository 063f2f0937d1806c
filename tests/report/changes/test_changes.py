"""What became of survivors since an older campaign: the same mutants as text and as Markdown."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest

from mutabot.model import By, Outcome, Verdict
from mutabot.report.changes import changes
from mutabot.report.sections import Section
from mutabot.report.terminal.console import make_console, print_section, short_place
from mutabot.report.texts import portable
from mutabot.results.results import Results
from report.formats.test_markdown import cells
from report.material import HOSTILE, made, shown, stored, with_text
from results import samples

GONE = samples.mutant(6, "misread", samples.READ, ".x", "tracker.box_position: reads another")
KILLED = (
    Outcome(samples.SKIP.id, 0, Verdict.KILLED, By.CHECK),
    Outcome(samples.SKIP.id, 1, Verdict.KILLED, By.CHECK),
)
#: skip was killed and survives, one survivor is gone, noise is new, reverse survived and is killed
BEFORE = (
    *KILLED,
    Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED),
    Outcome(samples.NEGATE.id, 0, Verdict.SURVIVED),
    Outcome(samples.BY_TO.id, 0, Verdict.SURVIVED),
    Outcome(GONE.id, 0, Verdict.SURVIVED),
)


def both(tmp_path: Path) -> tuple[Results, Results]:
    now = tuple(one for one in samples.OUTCOMES if one.mutant != samples.BY_TO.id)
    old = stored(
        tmp_path / "old", outcomes=BEFORE, mutants=(*samples.MUTANTS[:4], GONE), finish="interrupted"
    )
    return portable(old), portable(stored(tmp_path / "new", outcomes=now))


@pytest.fixture
def found(tmp_path: Path) -> list[Section]:
    return [*changes(*both(tmp_path), short_place)]


def of(found: list[Section], title: str) -> list[str]:
    """The results in the section whose title begins so."""
    (section,) = (one for one in found if one.title.startswith(title))
    assert section.title == f"{title}: {len(section.rows)}"
    return [row[-1] for row in section.rows]


def test_text_tells_every_section_and_what_happened(found: list[Section]) -> None:
    file = io.StringIO()
    for section in found:
        print_section(make_console(file, width=160), section)
    text = file.getvalue()
    assert "The older campaign is not complete: interrupted" in text
    for heading in ("New survivors: 2", "Fixed survivors: 1", "Survivors as before: 1"):
        assert heading in text
    assert "survived in rounds 1 and 2; before: killed by check in rounds 1 and 2" in text
    assert re.search(r"robot · program +66\.7 % +50\.0 % +-16\.7", text)


def test_a_survivor_that_was_not_judged_again_is_not_fixed(found: list[Section]) -> None:
    assert len(of(found, "New survivors")) == 2
    assert len(of(found, "Fixed survivors")) == 1
    unknown = of(found, "Survivors with unknown state now")
    assert [one.partition(";")[0] for one in unknown] == ["not run in rounds 1 and 2", "not in the campaign"]


def test_a_mutant_that_was_not_there_is_said_to_be_new(found: list[Section]) -> None:
    assert any(one.endswith("before: not in the campaign") for one in of(found, "New survivors"))


@pytest.mark.parametrize("again", [[Verdict.KILLED], [Verdict.REFUSED] * 2])
def test_a_survivor_of_which_not_all_rounds_count_is_not_fixed(tmp_path: Path, again: list[Verdict]) -> None:
    old = stored(tmp_path / "old", outcomes=(Outcome(samples.SKIP.id, 0, Verdict.SURVIVED),))
    ends = tuple(
        Outcome(samples.SKIP.id, number, verdict, By.CHECK if verdict is Verdict.KILLED else None)
        for number, verdict in enumerate(again)
    )
    new = stored(tmp_path / "new", outcomes=ends)
    found = [*changes(old, new, short_place)]
    assert of(found, "Fixed survivors") == []
    assert len(of(found, "Survivors with unknown state now")) == 1


def test_equal_campaigns_have_no_changes(tmp_path: Path) -> None:
    _, new = both(tmp_path)
    found = [*changes(new, new, short_place)]
    titles = ("New survivors", "Fixed survivors", "Survivors with unknown state now")
    assert [of(found, title) for title in titles] == [[], [], []]


def test_markdown_has_a_table_for_every_section(tmp_path: Path) -> None:
    old, new = both(tmp_path)
    rows = cells(made("markdown", new, older=old))
    assert ["robot · program", "66.7 %", "50.0 %", "-16.7"] in rows
    (row,) = (row for row in rows if row[4:] and row[4].endswith("before: killed by check in rounds 1 and 2"))
    assert row[1:3] == ["mission.py:2", "skip"]


@pytest.mark.parametrize("text", HOSTILE)
def test_every_text_is_shown_as_it_is(tmp_path: Path, text: str) -> None:
    new = with_text(stored(tmp_path / "new"), text)
    old = with_text(stored(tmp_path / "old", outcomes=KILLED), text)
    rows = [
        row for row in cells(made("markdown", new, older=portable(old))) if len(row) == 5 and row[0] == "2"
    ]
    assert shown([rows[0][3]]) == shown([portable(new).mutants[1].mutant.description])
