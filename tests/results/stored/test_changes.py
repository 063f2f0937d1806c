"""Two campaigns side by side: only what was judged again is new or fixed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import mutabot
from mutabot.model import By, Mutant, Outcome, Verdict
from mutabot.results.results import Results
from mutabot.results.stored import Changes, changes
from results import samples

A, B = samples.REVERSE, samples.SKIP


def outcomes(mutant: Mutant, *verdicts: Verdict, same: bool | None = None) -> tuple[Outcome, ...]:
    by = {Verdict.KILLED: By.CHECK}
    return tuple(
        Outcome(mutant.id, round, verdict, by.get(verdict), indistinguishable=same)
        for round, verdict in enumerate(verdicts)
    )


def results(
    folder: Path, found: Sequence[Outcome], mutants: tuple[Mutant, ...] = (A, B), **meta: Any
) -> Results:
    path = folder / f"{len(list(folder.iterdir()))}.sqlite"
    samples.write_journal(path, outcomes=tuple(found), mutants=mutants, **meta)
    return mutabot.open(path)


def ids(changes: Changes, section: str) -> list[str]:
    found = getattr(changes, section)
    return [getattr(one, "either", one).mutant.id for one in found]


KILLED, SURVIVED, REFUSED = [Verdict.KILLED] * 2, [Verdict.SURVIVED] * 2, [Verdict.REFUSED] * 2
SECTIONS = ("appeared", "fixed", "changed", "unknown", "gone", "added")


@pytest.mark.parametrize(
    ("old", "new", "section"),
    [
        (KILLED, SURVIVED, "appeared"),
        (REFUSED, SURVIVED, "appeared"),
        (KILLED, [Verdict.KILLED, Verdict.NOT_COVERED], "appeared"),
        (SURVIVED, KILLED, "fixed"),
        (SURVIVED, [Verdict.KILLED, Verdict.REFUSED], "fixed"),
        (SURVIVED, REFUSED, "unknown"),
        (SURVIVED, [Verdict.UNSTABLE] * 2, "unknown"),
        (SURVIVED, [], "unknown"),
        (SURVIVED, [Verdict.KILLED], "unknown"),  # the other round may let it through
        (SURVIVED, [Verdict.SURVIVED, Verdict.KILLED], "changed"),
        (SURVIVED, SURVIVED, None),
        (KILLED, KILLED, None),
        (KILLED, REFUSED, None),
    ],
)
def test_a_mutant_is_told_where_it_belongs(
    tmp_path: Path, old: list[Verdict], new: list[Verdict], section: str | None
) -> None:
    found = changes(results(tmp_path, outcomes(A, *old)), results(tmp_path, outcomes(A, *new)))
    told = [name for name in SECTIONS if A.id in ids(found, name)]
    assert told == ([section] if section is not None else [])
    assert found.same == int(old == new == SURVIVED)


def test_a_survivor_that_shows_a_difference_now_has_changed(tmp_path: Path) -> None:
    old = results(tmp_path, outcomes(A, *SURVIVED, same=True))
    new = results(tmp_path, outcomes(A, *SURVIVED, same=False))
    assert ids(changes(old, new), "changed") == [A.id]


def test_mutants_that_are_gone_or_new_are_known_by_their_ids(tmp_path: Path) -> None:
    moved = replace(B, number=7, site=replace(B.site, span=replace(B.site.span, line=9)))
    old = results(tmp_path, outcomes(A, *SURVIVED), (A, B))
    new = results(tmp_path, outcomes(samples.BY_TO, *SURVIVED), (moved, samples.BY_TO))
    found = changes(old, new)
    assert (ids(found, "gone"), ids(found, "added")) == ([A.id], [samples.BY_TO.id])
    assert ids(found, "appeared") == [samples.BY_TO.id]
    assert ids(found, "fixed") == ids(found, "unknown") == []


def test_a_family_that_was_not_to_run_is_neither_gone_nor_new(tmp_path: Path) -> None:
    other = replace(B, family="classical", operation="", operator="SBR")
    wide = {"families": ["robot", "classical"]}
    old = results(tmp_path, outcomes(other, *SURVIVED), (A, other), **wide)
    new = results(tmp_path, outcomes(A, *KILLED), (A,), families=["robot"])
    there, back = changes(old, new), changes(new, old)
    told = "was not to run family classical; mutants that are not compared: 1"
    assert (there.gone, there.notes) == ((), (f"the new campaign {told}",))
    assert (back.added, back.notes) == ((), (f"the old campaign {told}",))
    same = changes(old, results(tmp_path, outcomes(A, *KILLED), (A,), **wide))
    assert (ids(same, "gone"), same.notes) == ([other.id], ())


def test_a_sample_is_told(tmp_path: Path) -> None:
    drawing = {"sample": "10%", "selected": 60, "strata": []}
    found = changes(results(tmp_path, ()), results(tmp_path, (), drawing=drawing))
    (note,) = found.notes
    assert note.startswith("the new campaign is of a sample")


def test_scores_of_both_stand_beside_each_other(tmp_path: Path) -> None:
    found = changes(results(tmp_path, outcomes(A, *KILLED)), results(tmp_path, outcomes(A, *SURVIVED)))
    old, new = found.scores["robot", "program"]
    assert old is not None
    assert new is not None
    assert (old.scores.mean, new.scores.mean) == (1.0, 0.0)
