"""Thresholds of two campaigns beside each other, on the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rich.console import Console, RenderableType
from rich.text import Text

from mutabot.analysis.thresholds.comparing import Change, Compared, Comparison
from mutabot.analysis.thresholds.words import line_of
from mutabot.report.terminal.console import heading, plain, plural


def print_compared(console: Console, comparison: Comparison) -> None:
    """Print what changed from the old campaign to the new one."""
    for part in _parts(comparison):
        console.print(part, soft_wrap=True)


def _parts(comparison: Comparison) -> Iterator[RenderableType]:
    yield Text(f"{plural(len(comparison.ladders), 'ladder')} in both campaigns", style="bold")
    counts = Counter(one.change for one in comparison.ladders)
    if comparison.why_no_words:
        text = f"No ladder is called improved or worse: {comparison.why_no_words}."
        yield Text(text)
    else:
        told = ", ".join(f"{counts[change]} {change}" for change in Change if counts[change])
        yield Text(f"In these rounds: {told or 'nothing to compare'}.")
    yield from _mean(comparison)
    for one in comparison.ladders:
        if one.change not in (Change.SAME, Change.UNKNOWN):
            yield from _ladder(one, with_word=not comparison.why_no_words)
    unknown = [one for one in comparison.ladders if one.change is Change.UNKNOWN]
    if unknown:
        yield heading("Not compared: in no round known in both, or refused")
        yield from (Text(plain(f"{one.new.place} {one.new.name}")) for one in unknown)
    for name, ids in (("the old", comparison.gone), ("the new", comparison.added)):
        if ids:
            yield heading(f"{plural(len(ids), 'ladder')} only in {name} campaign")
            yield from (Text(plain(one)) for one in ids)


def _mean(comparison: Comparison) -> Iterator[RenderableType]:
    mean = comparison.mean
    if mean is None:
        yield Text("Too few ladders or rounds for a mean over the suite.", style="dim")
        return
    sign = "sooner" if mean.mean >= 0 else "later"
    half = (mean.high - mean.low) / 2.0
    words = {True: "the suite has improved", False: "the suite has become worse", None: "that may be chance"}
    yield Text(
        f"Over all ladders and rounds, faults are noticed {abs(mean.mean):.2f} ± {half:.2f} steps {sign} "
        f"(95 %): {words[comparison.has_improved]}.",
    )


def _ladder(one: Compared, *, with_word: bool) -> Iterator[RenderableType]:
    word = f": {one.change}" if with_word else ""
    yield Text(plain(f"\n{one.new.place} {one.new.name}{word}"))
    for name, ladder in (("before", one.old), ("now", one.new)):
        line = line_of(ladder) if ladder.counted else ladder.why_unjudged
        yield Text(plain(f"  {name:<7} {line}"))
