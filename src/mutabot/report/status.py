"""One state of a mutant over all its rounds, for formats that know no rounds; and the rounds in words."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from mutabot.analysis.divergence import first_line
from mutabot.analysis.results import MutantResult
from mutabot.model import Outcome, Verdict

#: of the rounds that stand outside the score, the one that most needs a look names the state
_OUTSIDE = (Verdict.ERROR, Verdict.UNSTABLE, Verdict.REFUSED, Verdict.INVALID, Verdict.NO_EFFECT)


def status_of(result: MutantResult) -> Verdict | None:
    """The state; None if it has not been run.

    - *survived* if any round lets it through: that is what there is to act on;
    - *not covered* if it is valid in some round, and no test reaches it in any of these;
    - *killed* if every round in which it is valid kills it, *timeout* if all these only ran out of budget;
    - else, as no round was valid, the verdict outside the score that most needs a look.
    """
    found = {outcome.verdict for outcome in result.outcomes}
    valid = {verdict for verdict in found if verdict.is_valid}
    if valid == {Verdict.NOT_COVERED}:
        return Verdict.NOT_COVERED
    if result.is_survivor:
        return Verdict.SURVIVED
    if valid:
        return Verdict.TIMEOUT if valid == {Verdict.TIMEOUT} else Verdict.KILLED
    return next((verdict for verdict in _OUTSIDE if verdict in found), None)


def is_divergent(result: MutantResult) -> bool:
    """Whether a survivor is known to have made the robot do anything else than the original."""
    survived = (one for one in result.outcomes if one.verdict is Verdict.SURVIVED)
    return any(one.divergence and not one.indistinguishable for one in survived)


def rounds_text(result: MutantResult) -> str:
    """``killed by check in rounds 1 and 2, survived in round 3, not run in rounds 4 to 6``."""
    by_end: dict[str, list[int]] = {}
    for number, outcome in enumerate(result.rounds, start=1):
        by_end.setdefault(_end(outcome), []).append(number)
    return ", ".join(f"{end} in {_numbers(numbers)}" for end, numbers in by_end.items()) or "not run"


def reason_of(result: MutantResult) -> str:
    """Why a mutant has its state: its rounds, one line about it, and what a deciding test said."""
    lines = [rounds_text(result)]
    status = status_of(result)
    if result.is_survivor:
        lines.append(result.why)
    told: set[str] = set()
    for outcome in result.outcomes:
        text = outcome.message or ""
        if text and text not in told and (not result.is_survivor or outcome.verdict is not status):
            told.add(text)
            lines.append(f"round {outcome.round + 1}: {outcome.test + ': ' if outcome.test else ''}{text}")
    return "\n".join(lines)


def survivor_text(result: MutantResult) -> str:
    """A survivor in words: what it does, in which rounds it survived, and what became of the world."""
    return f"{result.mutant.description}: {rounds_text(result)}. {why_alone(result)}"


def why_alone(result: MutantResult) -> str:
    """The line about a survivor, for a place where what it does stands beside it."""
    return result.why.removeprefix(f"{result.mutant.description}; ")


def short_reason(result: MutantResult) -> str:
    """Why a mutant that has been run has its state, in a line: what the first such round said."""
    status = status_of(result)
    return next(first_line(one.message) for one in result.outcomes if one.verdict is status)


def _end(outcome: Outcome | None) -> str:
    if outcome is None:
        return "not run"
    return f"{outcome.verdict} by {outcome.by}" if outcome.by is not None else outcome.verdict.value


def _numbers(numbers: Iterable[int]) -> str:
    """``round 3``, ``rounds 1 and 2``, ``rounds 1 and 3 to 5``."""
    runs: list[str] = []
    for _, group in groupby(enumerate(numbers), key=lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        runs += [f"{run[0]} to {run[-1]}"] if len(run) > 2 else map(str, run)
    *others, last = runs
    text = f"{', '.join(others)} and {last}" if others else last
    return f"{'round' if text.isdigit() else 'rounds'} {text}"
