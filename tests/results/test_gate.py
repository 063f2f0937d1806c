"""The exit code of a campaign: limits hold for each role on its own, and nothing is never everything."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mutabot.errors import SelectionError
from mutabot.journal.files import WriterLock
from mutabot.journal.journal import Journal
from mutabot.model import By, Mutant, Outcome, Verdict
from mutabot.results.gate import decide
from mutabot.results.results import Results, read_results
from tests.results.samples import MUTANTS, OUTCOMES, REVERSE, SKIP, write_journal


def results(folder: Path, outcomes: tuple[Outcome, ...], mutants: tuple[Mutant, ...] = MUTANTS) -> Results:
    path = write_journal(folder / "journal.sqlite", outcomes=outcomes, mutants=mutants)
    with Journal.open(path) as journal:
        # what it lacks is the matter of one test alone
        return replace(read_results(journal), state="complete")


def test_a_journal_that_lacks_an_outcome_of_a_campaign_that_ended_is_never_fine(tmp_path: Path) -> None:
    path = write_journal(tmp_path / "journal.sqlite", outcomes=OUTCOMES[1:])
    with Journal.open(path) as journal:
        found = read_results(journal)
    assert found.state == "incomplete"
    decision = decide(found)
    assert decision.exit_code == 4
    numbers = ", ".join(str(result.mutant.number) for result in found.mutants if None in result.rounds)
    assert decision.lines[0].startswith(
        f"not all that was found could be written to the journal: mutants {numbers};"
    )


def test_without_limits_a_campaign_with_survivors_is_fine(tmp_path: Path) -> None:
    assert decide(results(tmp_path, OUTCOMES)).exit_code == 0


def test_a_good_score_of_one_role_does_not_hide_a_poor_one_of_the_other(tmp_path: Path) -> None:
    found = results(tmp_path, OUTCOMES)  # program 58.3 %, oracle 25 %
    assert decide(found, min_score=0.25).exit_code == 0
    decision = decide(found, min_score=0.5)
    assert decision.exit_code == 1
    assert decision.lines == (
        "the score of the robot mutants of the oracle is 25.0 %, under the limit of 50.0 %".replace(
            " %", "%"
        ),
    )


@pytest.mark.parametrize(
    ("outcomes", "mutants", "words"),
    [
        ((), (), "no mutant was planned"),
        ((), MUTANTS, "no mutant was run"),
        ((Outcome(SKIP.id, 0, Verdict.REFUSED),), MUTANTS, "the robot refused every mutant"),
        ((Outcome(SKIP.id, 0, Verdict.ERROR),), MUTANTS, "no mutant was valid (1 error)"),
    ],
)
def test_nothing_valid_is_a_failure(
    tmp_path: Path, outcomes: tuple[Outcome, ...], mutants: tuple[Mutant, ...], words: str
) -> None:
    decision = decide(results(tmp_path, outcomes, mutants), min_score=0.0)
    assert decision.exit_code == 3
    assert words in decision.lines[0]


def test_time_outs_beyond_the_limit_have_their_own_exit_code(tmp_path: Path) -> None:
    outcomes = (Outcome(SKIP.id, 0, Verdict.TIMEOUT), Outcome(REVERSE.id, 0, Verdict.KILLED, By.CHECK))
    found = results(tmp_path, outcomes)
    assert decide(found, max_timeouts=0.5).exit_code == 0
    assert decide(found, max_timeouts=0.4).exit_code == 5


def test_errors_beyond_the_limit_fail_before_all_else(tmp_path: Path) -> None:
    outcomes = (
        Outcome(SKIP.id, 0, Verdict.ERROR, message="NaN"),
        Outcome(SKIP.id, 1, Verdict.UNSTABLE),
        Outcome(REVERSE.id, 0, Verdict.KILLED, By.CHECK),
        Outcome(REVERSE.id, 1, Verdict.KILLED, By.CHECK),
    )
    found = results(tmp_path, outcomes)
    decision = decide(found, min_score=1.0, max_errors=0.2, max_unstable=0.0)
    assert decision.exit_code == 4
    assert decision.lines[0] == "1 of 4 outcomes are errors (25%); the limit is 20% (error_limit): mutants 2"
    assert "unstable" in decision.lines[1]
    assert decide(found, max_errors=0.25).exit_code == 0


def test_nothing_but_errors_is_reported_as_errors(tmp_path: Path) -> None:
    found = results(tmp_path, (Outcome(SKIP.id, 0, Verdict.ERROR),))
    assert decide(found, max_errors=0.0).exit_code == 4


def test_a_campaign_that_still_runs_or_was_killed_says_which(tmp_path: Path) -> None:
    path = write_journal(tmp_path / "journal.sqlite", outcomes=OUTCOMES[:3], finish=None)
    with Journal.open(path) as journal:
        found = read_results(journal)
    assert (found.state, found.done, found.planned) == ("killed", 3, 10)
    lock = WriterLock.take(path)
    with Journal.open(path) as journal:
        assert read_results(journal).state == "running"
    lock.release()


def test_survivors_are_ranked_by_how_far_the_world_ended(tmp_path: Path) -> None:
    assert [survivor.mutant.number for survivor in results(tmp_path, OUTCOMES).survivors] == [2, 5, 4]


def test_outcomes_of_mutants_that_are_not_planned_do_not_count(tmp_path: Path) -> None:
    found = results(tmp_path, OUTCOMES, MUTANTS[:1])
    assert found.done == 2
    assert found.all.total.valid == 2


def test_a_mutant_is_found_by_number_and_id_or_the_nearest_is_named(tmp_path: Path) -> None:
    found = results(tmp_path, OUTCOMES)
    assert found.mutant("2").mutant == SKIP
    assert found.mutant(SKIP.id).mutant == SKIP
    with pytest.raises(SelectionError, match="mutants are between 1 and 5"):
        found.mutant("6")
    assert found.mutant(SKIP.id[:-1]).mutant == SKIP  # a part of it will do
    with pytest.raises(SelectionError, match="did you mean"):
        found.mutant(SKIP.id.replace("skip", "skipp"))


def test_fail_on_names_survivors_that_are_not_accepted(tmp_path: Path) -> None:
    outcomes = (
        Outcome(REVERSE.id, 0, Verdict.SURVIVED), Outcome(SKIP.id, 0, Verdict.SURVIVED),
    )  # fmt: skip
    accepted = {"mutants": {SKIP.id: {"why": "x", "source": "a.toml:1"}}}
    found = judged(tmp_path, outcomes, accepted=accepted)
    assert decide(found).exit_code == 0
    decision = decide(found, fail_on=["survivors"])
    assert decision.exit_code == 1
    assert decision.lines == ("1 survivor (--fail-on survivors): 1",)


def test_fail_on_untested_names_code_and_mutants_that_no_test_reaches(tmp_path: Path) -> None:
    outcomes = (
        Outcome(REVERSE.id, 0, Verdict.KILLED), Outcome(SKIP.id, 0, Verdict.NOT_COVERED),
    )  # fmt: skip
    found = judged(tmp_path, outcomes, untested={"files": 2, "unreached_files": ["b.py"]})
    assert decide(found, fail_on=["survivors"]).exit_code == 0
    assert decide(found, fail_on=["untested"]).lines == (
        "1 of 2 files is reached by no test (--fail-on untested)",
        "1 mutant that no test reaches (--fail-on untested): 2",
    )


def judged(folder: Path, outcomes: tuple[Outcome, ...], **changes: Any) -> Results:
    mutants = tuple(mutant for mutant in MUTANTS if mutant.id in {end.mutant for end in outcomes})
    path = write_journal(folder / "j.sqlite", outcomes=outcomes, mutants=mutants, rounds=1, **changes)
    return Results.read(path)
