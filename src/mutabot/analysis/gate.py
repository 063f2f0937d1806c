"""Whether a campaign is good enough: the limits that decide its exit code."""

from __future__ import annotations

from dataclasses import dataclass

from mutabot.exit_codes import ExitCode
from mutabot.model import Verdict

from .results import Results


@dataclass(frozen=True, slots=True)
class Decision:
    """The end of a campaign as a continuous-integration job sees it.

    Attributes:
        exit_code: what the command ends with.
        lines: why it is not 0, one line each; empty if all is well.
    """

    exit_code: ExitCode
    lines: tuple[str, ...] = ()


def decide(
    results: Results,
    *,
    min_score: float | None = None,
    max_timeouts: float | None = None,
    max_unstable: float | None = None,
    max_errors: float | None = None,
) -> Decision:
    """Hold the results against the limits.

    ``min_score`` (0 … 1) holds for every printed mean score, that is for each family and role on its own:
    a good score of the oracle never hides a poor one of the program. ``max_timeouts`` (0 … 1) is the
    greatest share of time-outs among the valid outcomes. ``max_unstable`` is the greatest share of flaky
    tests among the tests, and of unstable outcomes among all; ``max_errors`` the greatest share of errors
    among all outcomes: mutants of which nothing is known. A disagreement that ``--verify`` found always
    fails.
    """
    total = results.all.total
    unstable = (
        *_too_many(results, Verdict.ERROR, "errors", max_errors, "error_limit"),
        *_disagreements(results),
        *_too_unstable(results, max_unstable),
    )
    if unstable:
        return Decision(ExitCode.UNRELIABLE, unstable)
    if not total.valid:
        return Decision(ExitCode.NOTHING_KNOWN, (_nothing_valid(results),))
    share = total.timeouts / total.valid
    if max_timeouts is not None and share > max_timeouts:
        text = f"{total.timeouts} of {total.valid} valid outcomes are time-outs ({share:.0%})"
        return Decision(ExitCode.TOO_MANY_TIMEOUTS, (f"{text}; the limit is {max_timeouts:.0%}",))
    low = tuple(_too_low(results, min_score)) if min_score is not None else ()
    return Decision(ExitCode.SCORE_TOO_LOW, low) if low else Decision(ExitCode.FINE)


def _disagreements(results: Results) -> tuple[str, ...]:
    found = results.verification
    if found is None or not found.disagreements:
        return ()
    lines = [f"{len(found.disagreements)} of {found.checked} outcomes come out otherwise in a fresh process:"]
    for one in found.disagreements:
        lines.append(f"  mutant {one.number} ({one.mutant}), round {one.round + 1}:")
        lines += [f"    here    {one.first}", f"    afresh  {one.second}"]
    return tuple(lines)


def _too_unstable(results: Results, limit: float | None) -> tuple[str, ...]:
    if limit is None:
        return ()
    lines = [results.flaky.text(limit)] if results.flaky.share > limit else []
    return (*lines, *_too_many(results, Verdict.UNSTABLE, "unstable", limit, "unstable_limit"))


def _too_many(
    results: Results, verdict: Verdict, words: str, limit: float | None, key: str
) -> tuple[str, ...]:
    """A line if more outcomes than the limit allows ended so."""
    counts = results.all.total.counts
    count, run = counts.get(verdict, 0), sum(counts.values())
    if limit is None or not run or count / run <= limit:
        return ()
    numbers = [str(result.mutant.number) for result, _ in results.with_verdict(verdict)]
    shown = ", ".join(numbers[:20]) + (" …" if len(numbers) > 20 else "")
    text = f"{count} of {run} outcomes are {words} ({count / run:.0%})"
    return (f"{text}; the limit is {limit:.0%} ({key}): mutants {shown}",)


def _nothing_valid(results: Results) -> str:
    if not results.mutants:
        return "no mutant was planned, so nothing is known about the tests"
    counts = results.all.total.counts
    if not counts:
        return "no mutant was run, so nothing is known about the tests"
    if set(counts) == {Verdict.REFUSED}:
        return "the robot refused every mutant, so nothing is known about the tests"
    ends = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    return f"no mutant was valid ({ends}), so nothing is known about the tests"


def _too_low(results: Results, min_score: float) -> list[str]:
    lines = []
    for group in results.groups:
        mean = group.scores.mean
        if mean is not None and mean < min_score:
            name = f"{group.family} mutants of the {group.role}"
            lines.append(f"the score of the {name} is {mean:.1%}, under the limit of {min_score:.1%}")
    return lines
