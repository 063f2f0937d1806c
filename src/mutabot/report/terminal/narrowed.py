"""What a campaign was narrowed to: what has changed since a revision, and what its time was enough for."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.text import Text

from mutabot.analysis.results import Results

from .console import heading, plain, plural


def since_lines(results: Results) -> Iterator[RenderableType]:
    """What was run of what has changed, and what the scores are of."""
    since = results.since
    if since is None:
        return
    run, unjudged = sum(since.run.values()), sum(since.not_judged.values())
    text = f"Since {since.ref} ({since.commit[:7]}): {run} run, {since.taken_over} taken over"
    yield heading(plain(text + (f", {unjudged} not judged" if unjudged else "")))
    for why, count in since.run.items():
        yield Text(f"{count} run: {why}", overflow="fold")
    for why, count in since.not_judged.items():
        yield Text(f"{count} not judged, though no change can have altered them: {why}", overflow="fold")
    if unjudged:
        yield Text("Scores are of those that were run or taken over, not of all mutants.", overflow="fold")


def budget_lines(results: Results) -> Iterator[RenderableType]:
    """What the time was enough for, and what the scores are of."""
    budget = results.budget
    if budget is None or budget.is_whole:
        return
    run = budget.run + budget.cut_off
    yield heading(f"Time for {run} of {plural(budget.planned, 'outcome')}; {budget.planned - run} not run")
    yield Text("Scores are of those that were run, survivors of earlier runs first.", overflow="fold")
    if budget.cut_off:
        text = f"{budget.cut_off} are from the batch that was cut off, in which kills end before survivors."
        yield Text(text, overflow="fold")
