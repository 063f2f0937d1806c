"""What differs between two campaigns: the same mutants as text, as JSON and as Markdown."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.model import By, Outcome, Verdict
from mutabot.report.changes import change_lines, print_changes
from mutabot.report.document import data_of, dumps
from mutabot.report.terminal.console import make_console
from mutabot.report.texts import portable
from mutabot.results.stored import Changes, changes
from report.formats.test_markdown import cells
from report.material import HOSTILE, made, shown, stored, with_text
from results import samples

PAGE = Path(__file__).parents[3] / "docs" / "reports.md"
GONE = samples.mutant(6, "misread", samples.READ, ".x", "tracker.box_position: reads another")
KILLED = (
    Outcome(samples.SKIP.id, 0, Verdict.KILLED, By.CHECK),
    Outcome(samples.SKIP.id, 1, Verdict.KILLED, By.CHECK),
)


@pytest.fixture
def found(tmp_path: Path) -> Changes:
    """Skip was killed and survives, one mutant is gone, noise is new, reverse survived and is killed."""
    before = (
        *KILLED,
        Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED),
        Outcome(samples.NEGATE.id, 0, Verdict.SURVIVED),
        Outcome(samples.BY_TO.id, 0, Verdict.SURVIVED),
    )
    now = tuple(one for one in samples.OUTCOMES if one.mutant != samples.BY_TO.id)
    old = stored(
        tmp_path / "old", outcomes=before, mutants=(*samples.MUTANTS[:4], GONE), finish="interrupted"
    )
    new = stored(tmp_path / "new", outcomes=now)
    return changes(portable(old), portable(new))


def test_text_tells_every_section_and_what_happened(found: Changes) -> None:
    file = io.StringIO()
    print_changes(make_console(file, width=160), found)
    text = file.getvalue()
    first, second = text.splitlines()[:2]
    assert first == "Survivors: 2 new, 1 fixed, 1 changed, 0 as before, 1 unknown; mutants: 1 new, 1 removed"
    assert second == "the old campaign is not complete: interrupted"
    for heading in ("New survivors: 2", "Fixed survivors: 1", "Removed mutants: 1"):
        assert heading in text
    assert "survived in rounds 1 and 2; before: killed by check in rounds 1 and 2" in text
    assert re.search(r"robot · program +66\.7 % +50\.0 % +-16\.7", text)


def test_json_has_the_same_mutants(found: Changes) -> None:
    data = json.loads(dumps(data_of(found)), parse_constant=pytest.fail)
    assert [one["id"] for one in data["new_survivors"]] == [samples.SKIP.id, samples.NOISE.id]
    assert [one["id"] for one in data["fixed_survivors"]] == [samples.REVERSE.id]
    assert [one["id"] for one in data["changed_survivors"]] == [samples.NEGATE.id]
    assert [one["id"] for one in data["unknown_survivors"]] == [samples.BY_TO.id]
    assert [one["id"] for one in data["gone_mutants"]] == [GONE.id]
    assert [one["id"] for one in data["new_mutants"]] == [samples.NOISE.id]
    first = data["new_survivors"][0]
    assert (first["old"]["status"], first["new"]["status"]) == ("killed", "survived")
    assert data["gone_mutants"][0]["new"] is None
    assert data["groups"][0]["new"]["score"] == 0.5
    assert data["old_state"] == "interrupted"


def test_every_key_of_the_json_is_documented(found: Changes) -> None:
    text = PAGE.read_text(encoding="utf-8").partition("With `--json`:")[2].partition("\n## ")[0]
    told = set(re.findall(r"`(\w+)`", text))
    data = data_of(found)
    result = data["new_survivors"][0]["new"]
    assert {*data, *result, *data["groups"][0], *data["groups"][0]["new"]} - {"format"} <= told


def test_markdown_has_a_table_for_every_section(found: Changes) -> None:
    rows = cells("\n".join(change_lines(found, lambda span: f"cell/{span.place}")))
    assert ["robot · program", "66.7 %", "50.0 %", "-16.7"] in rows
    (row,) = (row for row in rows if row[1:3] == ["cell/mission.py:2", "skip"])
    assert row[4] == "survived in rounds 1 and 2; before: killed by check in rounds 1 and 2"


@pytest.mark.parametrize("text", HOSTILE)
def test_every_text_is_shown_as_it_is(tmp_path: Path, text: str) -> None:
    new = with_text(stored(tmp_path / "new"), text)
    old = with_text(stored(tmp_path / "old", outcomes=KILLED), text)
    found = changes(portable(old), portable(new))
    json.loads(dumps(data_of(found)), parse_constant=pytest.fail)
    rows = [row for row in cells(made("markdown", new, changes=found)) if len(row) == 5 and row[0] == "2"]
    assert shown([rows[0][3]]) == shown([portable(new).mutants[1].mutant.description])


def test_of_many_mutants_it_says_how_many_are_not_shown(found: Changes) -> None:
    many = replace(found, fixed=found.fixed * 60)
    file = io.StringIO()
    print_changes(make_console(file, width=160), many)
    assert "and 10 more" in file.getvalue()
    assert "and 10 more, which the command line prints." in list(change_lines(many, str))
