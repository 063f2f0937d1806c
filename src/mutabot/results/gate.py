"""Decide by limits whether a campaign is good enough, and the exit code that follows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING

from mutabot.errors import ExitCode, in_short, plural
from mutabot.frozen import frozen
from mutabot.journal.records import INCOMPLETE, ShardOf
from mutabot.model import Verdict
from mutabot.thresholds.ladders import ladders_of
from mutabot.thresholds.thresholds import unmet

if TYPE_CHECKING:
    from mutabot.results.results import Results
    from mutabot.thresholds.demands import Demand

#: numbers of mutants that a line gives
_SHOWN = 20


@frozen
class Decision:
    """The decision for a continuous-integration job.

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
    demands: Sequence[Demand] = (),
    fail_on: Collection[str] = (),
) -> Decision:
    """Decide which limits the results break, and the exit code that follows.

    ``min_score`` (0 … 1) holds for every printed mean score, that is for each family and role on its own:
    a good score of the oracle never hides a poor one of the program. ``max_timeouts`` (0 … 1) is the
    greatest share of time-outs among the valid outcomes. ``max_unstable`` is the greatest share of flaky
    tests among the tests, and of unstable outcomes among all; ``max_errors`` the greatest share of errors
    among all outcomes: mutants of which nothing is known. Graded mutants have no score, but their errors and
    unstable outcomes count; ``demands`` say which of them must be noticed. ``fail_on`` has names of
    ``config.options.FAIL_ON``. A disagreement that ``--verify`` found always fails, and so does a journal
    that lacks what was found, or that something else has written to. Of a shard nothing else is judged.
    """
    doubtful = tuple(_doubtful(results))
    if doubtful:
        return Decision(ExitCode.UNRELIABLE, doubtful)
    if results.shard is not None and results.shard.of > 1:
        return _of_shard(results, results.shard)
    total = results.all.total
    unstable = (
        *_too_many(results, Verdict.ERROR, "errors", max_errors, "error_limit"),
        *_disagreements(results),
        *_too_unstable(results, max_unstable),
    )
    if unstable:
        return Decision(ExitCode.UNRELIABLE, unstable)
    if results.since is not None and not results.everything:
        return Decision(ExitCode.FINE)  # nothing that was asked for has changed
    is_judged = bool(results.graded) and any(not ladder.why_unjudged for ladder in ladders_of(results))
    if not total.valid and not is_judged:  # scores have no part in thresholds
        return Decision(ExitCode.NOTHING_KNOWN, (_nothing_valid(results),))
    share = total.timeouts / total.valid if total.valid else 0.0
    if max_timeouts is not None and share > max_timeouts:
        text = f"{total.timeouts} of {total.valid} valid outcomes are time-outs ({share:.0%})"
        return Decision(ExitCode.TOO_MANY_TIMEOUTS, (f"{text}; the limit is {max_timeouts:.0%}",))
    low = tuple(_too_low(results, min_score)) if min_score is not None else ()
    low += (*unmet(demands, ladders_of(results) if demands else ()), *_found(results, fail_on))
    return Decision(ExitCode.SCORE_TOO_LOW, low) if low else Decision(ExitCode.FINE)


def _incomplete(results: Results) -> str:
    lacking = [
        str(result.mutant.number) for result in results.mutants if len(result.outcomes) < results.rounds
    ]
    if results.shard is not None and results.shard.of > 1:
        lacking = []  # most of them are other shards'
    shown = f": mutants {', '.join(lacking[:20])}{' …' if len(lacking) > 20 else ''}" if lacking else ""
    return f"not all that was found could be written to the journal{shown}; `mutabot run` runs it again"


def _doubtful(results: Results) -> Iterator[str]:
    """Yield changes to the journal by other processes, which make its exit code unreliable."""
    if results.set_aside:
        yield (
            f"{in_short(results.set_aside, 5)} in the journal: not written by mutabot, or damaged; "
            "nothing of it is believed, and `mutabot run` runs it again"
        )
    elif INCOMPLETE in results.state:
        yield _incomplete(results)
    if results.altered:
        yield (
            "the journal was changed by something else while the campaign ran: "
            f"{in_short(results.altered, 5)}. What mutabot had found was restored; see to it that no test "
            "writes into .mutabot"
        )


def _of_shard(results: Results, shard: ShardOf) -> Decision:
    """Decide about a shard, whose scores say little about the whole; only disagreements count."""
    wrong = _disagreements(results)
    if wrong:
        return Decision(ExitCode.UNRELIABLE, wrong)
    text = f"{shard.text}: limits and scores are judged by `mutabot merge`, with all shards"
    return Decision(ExitCode.FINE, (text,))


def _disagreements(results: Results) -> tuple[str, ...]:
    found = results.verification
    if found is None or not found.disagreements:
        return ()
    lines = [f"{len(found.disagreements)} of {found.checked} outcomes differ in a fresh process:"]
    for disagreement in found.disagreements:
        lines.append(
            f"  mutant {disagreement.number} ({disagreement.mutant}), round {disagreement.round + 1}:"
        )
        lines += [f"    here    {disagreement.first}", f"    afresh  {disagreement.second}"]
    return tuple(lines)


def _too_unstable(results: Results, limit: float | None) -> tuple[str, ...]:
    if limit is None:
        return ()
    lines = [results.flaky.text(limit)] if results.flaky.share > limit else []
    return (*lines, *_too_many(results, Verdict.UNSTABLE, "unstable", limit, "unstable_limit"))


def _too_many(
    results: Results, verdict: Verdict, description: str, limit: float | None, key: str
) -> tuple[str, ...]:
    """Return a message if more outcomes than the limit have one of these verdicts."""
    outcomes = results.outcomes
    count, run = sum(outcome.verdict is verdict for outcome in outcomes), len(outcomes)
    if limit is None or not run or count / run <= limit:
        return ()
    numbers = [
        str(result.mutant.number)
        for result in results.everything
        if any(outcome.verdict is verdict for outcome in result.outcomes)
    ]
    shown = ", ".join(numbers[:20]) + (" …" if len(numbers) > 20 else "")
    text = f"{count} of {run} outcomes are {description} ({count / run:.0%})"
    return (f"{text}; the limit is {limit:.0%} ({key}): mutants {shown}",)


def _nothing_valid(results: Results) -> str:
    if not results.everything:
        return "no mutant was planned, so nothing is known about the tests"
    counts = Counter(outcome.verdict for outcome in results.outcomes)
    if not counts:
        return "no mutant was run, so nothing is known about the tests"
    if results.accepted:
        return f"no mutant is left to judge: {len(results.accepted)} of {len(results.mutants)} are accepted"
    if set(counts) == {Verdict.REFUSED}:
        return "the robot refused every mutant, so nothing is known about the tests"
    if set(counts) <= {Verdict.REFUSED, Verdict.GUARDED}:
        return "the robot or its guard refused every mutant, so nothing is known about the tests"
    ends = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    return f"no mutant was valid ({ends}), so nothing is known about the tests"


def _found(results: Results, fail_on: Collection[str]) -> Iterator[str]:
    """Yield the findings that ``--fail-on`` forbids: unaccepted survivors, or code that no test reaches."""
    idle = [
        survivor.mutant.number for survivor in results.survivors if survivor.status is Verdict.NOT_COVERED
    ]
    survivors = sorted({survivor.mutant.number for survivor in results.survivors} - {*idle})
    if "survivors" in fail_on and survivors:
        yield f"{plural(len(survivors), 'survivor')} (--fail-on survivors): {_numbers(survivors)}"
    if "untested" in fail_on and results.untested.text:
        yield f"{results.untested.text} (--fail-on untested)"
    if "untested" in fail_on and idle:
        what = f"{plural(len(idle), 'mutant')} that no test reaches"
        yield f"{what} (--fail-on untested): {_numbers(sorted(idle))}"


def _numbers(numbers: Sequence[int]) -> str:
    return in_short([str(number) for number in numbers], _SHOWN)


def _too_low(results: Results, min_score: float) -> list[str]:
    lines = []
    for group in results.groups:
        mean = group.scores.mean
        if mean is not None and mean < min_score:
            name = f"{group.family} mutants of the {group.role}"
            lines.append(f"the score of the {name} is {mean:.1%}, under the limit of {min_score:.1%}")
    return lines
