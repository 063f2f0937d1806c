"""``mutabot show`` and the pages tell the check that was suggested for a survivor, or how to look for one."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from mutabot.journal.journal import Journal
from mutabot.model import Mutant
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from mutabot.results.results import MutantResult, read_results
from mutabot.results.suggested import Suggestion, keep_suggestions, kept_suggestions
from results import samples

CHECK = Suggestion(
    "tests/test_box.py::test_arrives",
    "assert tracker.box_position().x == pytest.approx(0.5, abs=0.01)",
    ("kills #4 in round 1", "held in 22 runs of the original, whose values spread by 0.002"),
)


def result_of(folder: Path, mutant: Mutant) -> MutantResult:
    with Journal.open(samples.write_journal(folder / "journal.sqlite")) as journal:
        return read_results(journal).mutant(str(mutant.number))


def shown(folder: Path, mutant: Mutant, found: Suggestion | None, width: int = 120) -> str:
    file = io.StringIO()
    print_mutant(make_console(file, width=width), result_of(folder, mutant), lambda _: None, found)
    return file.getvalue()


def test_a_survivor_is_shown_with_the_check_that_kills_it(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NEGATE, CHECK)
    assert "A check that would catch it, in tests/test_box.py::test_arrives\n" in text
    assert CHECK.code in text
    assert "kills #4 in round 1" in text


def test_a_suggested_statement_is_never_wrapped_so_that_it_can_be_copied(tmp_path: Path) -> None:
    assert f"\n  {CHECK.code}\n" in shown(tmp_path, samples.NEGATE, CHECK, width=40)


def test_where_none_was_looked_for_it_is_said_how(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NEGATE, None)
    assert "Add a probe or a test" in text  # nothing differs in this one
    left = Suggestion(reason="the original itself spreads 5 mm")
    assert "No check was found: the original itself spreads 5 mm" in shown(tmp_path, samples.NEGATE, left)
    assert "A check" not in shown(tmp_path, samples.REVERSE, CHECK)


def test_where_no_test_gets_a_test_is_what_is_missing(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NOISE, None)
    assert "Add a test that runs this line." in text
    assert "mutabot suggest" not in text


def test_the_change_is_of_the_program_or_of_the_oracle(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NEGATE, None)
    assert "the oracle read" in text
    assert "the program" not in text


def test_the_checks_that_let_a_survivor_through_are_listed(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NEGATE, None)
    (looked, *_) = samples.LOOKED
    assert f"Checks that held after the fault (round 1, {looked.test})" in text
    for check in looked.checks:
        assert f"{check.place}  {check.text}" in text
    assert "Checks that held" not in shown(tmp_path, samples.REVERSE, None)


def test_what_is_kept_is_for_its_own_campaign(tmp_path: Path) -> None:
    journal, found = tmp_path / "journal.sqlite", {samples.NEGATE.id: CHECK}
    assert kept_suggestions(journal, {"started": 1.5}) == {}
    keep_suggestions(journal, {"started": 1.5}, found)
    assert kept_suggestions(journal, {"started": 1.5}) == found
    assert kept_suggestions(journal, {"started": 2.5}) == {}


@pytest.mark.parametrize(
    "text",
    ["", "[]", '{"started": 1.5}', '{"started": 1.5, "found": {"new": 1}}', '{"started": 1.5, "found": []}'],
)
def test_a_file_of_another_kind_is_left_alone(tmp_path: Path, text: str) -> None:
    (tmp_path / "journal-suggestions.json").write_text(text)
    assert kept_suggestions(tmp_path / "journal.sqlite", {"started": 1.5}) == {}
