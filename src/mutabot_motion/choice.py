"""Which round and which test of a mutant are shown: those that tell most, if nobody says otherwise."""

from __future__ import annotations

from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.stored.evidence import StoredEvidence
from mutabot.border.codec import from_data
from mutabot.errors import SelectionError, UsageError
from mutabot.journal.records import REACHING, Reaching
from mutabot.model import Diverged, Outcome

from .shown import Shown

#: tests that are named where several fit
_LISTED = 5
_WHAT_TO_DO = (
    "`mutabot run --fresh` records it if `evidence` is not 0 and a simulator tells where things are, see "
    "docs/motion.md"
)


def choose(
    results: Results,
    result: MutantResult,
    evidence: StoredEvidence,
    round: int | None = None,
    test: str | None = None,
) -> Shown:
    """What is to be shown of a mutant, with what is recorded of it.

    Args:
        results: all that is known of the campaign.
        result: the mutant.
        round: 0-based; None for the one in which the world was worst.
        test: node id or a part of one; None for the one in which it was worst, else for the one that killed.

    Raises SelectionError for a test that does not run the mutant, UsageError if none does.
    """
    mutant = result.mutant
    outcomes = [one for one in result.outcomes if round is None or one.round == round]
    outcome = max(outcomes, key=_tells, default=None)
    where = round if round is not None else outcome.round if outcome is not None else 0
    kept = evidence.tests(mutant.id, where)
    tests = list(dict.fromkeys([*_telling(outcome), *kept, *_reached_by(results, result)]))
    if not tests:
        raise UsageError(f"no test reaches mutant {mutant.number} ({mutant.id}): there is nothing to see")
    name = tests[0] if test is None else _one_of(tests, test)
    pair = evidence.pair(mutant.id, where, name)
    diverged = _diverged(outcome, name)
    return Shown(
        mutant.number,
        mutant.id,
        mutant.description,
        mutant.site.span.place,
        name,
        where,
        pair.original,
        pair.mutant,
        diverged.story if diverged is not None else "",
        diverged.at if diverged is not None else None,
    )


def missing_in(shown: Shown) -> list[str]:
    """What is missing in what was recorded, one line each. Raises UsageError if nothing was."""
    which = f"{shown.test} in round {shown.round + 1}"
    if shown.original is None:
        raise UsageError(f"nothing is recorded of {which}: {_WHAT_TO_DO}")
    found = []
    if shown.mutant is None and shown.story:
        found.append(
            f"what mutant {shown.number} did found no room: set `evidence` to more, and run it again"
        )
    elif shown.mutant is None:
        found.append(f"nothing that is recorded of {which} differs: only the original is shown")
    if not shown.original.tracks:
        found.append("no simulator tells where things are: only calls are shown, see docs/motion.md")
    return found


def _tells(outcome: Outcome) -> tuple[bool, float, int]:
    """The more, the better to look at; of equal rounds the first."""
    return bool(outcome.acted), max((one.worst for one in outcome.diverged), default=0.0), -outcome.round


def _reached_by(results: Results, result: MutantResult) -> tuple[str, ...]:
    found = results.meta.get(REACHING)
    if found is None:  # an older journal does not say it
        return tuple(dict.fromkeys(one.test.test for one in results.tests))
    return from_data(Reaching, found).at(result.mutant.site.id)


def _telling(outcome: Outcome | None) -> list[str]:
    if outcome is None:
        return []
    named = [*(one.test for one in outcome.diverged), *(kill.test for kill in outcome.kills)]
    return [*named, outcome.test] if outcome.test is not None else named


def _diverged(outcome: Outcome | None, test: str) -> Diverged | None:
    return next((one for one in outcome.diverged if one.test == test), None) if outcome is not None else None


def _one_of(tests: list[str], wanted: str) -> str:
    """The test of this node id, or the only one that has this in it."""
    if wanted in tests:
        return wanted
    found = [test for test in tests if wanted in test]
    if len(found) == 1:
        return found[0]
    listed = ", ".join((found or tests)[:_LISTED]) + (" …" if len(found or tests) > _LISTED else "")
    problem = f"several tests fit: {listed}" if found else f"no such test runs the mutant; these do: {listed}"
    raise SelectionError(f"--test {wanted}: {problem}", unknown=[wanted])
