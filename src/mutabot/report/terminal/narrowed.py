"""What a campaign was narrowed to: what has changed since a revision, and what its time was enough for."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.text import Text

from mutabot.analysis.budgeted import Estimate
from mutabot.analysis.results import Results

from .console import between, heading, percent, plain, plural


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
    """What the time was enough for, and what that says about all mutants."""
    budget = results.budget
    if budget is None or budget.is_whole:
        return
    counted = sum(one.counted for one in budget.classes)
    planned = sum(len(one.mutants) for one in budget.classes)
    yield heading(f"Time for {counted} of {plural(planned, 'outcome')}, what tells most first")
    for one in budget.classes:
        if one.counted:
            yield Text(f"round {one.round + 1}, {one.name}: {one.counted} of {len(one.mutants)}")
    for estimate in results.estimates:
        yield Text(_estimate_text(estimate), overflow="fold")


def _estimate_text(one: Estimate) -> str:
    name = f"{one.family} · {one.role}"
    unknown = f"; of {one.unknown} in classes that were not begun nothing is known" if one.unknown else ""
    if one.score is None or one.interval is None or one.check_interval is None:
        return f"{name}: too few to say anything{unknown}"
    rests = f"from {one.counted} of {one.population} outcomes"
    scores = f"score {percent(one.score)} ({between(one.interval)}), check score {percent(one.check_score)}"
    return f"{name}: estimated {scores} ({between(one.check_interval)}), {rests}{unknown}"
