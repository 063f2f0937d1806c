"""Print thresholds on the terminal: a row for each ladder, with its magnitudes as a bar."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from mutabot.errors import plural
from mutabot.report.sections import Section
from mutabot.thresholds.thresholds import (
    Thresholds,
    describe_violations,
    ladder_line,
    magnitude_text,
    rounds_left_out,
)

from .console import print_section

if TYPE_CHECKING:
    from mutabot.thresholds.ladders import Ladder

#: lines of a section that are shown; --json has all
_MOST = 12
_LEGEND = "· no round notices   ▒ some do   █ all do   × the robot refuses; one sign per magnitude"


def print_thresholds(console: Console, thresholds: Thresholds) -> None:
    """Print the thresholds of a campaign, least sensitive first."""
    size = f"{plural(len(thresholds.all), 'ladder')} × {plural(thresholds.rounds, 'round')}"
    columns = ("*fault", ">none up to", "magnitudes", ">all from", "*noticed by")
    rows = [_row(ladder) for ladder in thresholds.ladders]
    print_section(console, Section(f"{size}: {thresholds.state}", columns, rows, [_LEGEND]))
    console.print(Text(thresholds.summary))
    for name, lines in _sections(thresholds).items():
        if lines:
            print_section(console, Section(name, lines=lines), _MOST)
    console.print(Text(f"\n{_confidence(thresholds)}", style="dim"))


def _row(ladder: Ladder) -> tuple[str, ...]:
    none = magnitude_text(ladder.none_up_to, ladder.unit) if ladder.none_up_to else "–"
    every = magnitude_text(ladder.all_from, ladder.unit) if ladder.all_from in ladder.sizes else "–"
    return f"{ladder.place} {ladder.name}", none, bar(ladder), every, _noticed_by(ladder)


def bar(ladder: Ladder) -> str:
    """Return a bar with a sign per magnitude: noticed in no, some or all rounds, or refused."""
    refused = ladder.refused_from
    return "".join(
        "×" if refused is not None and size >= refused else
        "█" if size >= ladder.all_from else
        "·" if size <= ladder.none_up_to else
        "▒"
        for size in ladder.sizes
    )  # fmt: skip


def _noticed_by(ladder: Ladder) -> str:
    by = Counter(round.noticed_by for round in ladder.counted if round.noticed_by is not None)
    rounds = len(ladder.counted)
    counts = [f"{name} in {count} of {plural(rounds, 'round')}" for name, count in by.most_common()]
    return ", ".join(counts) or ladder_line(ladder)


def _sections(thresholds: Thresholds) -> dict[str, list[str]]:
    """Return the ladders that need attention, by heading."""
    known = [(f"{ladder.place} {ladder.name}", ladder) for ladder in thresholds.ladders]
    return {
        "Out of order: a larger fault was missed": [
            f"{name}: {text}" for name, ladder in known for text in describe_violations(ladder)
        ],
        "Rounds that do not count": [
            f"{name}: {text}" for name, ladder in known for text in rounds_left_out(ladder)
        ],
        "Not judged": [
            f"{ladder.place} {ladder.name}: {ladder.why_unjudged}" for ladder in thresholds.unjudged
        ],
    }


def _confidence(thresholds: Thresholds) -> str:
    """Return a text on how further rounds may differ, and on the cost."""
    parts = []
    first = max(thresholds.ladders, key=lambda ladder: len(ladder.counted), default=None)
    if first is not None and first.median is None:
        parts.append("One round says nothing about further rounds.")
    elif first is not None and first.median is not None:
        level = f"With {100 * first.median.level:.0f} % confidence"
        ends = "the largest fault that no round noticed and the smallest that every round noticed"
        parts.append(f"{level} the median threshold lies between {ends}.")
        shares = [ladder.share_shown for ladder in thresholds.ladders if ladder.share_shown is not None]
        if shares:
            share = f"at least {100 * min(shares):.0f} % of further rounds do (95 %)"
            parts.append(f"Where all rounds notice, {share}.")
    return " ".join(parts)
