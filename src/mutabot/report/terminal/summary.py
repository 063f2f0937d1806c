"""The end of a run in a few lines: errors, scores, the worst survivors, and where to read on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rich.console import Console, RenderableType
from rich.text import Text

from mutabot.analysis.results import Results
from mutabot.model import Verdict
from mutabot.report.terminal.console import between, heading, make_table, percent
from mutabot.report.terminal.trust import budget_lines, error_lines, since_lines, trust_lines

from .campaign import (
    RATES,
    better_lines,
    group_name,
    ladder_lines,
    sample_lines,
    survivor_lines,
    title,
)
from .mutant import unlooked_lines

#: survivors that are shown
_SURVIVORS = 10
#: verdicts outside the score, in the order of their interest; errors have a place of their own
_OUTSIDE = (Verdict.UNSTABLE, Verdict.REFUSED, Verdict.INVALID, Verdict.NO_EFFECT)


def print_summary(console: Console, results: Results) -> None:
    """Print how a run ended."""
    for part in _parts(results, console.width):
        console.print(part)


def _parts(results: Results, width: int) -> Iterator[RenderableType]:
    yield Text(title(results), style="bold")
    yield from error_lines(results)
    if results.done:
        yield _scores(results, with_interval=width >= RATES)
        yield from sample_lines(results)
    yield from since_lines(results)
    yield from budget_lines(results)
    yield from survivor_lines(results, width, at_most=_SURVIVORS)
    yield from unlooked_lines(results)
    yield from better_lines(results)
    yield from _outside(results)
    yield from ladder_lines(results)
    yield from trust_lines(results)
    yield Text("\n`mutabot results` shows every mutant, `mutabot show N` all about one.", style="dim")


def _scores(results: Results, *, with_interval: bool) -> RenderableType:
    """A line for each family and role."""
    table = make_table()
    table.add_column("family · role", no_wrap=True)
    for name in ("score", "check score", "killed"):
        table.add_column(name, justify="right", no_wrap=True)
    for group in results.groups:
        total = group.scores.total
        killed = f"{total.killed} of {total.valid}"
        interval = group.scores.interval if with_interval else None
        score = percent(group.scores.mean) + (f" ({between(interval)})" if interval is not None else "")
        table.add_row(group_name(group), score, percent(group.scores.mean_check), killed)
    return table


def _outside(results: Results) -> Iterator[RenderableType]:
    counts: Counter[Verdict] = Counter()
    for verdict in _OUTSIDE:
        counts[verdict] = len(results.with_verdict(verdict))
    told = [f"{count} {verdict.value}" for verdict, count in counts.items() if count]
    if told:
        yield heading(f"Mutants outside the score: {', '.join(told)}")
