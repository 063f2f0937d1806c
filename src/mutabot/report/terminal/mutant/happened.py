"""What happened in a mutant's test: in a sentence, how far things were apart, and a timeline."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mutabot.analysis.divergence import worst_of
from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.stored.evidence import Pair, StoredEvidence
from mutabot.analysis.unlooked import unlooked
from mutabot.evidence.story import amount
from mutabot.evidence.timeline import Entry, Row, around, timeline
from mutabot.model import Check, Diverged, Looked
from mutabot.model.outcome import Apart
from mutabot.report.terminal.console import heading, make_table, plain


def happened_parts(result: MutantResult, evidence: StoredEvidence | None) -> Iterator[RenderableType]:
    """The sections about the round and test that tell the most; nothing where nothing was recorded."""
    found = [(worst_of(one), -number) for number, one in enumerate(result.rounds) if one and one.diverged]
    if not found:
        return
    number = -max(found)[1]
    outcome = result.rounds[number]
    assert outcome is not None
    diverged = outcome.diverged[0]
    yield heading(f"What happened, in round {number + 1}, {plain(diverged.test)}")
    for text in _sentences(diverged):
        yield Padding(Text(plain(text), overflow="fold"), (0, 0, 0, 2), expand=False)
    if diverged.apart:
        yield Padding(_apart_table(diverged.apart), (0, 0, 0, 4), expand=False)
    if evidence is not None:
        yield from _timeline_parts(evidence.pair(result.mutant.id, number, diverged.test))


def _sentences(diverged: Diverged) -> Iterator[str]:
    if diverged.story:
        yield f"{diverged.story[0].upper()}{diverged.story[1:]}."
    clock = "" if diverged.is_simulated else " of the wall clock"
    if diverged.fault is not None and diverged.at is not None:
        yield f"The mutant acts at {diverged.fault:.1f} s{clock}. From {diverged.at:.1f} s: {diverged.what}."
    elif diverged.what:
        yield f"First of all, {diverged.what}."
    for one in diverged.near[:2]:
        least = f"{1e3 * one.distance:.0f} mm, in the original {1e3 * one.original:.0f} mm"
        yield f"Closest approach of {one.body} to {one.obstacle}: {least}, at {one.at:.1f} s."


def _apart_table(apart: Sequence[Apart]) -> Table:
    table = make_table()
    table.add_column("apart", overflow="fold")
    for name in ("from", "at most", "at", "at the end", "off its way"):
        table.add_column(name, justify="right", no_wrap=True)
    for one in apart:
        largest, final = amount(one.largest, one.unit), amount(one.final, one.unit)
        aside = amount(one.aside, one.unit) if one.aside is not None else "–"
        table.add_row(plain(one.name), f"{one.first:.1f} s", largest, f"{one.at:.1f} s", final, aside)
    return table


def _timeline_parts(pair: Pair) -> Iterator[RenderableType]:
    if pair.original is None or pair.mutant is None:
        yield Padding(Text("no recording is left of it: `mutabot run` with more room"), (0, 0, 0, 2))
        return
    rows, before, after = around(timeline(pair.original, pair.mutant))
    if not rows:
        return
    yield heading("Timeline")
    yield Padding(_timeline_table(rows), (0, 0, 0, 2), expand=False)
    left_out = [text for text in (f"{before} before" * bool(before), f"{after} after" * bool(after)) if text]
    if left_out:
        yield Padding(Text(f"not shown: {', '.join(left_out)}", style="dim"), (0, 0, 0, 2))


def _timeline_table(rows: Sequence[Row]) -> Table:
    table = make_table()
    for name in ("original", "mutant"):
        table.add_column("s", justify="right", no_wrap=True, style="dim")
        table.add_column(name, overflow="fold")
    table.add_column("")
    for row in rows:
        mark = "<- here the mutant acts" if row.is_fault else ""
        table.add_row(*_cells(row.original), *_cells(row.mutant), mark)
    return table


def _cells(entry: Entry | None) -> tuple[str, str]:
    if entry is None:
        return "", "–"
    return "" if entry.time is None else f"{entry.time:.1f}", plain(entry.text)


#: checks of a test that are shown; the journal and JSON have more
_MOST = 15


def looked_parts(result: MutantResult) -> Iterator[RenderableType]:
    """The section of a survivor; nothing for other mutants, and for those of earlier journals."""
    found = next(((number, one) for number, one in enumerate(result.rounds) if one and one.looked), None)
    if found is None or not result.is_survivor:
        return
    number, outcome = found
    yield heading(f"Who looked, in round {number + 1}")
    for looked in outcome.looked:
        yield Padding(Text(plain(_summary(looked)), overflow="fold"), (0, 0, 0, 2), expand=False)
        if looked.acted and looked.checks:
            yield Padding(_table(looked.checks[:_MOST]), (0, 0, 0, 4), expand=False)


def unlooked_lines(results: Results) -> Iterator[RenderableType]:
    """Readings that nobody looks at."""
    found = unlooked(results.mutants)
    if found:
        yield heading("Readings that no test looks at")
    for one in found:
        yield Padding(Text(plain(one.text), overflow="fold"), (0, 0, 0, 2), expand=False)


def _summary(looked: Looked) -> str:
    if not looked.acted:
        return f"{looked.test}: the mutant changed nothing in it"
    count = len(looked.checks) + looked.more
    if not count:
        return f"{looked.test}: no check of its own was seen; assertions that pytest does not rewrite are not"
    spares = [one.spare for one in looked.checks if one.spare is not None]
    nearest = f", the nearest by {min(spares):.3g}" if spares else ""
    shown = f", of which {_MOST} are shown" if count > _MOST else ""
    return f"{looked.test}: {'1 check' if count == 1 else f'{count} checks'} held{nearest}{shown}"


def _table(checks: tuple[Check, ...]) -> Table:
    table = make_table(header=True)
    table.add_column("place", style="dim", no_wrap=True)
    table.add_column("check", overflow="fold")
    table.add_column("with", overflow="fold")
    table.add_column("to spare", justify="right", no_wrap=True)
    for one in checks:
        times = f" ({one.times} times)" if one.times > 1 else ""
        spare = f"{one.spare:.3g}" if one.spare is not None else "–"
        name = one.place.rpartition("/")[2]
        table.add_row(name, plain(f"{one.text}{times}"), plain(one.seen or "–"), spare)
    return table
