"""Print thresholds on the terminal: a row for each ladder, with its magnitudes as a bar."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from mutabot.errors import plural
from mutabot.report.sections import Section
from mutabot.thresholds.thresholds import Thresholds, amount, describe_violations, line_of, rounds_left_out

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
    rows = [_row(one) for one in thresholds.ladders]
    print_section(console, Section(f"{size}: {thresholds.state}", columns, rows, [_LEGEND]))
    console.print(Text(thresholds.summary))
    for name, lines in _sections(thresholds).items():
        if lines:
            print_section(console, Section(name, lines=lines), _MOST)
    console.print(Text(f"\n{_confidence(thresholds)}", style="dim"))


def _row(one: Ladder) -> tuple[str, ...]:
    none = amount(one.none_up_to, one.unit) if one.none_up_to else "–"
    every = amount(one.all_from, one.unit) if one.all_from in one.sizes else "–"
    return f"{one.place} {one.name}", none, bar(one), every, _noticed_by(one)


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
    by = Counter(one.noticed_by for one in ladder.counted if one.noticed_by is not None)
    rounds = len(ladder.counted)
    told = [f"{name} in {count} of {plural(rounds, 'round')}" for name, count in by.most_common()]
    return ", ".join(told) or line_of(ladder)


def _sections(thresholds: Thresholds) -> dict[str, list[str]]:
    """Return the ladders that need attention, by heading."""
    known = [(f"{one.place} {one.name}", one) for one in thresholds.ladders]
    return {
        "Out of order: a larger fault was missed": [
            f"{name}: {text}" for name, one in known for text in describe_violations(one)
        ],
        "Rounds that do not count": [
            f"{name}: {text}" for name, one in known for text in rounds_left_out(one)
        ],
        "Not judged": [f"{one.place} {one.name}: {one.why_unjudged}" for one in thresholds.unjudged],
    }


def _confidence(thresholds: Thresholds) -> str:
    """Return a text on how further rounds may differ, and on the cost."""
    parts = []
    first = max(thresholds.ladders, key=lambda one: len(one.counted), default=None)
    if first is not None and first.median is None:
        parts.append("One round says nothing about further rounds.")
    elif first is not None and first.median is not None:
        level = f"With {100 * first.median.level:.0f} % confidence"
        ends = "the largest fault that no round noticed and the smallest that every round noticed"
        parts.append(f"{level} the median threshold lies between {ends}.")
        shares = [one.share_shown for one in thresholds.ladders if one.share_shown is not None]
        if shares:
            share = f"at least {100 * min(shares):.0f} % of further rounds do (95 %)"
            parts.append(f"Where all rounds notice, {share}.")
    return " ".join(parts)
