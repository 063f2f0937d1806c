"""A line per mutant while a campaign runs, and the same lines of a campaign that has ended."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mutabot.model import Outcome, Verdict
from mutabot.model.mutant_end import MutantEnd
from mutabot.model.suppression import Acceptance
from mutabot.report.document import shown_data
from mutabot.report.stream import MutantStream
from report.material import made, stored
from results import samples


def ends(*outcomes: Outcome, **changes: Any) -> list[MutantEnd]:
    mutants = {mutant.id: mutant for mutant in samples.MUTANTS}
    return [MutantEnd(mutants[outcome.mutant], outcome, **changes) for outcome in outcomes]


def streamed(name: str, *found: MutantEnd, rounds: int = 2) -> list[str]:
    lines: list[str] = []
    stream = MutantStream(name, rounds, samples.VOCABULARY, "/nowhere", lines.append)
    for end in found:
        stream.add(end)
    return lines


def test_each_line_begins_with_the_state_and_has_tabs_between_its_cells(tmp_path: Path) -> None:
    *lines, end = made("lines", stored(tmp_path)).splitlines()
    assert [line.split("\t")[:4] for line in lines] == [
        ["KILLED", "1", "mission.py:3", "reverse"],
        ["SURVIVED", "2", "mission.py:2", "skip"],
        ["TIMEOUT", "3", "mission.py:4", "by-to"],
        ["SURVIVED", "4", "tests/sensors.py:2", "negate"],
        ["NOT-COVERED", "5", "tests/sensors.py:2", "noise"],
    ]
    assert {line.count("\t") for line in lines} == {5}
    counts = "1 killed, 2 survived, 1 timeout, 1 not covered"
    scores = "robot program 58.3 % by check 25.0 %, robot oracle 25.0 % by check 25.0 %"
    step = "next: `mutabot show 2` prints the details of a survivor, `mutabot suggest` searches for checks"
    # scores as in the other reports on these samples
    assert end == f"END\tcomplete\t{counts}\t{scores}\t{step} that kill survivors."


def test_json_lines_say_the_same(tmp_path: Path) -> None:
    *mutants, end = map(json.loads, made("jsonl", stored(tmp_path)).splitlines())
    assert [(mutant["event"], mutant["status"], mutant["number"]) for mutant in mutants] == [
        ("mutant", "killed", 1), ("mutant", "survived", 2), ("mutant", "timeout", 3),
        ("mutant", "survived", 4), ("mutant", "not covered", 5),
    ]  # fmt: skip
    assert end["event"] == "end"
    assert end["next"].startswith("`mutabot show 2` prints")
    assert end["mutants"] == {"killed": 1, "survived": 2, "timeout": 1, "not covered": 1}


def test_a_survivor_is_reported_with_its_first_round_and_a_kill_with_the_last() -> None:
    survived, killed = samples.OUTCOMES[2], samples.OUTCOMES[0]
    assert [line.split("\t")[0] for line in streamed("lines", *ends(survived, killed))] == ["SURVIVED"]
    found = streamed("lines", *ends(*samples.OUTCOMES[:2]))
    assert [line.split("\t")[:2] for line in found] == [["KILLED", "1"]]


def test_an_accepted_survivor_is_reported_as_such() -> None:
    found = ends(samples.OUTCOMES[2], acceptance=Acceptance("why", "a.toml:1"))
    (line,) = map(json.loads, streamed("jsonl", *found))
    assert (line["status"], line["accepted"]) == ("accepted", "why")


def test_the_end_names_mutants_that_changed_and_those_that_were_not_run(tmp_path: Path) -> None:
    lines: list[str] = []
    stream = MutantStream("lines", 2, samples.VOCABULARY, "/nowhere", lines.append)
    for mutant_end in ends(Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED), *samples.OUTCOMES[2:8]):
        stream.add(mutant_end)
    lines.clear()
    stream.finish(stored(tmp_path))
    assert [line.split("\t")[:2] for line in lines[:-1]] == [["KILLED", "1"], ["NOT-COVERED", "5"]]
    assert lines[-1].startswith("END\tcomplete\t")


@pytest.mark.parametrize("name", ["lines", "jsonl"])
def test_texts_of_programs_make_no_other_line(name: str, tmp_path: Path) -> None:
    hostile = Outcome(
        samples.BY_TO.id,
        0,
        Verdict.REFUSED,
        message="one\ntwo\tthree\r\x1b[31m",
        test="tests/test_a.py::test",
    )
    (line,) = streamed(name, *ends(hostile), rounds=1)
    assert "\n" not in line
    assert "\r" not in line
    assert name == "jsonl" or line.count("\t") == 5


def test_what_to_do_about_a_survivor_is_the_same_in_every_format_for_scripts(tmp_path: Path) -> None:
    campaign = stored(tmp_path)
    streamed = [json.loads(line) for line in made("jsonl", campaign).splitlines()[:-1]]
    shown = [shown_data(result, lambda _: None, None) for result in campaign.mutants]
    assert [found["next"] for found in streamed] == [found["next"] for found in shown]
    assert [found["effect"] for found in streamed] == [found["effect"] for found in shown]
    assert [found["number"] for found in streamed if found["next"]] == [2, 4, 5]  # survived or not covered


def test_no_check_is_promised_where_nothing_was_measured(tmp_path: Path) -> None:
    ends = tuple(replace(outcome, indistinguishable=True, divergence=()) for outcome in samples.OUTCOMES)
    *_, end = map(json.loads, made("jsonl", stored(tmp_path, outcomes=ends)).splitlines())
    assert end["next"] == "`mutabot show 2` prints the details of a survivor."
    assert end["untested"] is None
