"""A reading that no test looks at is one of which no mutant was ever noticed."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.journal.journal import Journal
from mutabot.model import By, Outcome, Verdict
from mutabot.results.results import read_results, unlooked
from results import samples

NEGATE, NOISE = samples.NEGATE, samples.NOISE


def found(folder: Path, *outcomes: Outcome) -> list[str]:
    with Journal.open(samples.write_journal(folder / "journal.sqlite", outcomes=outcomes)) as journal:
        return unlooked(read_results(journal).mutants)


def test_one_kill_in_any_round_is_enough_to_be_looked_at(tmp_path: Path) -> None:
    survived = [Outcome(mutant.id, 0, Verdict.SURVIVED) for mutant in (NEGATE, NOISE)]
    (line,) = found(tmp_path / "a", *survived)
    assert line.endswith(f"{NEGATE.operation} {NEGATE.quantity}: none of its 2 mutants was noticed")
    killed = Outcome(NOISE.id, 1, Verdict.KILLED, By.CHECK, test="t")
    assert not found(tmp_path / "b", *survived, killed)


@pytest.mark.parametrize("verdict", [Verdict.ERROR, Verdict.UNSTABLE, Verdict.NO_EFFECT, Verdict.REFUSED])
def test_what_was_not_judged_says_nothing(tmp_path: Path, verdict: Verdict) -> None:
    assert not found(tmp_path, Outcome(NEGATE.id, 0, verdict))


def test_what_the_program_reads_or_commands_is_not_meant(tmp_path: Path) -> None:
    assert not found(tmp_path, Outcome(samples.REVERSE.id, 0, Verdict.SURVIVED))


def test_what_is_still_to_be_run_may_be_noticed(tmp_path: Path) -> None:
    assert not found(tmp_path, Outcome(NEGATE.id, 0, Verdict.SURVIVED))
