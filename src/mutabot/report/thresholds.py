"""Thresholds on the terminal: a table with a bar per ladder, and what needs a look; demands as TOML."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence

from rich.console import Console
from rich.text import Text

from mutabot.model.graded import OFFSET
from mutabot.report.sections import Section, percent, plural
from mutabot.report.terminal.console import print_section
from mutabot.results.demands import suggested
from mutabot.results.ladders import Ladder
from mutabot.results.thresholds import (
    Change,
    Comparison,
    Thresholds,
    amount,
    line_of,
    rounds_left_out,
    violations_in_words,
)

#: lines of a section that are shown; --json has all
_MOST = 12
_LEGEND = "· no round notices   ▒ some do   █ all do   × the robot refuses; one sign per magnitude"


def print_thresholds(console: Console, thresholds: Thresholds) -> None:
    """Print the thresholds of a campaign, the loosest first."""
    size = f"{plural(len(thresholds.all), 'ladder')} × {plural(thresholds.rounds, 'round')}"
    columns = ("*fault", ">none up to", "magnitudes", ">all from", "*noticed by")
    rows = [_row(one) for one in thresholds.ladders]
    print_section(console, Section(f"{size}: {thresholds.state}", columns, rows, [_LEGEND]))
    for name, lines in _sections(thresholds).items():
        if lines:
            print_section(console, Section(name, lines=lines), _MOST)
    console.print(Text(f"\n{_confidence(thresholds)}", style="dim"))


def _row(one: Ladder) -> tuple[str, ...]:
    none = amount(one.none_up_to, one.unit) if one.none_up_to else "–"
    every = amount(one.all_from, one.unit) if one.all_from in one.sizes else "–"
    return f"{one.place} {one.name}", none, bar(one), every, _noticed_by(one)


def bar(ladder: Ladder) -> str:
    """Return one sign per magnitude: whether no round, some or all notice it, or the robot refuses it."""
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
    """What needs a look, by its heading."""
    found: dict[str, list[str]] = {
        "Out of order: a larger fault was missed": [],
        "Rounds that do not count": [],
    }
    floors: list[str] = []
    for one in thresholds.ladders:
        name = f"{one.place} {one.name}"
        found["Out of order: a larger fault was missed"] += (f"{name}: {x}" for x in violations_in_words(one))
        found["Rounds that do not count"] += (f"{name}: {x}" for x in rounds_left_out(one))
    for floor in thresholds.floors:
        if floor.is_below_noise:
            alarms = floor.false_alarms
            share = (
                f"; about {percent(alarms)} of readings fail without a fault" if alarms is not None else ""
            )
            name = f"{floor.up.place} {floor.up.pair_name}"
            floors.append(f"{name}: {floor.text}{share}; {floor.blind_text}")
    unjudged = [f"{one.place} {one.name}: {one.why_unjudged}" for one in thresholds.unjudged]
    return found | {"Below the sensors' noise": floors, "Not judged": unjudged}


def _confidence(thresholds: Thresholds) -> str:
    """What the table says about further rounds, and what it cost."""
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
    if thresholds.exhaustive:
        alarms = thresholds.false_alarms
        parts.append(f"{thresholds.runs} of {plural(thresholds.exhaustive, 'possible run')} were needed.")
        if thresholds.controls:
            failed = f"{alarms or 'none'} of {plural(thresholds.controls, 'run')} without a fault failed"
            parts.append(f"{failed[0].upper()}{failed[1:]}.")
    return " ".join(parts)


def print_compared(console: Console, comparison: Comparison) -> None:
    """Print what changed from the old campaign to the new one."""
    console.print(Text(f"{plural(len(comparison.ladders), 'ladder')} in both campaigns", style="bold"))
    counts = Counter(one.change for one in comparison.ladders)
    told = ", ".join(f"{counts[change]} {change}" for change in Change if counts[change])
    why = comparison.why_no_words
    console.print(
        f"No ladder is called improved or worse: {why}." if why else f"In these rounds: {told or 'none'}."
    )
    rows = [
        (
            f"{one.new.place} {one.new.name}",
            bar(one.old),
            bar(one.new),
            "" if why and one.change is not Change.UNKNOWN else str(one.change),
        )
        for one in comparison.ladders
        if one.change is not Change.SAME
    ]
    columns = ("*fault", "before", "now", "*change")
    print_section(console, Section(_mean_text(comparison), columns, rows, [_LEGEND]))
    for name, ids in (("the old", comparison.gone), ("the new", comparison.added)):
        if ids:
            print_section(console, Section(f"Ladders only in {name} campaign: {len(ids)}", lines=ids))


def _mean_text(comparison: Comparison) -> str:
    mean = comparison.mean
    if mean is None:
        return "Too few ladders or rounds for a mean over the suite."
    half, sign = (mean.high - mean.low) / 2.0, "sooner" if mean.mean >= 0 else "later"
    words = {True: "the suite has improved", False: "the suite has become worse", None: "that may be chance"}
    by = f"{abs(mean.mean):.2f} ± {half:.2f} steps {sign}"
    return f"Over all ladders and rounds, faults are noticed {by} (95 %): {words[comparison.has_improved]}."


def suggested_toml(ladders: Sequence[Ladder], *, table: str) -> str:
    """Return a demand for each quantity and site of which both directions are met, as TOML.

    ``table`` is the name of the tables: ``tool.mutabot.demand``, or ``demand`` in a file of mutabot's own.
    Where none can be suggested, a comment says why.
    """
    found: dict[str, list[Ladder]] = {}
    for one in ladders:
        found.setdefault(f"{one.mutant.site.id} {one.pair_name} {one.unit}", []).append(one)
    return "\n\n".join("\n".join(_block(both, table)) for both in found.values())


def _block(both: Sequence[Ladder], table: str) -> Iterator[str]:
    yield from (f"# {one.place} {one.name}: {line_of(one)}" for one in both)
    known = [size for one in both if (size := suggested(one)) is not None]
    if len(known) < len(both):
        yield "# no demand: some round neither notices nor refuses it, or the ladder ends too soon"
        return
    mutant = both[0].mutant
    values = {
        "site": mutant.site.id,
        "quantity": mutant.quantity,
        "operator": mutant.operator if mutant.operator != OFFSET else None,
        "notice": f"{max(known):.12g} {both[0].unit or ''}".strip(),
    }
    yield f"[[{table}]]"
    yield from (f"{key} = {json.dumps(text, ensure_ascii=False)}" for key, text in values.items() if text)
