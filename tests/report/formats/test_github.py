"""Annotations of GitHub: each is one command, whatever is said in it, and what is not shown is told."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import pytest

import mutabot
from mutabot.model import By, Outcome, Verdict
from mutabot.report.texts import portable
from report.material import HOSTILE, made, stored, with_text
from results import samples

_COMMAND = re.compile(r"::(warning|notice) ([^:]*)::(.*)")


def commands(campaign: mutabot.StoredCampaign) -> list[tuple[str, dict[str, str], str]]:
    """What GitHub's runner makes of the lines: level, properties, message."""
    found = []
    for line in made("github", campaign).removesuffix("\n").split("\n"):
        command = _COMMAND.fullmatch(line)
        assert command is not None, line
        pairs = (part.partition("=") for part in command[2].split(","))
        properties = {name: unquote(value) for name, _, value in pairs}
        found.append((command[1], properties, unquote(command[3])))
    return found


def in_both_rounds(*outcomes: Outcome) -> tuple[Outcome, ...]:
    """The outcomes of the first round, and the same in the second."""
    return (*outcomes, *(replace(outcome, round=1) for outcome in outcomes))


def test_survivors_are_annotations_at_their_calls_the_worst_first(tmp_path: Path) -> None:
    found = commands(stored(tmp_path))
    assert [level for level, _, _ in found] == ["warning", "notice", "notice"]
    assert found[0] == (
        "warning",
        {
            "file": "mission.py", "line": "2", "endLine": "2", "col": "5", "endColumn": "23",
            "title": "Survivor 2: skip (program)",
        },
        "gripper.command: do nothing: survived in rounds 1 and 2; "
        "box_position.x: 0.8 instead of 0.488 (off by 0.312). "
        "Run `mutabot suggest --only 2` to search for a check and verify it.",
    )  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE)
def test_every_text_stays_in_its_command(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    found = commands(campaign)
    assert len(found) == 3
    for (_, properties, message), result in zip(found, portable(campaign).survivors, strict=True):
        assert set(properties) <= {"file", "line", "endLine", "col", "endColumn", "title"}
        assert message.startswith(result.mutant.description)
        assert result.why in message


def test_a_call_over_several_lines_has_no_columns(tmp_path: Path) -> None:
    span = replace(samples.OPEN.span, end_line=3, end_column=9)
    mutant = replace(samples.SKIP, site=replace(samples.OPEN, span=span))
    ends = in_both_rounds(Outcome(mutant.id, 0, Verdict.SURVIVED))
    ((_, where, _),) = commands(stored(tmp_path, mutants=(mutant,), outcomes=ends))
    assert (where["line"], where["endLine"]) == ("2", "3")
    assert not {"col", "endColumn"} & set(where)


@pytest.mark.parametrize(("same", "level", "shown"), [(False, "warning", 10), (True, "notice", 9)])
def test_no_more_than_github_shows_and_the_rest_is_reported(
    tmp_path: Path, same: bool, level: str, shown: int
) -> None:
    mutants = tuple(
        samples.mutant(number, f"made-{number}", samples.MOVE, "dx", "") for number in range(1, 31)
    )
    ends = in_both_rounds(
        *(Outcome(mutant.id, 0, Verdict.SURVIVED, indistinguishable=same) for mutant in mutants)
    )
    found = commands(stored(tmp_path, mutants=mutants, outcomes=ends))
    assert [level_shown for level_shown, _, _ in found] == [level] * shown + ["notice"]
    assert found[-1][2] == f"not shown here: {30 - shown} more survivors; `mutabot results` lists all"


def test_without_survivors_there_is_nothing_to_annotate(tmp_path: Path) -> None:
    killed = in_both_rounds(*(Outcome(mutant.id, 0, Verdict.KILLED, By.CHECK) for mutant in samples.MUTANTS))
    assert made("github", stored(tmp_path, outcomes=killed)) == ""
