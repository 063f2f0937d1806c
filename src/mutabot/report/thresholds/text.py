"""Thresholds on the terminal: a line per ladder, and below what these lines say and do not say."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.text import Text

from mutabot.model.graded import OFFSET
from mutabot.report.terminal.console import heading, make_table, percent, plain, plural
from mutabot.results.demands import suggested
from mutabot.results.ladders import Between, Ladder, Step
from mutabot.results.thresholds import (
    Change,
    Compared,
    Comparison,
    Floor,
    Thresholds,
    amount,
    line_of,
    rounds_left_out,
    violations_in_words,
)

#: lines of a kind that are shown; --json has all
_MOST = 12
_NOTICERS = ("check", "exception", "timeout")


def print_thresholds(console: Console, thresholds: Thresholds, *, steps: bool = False) -> None:
    """Print the thresholds of a campaign; ``steps`` also prints what became of each magnitude."""
    for part in _parts(thresholds, steps=steps):
        # a ladder is one line also where nobody looks at it, so that other programs find it whole
        console.print(part, soft_wrap=isinstance(part, Text))


def _parts(thresholds: Thresholds, *, steps: bool) -> Iterator[RenderableType]:
    size = f"{plural(len(thresholds.all), 'ladder')} × {plural(thresholds.rounds, 'round')}"
    yield Text(f"{size}: {thresholds.state}", style="bold")
    for ladder in thresholds.ladders:
        yield Text(plain(f"{ladder.place} {ladder.name}: {line_of(ladder)}"))
        for line in rounds_left_out(ladder):
            yield _below(f"without {line}")
        if steps:
            yield _steps(ladder)
    if thresholds.ladders:
        yield from _meaning(thresholds)
    yield from _section("Out of order: a larger fault was missed", _violations(thresholds.ladders))
    yield from _in_order(thresholds)
    yield from _section("Below the sensors' noise", _floors(thresholds.floors))
    yield from _section("Better than the original", _better(thresholds.ladders))
    yield from _section("Not judged", _unjudged(thresholds.unjudged))
    yield from _costs(thresholds)


def _steps(ladder: Ladder) -> RenderableType:
    """What became of each magnitude, and how sure that is."""
    table = make_table()
    for name in ("no.", "magnitude", "noticed", "95 %", "by"):
        table.add_column(name, justify="left" if name == "by" else "right", no_wrap=True)
    for step in ladder.steps:
        interval = step.interval
        between = f"{_floor(interval.low)}–{_ceil(interval.high)} %" if interval is not None else "–"
        noticed = f"{step.noticed} of {step.valid}" if step.valid else "–"
        table.add_row(
            str(step.number), amount(step.magnitude, ladder.unit), noticed, between, ends_text(step)
        )
    return Padding(table, (0, 0, 0, 2), expand=False)


def ends_text(step: Step) -> str:
    """``check 3, exception 1; refused 1``."""
    noticed = [f"{by} {step.by[by]}" for by in _NOTICERS if step.by.get(by)]
    others = {"refused": step.refused, "no effect or unstable": step.unknown}
    apart = [f"{name} {count}" for name, count in others.items() if count]
    return "; ".join(part for part in (", ".join(noticed), ", ".join(apart)) if part) or (
        "" if step.valid else "not run"
    )


def _meaning(thresholds: Thresholds) -> Iterator[RenderableType]:
    """What the lines say about further rounds."""
    yield heading("What this says about further rounds like these")
    by_rounds: dict[int, list[Ladder]] = {}
    for one in thresholds.ladders:
        by_rounds.setdefault(len(one.counted), []).append(one)
    for rounds, ladders in sorted(by_rounds.items(), reverse=True):
        whose = (
            "" if len(by_rounds) == 1 else f" ({plural(len(ladders), 'ladder')} of {plural(rounds, 'round')})"
        )
        median = ladders[0].median
        if median is None:
            yield Text(f"Nothing: one round is no sample{whose}.")
            continue
        yield Text(
            f"The median threshold lies above “none up to” and at most at “all from” with "
            f"{100 * median.level:.0f} % confidence{whose}."
            if rounds < _FEW
            else f"The median threshold lies in the bracket below with {100 * median.level:.0f} % confidence"
            f"{whose}.",
        )
        if rounds >= _FEW:
            for one in ladders[:_MOST]:
                if one.median is not None:
                    yield _below(f"{one.place} {one.name}: {between_text(one.median, one.unit)}")
        shares = [one.share_shown for one in ladders if one.share_shown is not None]
        if shares:
            yield Text(
                f"Where all {rounds} rounds notice, at least {100 * shares[0]:.0f} % of further rounds do, "
                f"with 95 % confidence{whose}.",
            )


#: with fewer rounds the interval goes from the first to the last of them
_FEW = 9


def between_text(median: Between, unit: str | None) -> str:
    """``(10 mm, 50 mm]``; open where no magnitude bounds it."""
    low = amount(median.low, unit) if median.low else "0"
    high = f"{amount(median.high, unit)}]" if math.isfinite(median.high) else "∞)"
    return f"({low}, {high}"


def _violations(ladders: Iterable[Ladder]) -> Iterator[str]:
    for one in ladders:
        for text in violations_in_words(one):
            yield f"{one.place} {one.name}: {text}"


def _in_order(thresholds: Thresholds) -> Iterator[RenderableType]:
    share = thresholds.most_violated
    if share is not None:
        count = len(thresholds.ladders)
        yield Text(
            f"None of {count} ladders is out of order: fewer than {_ceil(share)} % of such ladders are "
            "(95 %; they are counted once each, since violations come in groups).",
            style="dim",
        )


def _floors(floors: Iterable[Floor]) -> Iterator[str]:
    for one in floors:
        if one.is_below_noise:
            alarms = one.false_alarms
            share = (
                f"; about {percent(alarms)} of readings fail without a fault" if alarms is not None else ""
            )
            yield f"{one.up.place} {one.up.pair_name}: {one.text}{share}; {one.blind_text}"


def _better(ladders: Iterable[Ladder]) -> Iterator[str]:
    for one in ladders:
        found = one.better
        if found:
            best = found[0]
            more = f" and {len(found) - 1} more" if len(found) > 1 else ""
            where = f"{amount(best.magnitude, one.unit)}, round {best.round + 1}"
            yield f"{one.place} {one.name}: {best.text} ({where}){more}"


def _unjudged(ladders: Iterable[Ladder]) -> Iterator[str]:
    for one in ladders:
        yield f"{one.place} {one.name}: {one.why_unjudged}"


def _section(title: str, lines: Iterable[str]) -> Iterator[RenderableType]:
    found: Sequence[str] = list(lines)
    if not found:
        return
    yield heading(title)
    for line in found[:_MOST]:
        yield Text(plain(line))
    if len(found) > _MOST:
        yield Text(f"and {len(found) - _MOST} more; --json has all", style="dim")


def _costs(thresholds: Thresholds) -> Iterator[RenderableType]:
    runs, whole = thresholds.runs, thresholds.exhaustive
    if not whole:
        return
    text = f"\n{plural(runs, 'run')} of {whole} that whole ladders would take ({runs / whole:.0%})"
    if thresholds.controls:
        clean = (
            "none of them was noticed"
            if not thresholds.false_alarms
            else (f"{thresholds.false_alarms} of them failed without a fault")
        )
        text += f", and {thresholds.controls} of magnitude 0: {clean}"
    yield Text(f"{text}.", style="dim")


def _below(text: str) -> RenderableType:
    return Text(f"  {plain(text)}", style="dim")


def _floor(share: float) -> int:
    return math.floor(100 * share + 1e-9)


def _ceil(share: float) -> int:
    return math.ceil(100 * share - 1e-9)


def print_compared(console: Console, comparison: Comparison) -> None:
    """Print what changed from the old campaign to the new one."""
    for part in _compared_parts(comparison):
        console.print(part, soft_wrap=True)


def _compared_parts(comparison: Comparison) -> Iterator[RenderableType]:
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


def suggested_toml(ladders: Sequence[Ladder], *, table: str) -> str:
    """A demand for each quantity and site, of which both directions are met.

    ``table`` is the name of the tables: ``tool.mutabot.demand``, or ``demand`` in a file of mutabot's own.
    Where none can be suggested, a comment says why.
    """
    found: dict[str, list[Ladder]] = {}
    for one in ladders:
        found.setdefault(f"{one.mutant.site.id} {one.pair_name} {one.unit}", []).append(one)
    blocks = ["\n".join(_block(both, table)) for both in found.values()]
    return "\n\n".join(blocks)


def _block(both: Sequence[Ladder], table: str) -> Iterator[str]:
    for one in both:
        yield f"# {one.place} {one.name}: {line_of(one)}"
    sizes = [suggested(one) for one in both]
    known = [size for size in sizes if size is not None]
    first = both[0]
    if len(known) < len(sizes):
        yield "# no demand: some round neither notices nor refuses it, or the ladder ends too soon"
        return
    yield f"[[{table}]]"
    yield f"site = {_toml_text(first.mutant.site.id)}"
    if first.mutant.quantity is not None:
        yield f"quantity = {_toml_text(first.mutant.quantity)}"
    if first.mutant.operator != OFFSET:
        yield f"operator = {_toml_text(first.mutant.operator)}"
    notice = f"{max(known):.12g} {first.unit or ''}"
    yield f"notice = {_toml_text(notice.strip())}"


def _toml_text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
