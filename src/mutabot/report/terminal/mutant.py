"""Everything about one mutant on the terminal, section by section."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mutabot.evidence.recording import Recording
from mutabot.evidence.story import Entry, Row, amount, around, timeline
from mutabot.journal.records import Replayed
from mutabot.model import Check, Diverged, Kind, Looked, Mutant, Outcome, Quantity, Span
from mutabot.model.outcome import Apart, end_in_words
from mutabot.results.divergence import worst_of
from mutabot.results.results import MutantResult, Results, unlooked
from mutabot.results.score import Score
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import Suggestions

from .console import between, heading, make_table, mark_of, percent, plain
from .suggested import suggested_parts


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
        yield from _timeline_parts(*evidence.pair(result.mutant.id, number, diverged.test))


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


def _timeline_parts(original: Recording | None, mutant: Recording | None) -> Iterator[RenderableType]:
    if original is None or mutant is None:
        yield Padding(Text("no recording is left of it: `mutabot run` with more room"), (0, 0, 0, 2))
        return
    rows, before, after = around(timeline(original, mutant))
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


_NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?")


def print_mutant(
    console: Console,
    result: MutantResult,
    source: str | None,
    evidence: StoredEvidence | None = None,
    suggestions: Suggestions | None = None,
) -> None:
    """Print one mutant.

    Args:
        source: the text of its file, or None if it is not known.
        evidence: the recordings of its campaign; None without any.
        suggestions: checks that were suggested for its campaign; None if none were looked for.
    """
    for part in (*_parts(result, source, evidence), *suggested_parts(result, suggestions)):
        console.print(part)


def print_replayed(console: Console, mutant: Mutant, rounds: Iterable[Replayed]) -> None:
    """Print how a mutant ended when it was run again, beside what the journal says."""
    console.print(Text(f"Mutant {mutant.number}: {plain(mutant.description)}", style="bold", overflow="fold"))
    for one in rounds:
        state = {
            True: "as in the journal",
            False: "otherwise than in the journal",
            None: "not in the journal",
        }
        console.print(heading(f"Round {one.round + 1}: {state[one.agrees]}"))
        console.print(_replayed_line("now", one.second))
        if one.first is not None and not one.agrees:
            console.print(_replayed_line(f"in the journal ({one.first.engine})", one.first))


def _replayed_line(name: str, outcome: Outcome) -> RenderableType:
    parts = [f"{name}: {end_in_words(outcome)}", *_evidence(outcome)]
    return Padding(Text(plain("\n".join(parts)), overflow="fold"), (0, 0, 0, 2), expand=False)


def _parts(
    result: MutantResult, source: str | None, evidence: StoredEvidence | None
) -> Iterator[RenderableType]:
    mutant = result.mutant
    yield Text(f"Mutant {mutant.number}: {plain(mutant.description)}", style="bold", overflow="fold")
    yield _facts(result)
    lines = excerpt(source, mutant.site.span) if source is not None else []
    if lines:
        yield Text("\n" + "\n".join(plain(line) for line in lines), no_wrap=True, overflow="ellipsis")
    if result.change is not None:
        yield Text(f"\nWhere it first acted, the program {plain(result.change)}.")
    yield heading("Rounds")
    groups: dict[Any, list[int]] = {}
    for number, outcome in enumerate(result.rounds):
        groups.setdefault(_alike(outcome), []).append(number)
    for numbers in groups.values():
        yield from _ended(numbers, result.rounds)
    yield from happened_parts(result, evidence)
    yield from looked_parts(result)


def _facts(result: MutantResult) -> Table:
    mutant, rate = result.mutant, result.kill_rate
    table = make_table(header=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    facts = {
        "id": mutant.id,
        "place": _place_text(mutant),
        "role": mutant.site.role.value,
        "operator": f"{mutant.operator} ({mutant.family})",
        "operation": mutant.operation + (f", command {mutant.pattern_name}" if mutant.pattern else ""),
        "quantity": _quantity_text(mutant.quantity, result.quantity) if mutant.operation else "",
        "killed": f"in {rate.killed} of the {rate.valid} rounds in which it was valid{_interval_text(rate)}",
        "result": result.why,
        "better": result.improvement,
    }
    for name, text in facts.items():
        if text:
            table.add_row(name, plain(text))
    return table


def _place_text(mutant: Mutant) -> str:
    function = mutant.site.span.function
    return f"{mutant.site.place} in {function}" if function else mutant.site.place


def _interval_text(rate: Score) -> str:
    if rate.interval is None:
        return ""
    return f": {percent(rate.score)}, 95 % interval {between(rate.interval)}"


def _quantity_text(name: str | None, quantity: Quantity | None) -> str:
    if name is None:
        return "the call as a whole"
    if quantity is None:
        return name
    turned = quantity.kind in (Kind.ROTATION, Kind.ORIENTATION, Kind.ANGLE)
    words = [
        quantity.kind.value,
        quantity.axis and f"{'about' if turned else 'along'} {quantity.axis}",
        quantity.unit and f"in {quantity.unit}",
    ]
    frame = f"frame {quantity.frame}" if quantity.frame else None
    return f"{name}: {', '.join(word for word in (*words, frame) if word)}"


def _alike(outcome: Outcome | None) -> Any:
    """Equal for rounds that ended alike: numbers in texts may differ."""
    if outcome is None:
        return None
    texts = (outcome.message or "", *outcome.divergence)
    return (
        outcome.verdict, outcome.by, outcome.test, outcome.exception, outcome.place,
        outcome.indistinguishable, outcome.gaps, outcome.acted == outcome.hits, tuple(outcome.away),
        *(_NUMBER.sub("0", text) for text in texts),
    )  # fmt: skip


def _ended(numbers: list[int], rounds: Sequence[Outcome | None]) -> Iterator[RenderableType]:
    """Rounds that ended alike, by their 0-based numbers; what differs a little is told of the first."""
    outcomes = [outcome for number in numbers if (outcome := rounds[number]) is not None]
    mark = mark_of(outcomes[0] if outcomes else None)
    name = f"round{'s' if len(numbers) > 1 else ''} {_numbers(numbers)}:"
    line = Text.assemble(f"  {name} ", mark.text, f" {mark.words}")
    if outcomes and outcomes[0].test is not None:
        line.append(f" in {outcomes[0].test}")
    yield line
    if not outcomes:
        return
    *texts, effort = _evidence(outcomes[0])
    if any([*_evidence(other)][:-1] != texts for other in outcomes):
        texts.insert(0, f"such as in round {numbers[0] + 1}:")
    if any(_effort(other, with_time=False) != _effort(outcomes[0], with_time=False) for other in outcomes):
        effort = _all_effort(outcomes)
    elif len(outcomes) > 1:
        effort = f"{_effort(outcomes[0], with_time=False)}, {_seconds(outcomes)}"
    for text in (*texts, effort):
        yield Padding(Text(plain(text), overflow="fold"), (0, 0, 0, 8), expand=False)


def _numbers(numbers: Sequence[int]) -> str:
    """1-based numbers of rounds: ``1–3, 5``."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(f"{part[0] + 1}–{part[-1] + 1}" if len(part) > 1 else f"{part[0] + 1}" for part in parts)


def _all_effort(outcomes: Sequence[Outcome]) -> str:
    acted = _between(sorted(outcome.acted for outcome in outcomes))
    hits = _between(sorted(outcome.hits for outcome in outcomes))
    tests = _between(sorted(outcome.tests for outcome in outcomes))
    return f"acted at {acted} of {hits} hits, {tests} tests run, {_seconds(outcomes)}"


def _between(values: Sequence[int]) -> str:
    return str(values[0]) if values[0] == values[-1] else f"{values[0]} to {values[-1]}"


def _seconds(outcomes: Sequence[Outcome]) -> str:
    low, high = (f"{pick(outcome.wall for outcome in outcomes):.1f}" for pick in (min, max))
    return f"{low} s" if low == high else f"{low} to {high} s"


def _evidence(outcome: Outcome) -> Iterator[str]:
    if outcome.message:
        exception = f"{outcome.exception.rpartition(':')[2]}: " if outcome.exception else ""
        yield f"{exception}{outcome.message.rstrip()}"
    if outcome.place is not None:
        yield f"at {outcome.place}"
    if outcome.compared is not None:
        equal = ": nothing differs (indistinguishable)" if outcome.indistinguishable else ""
        yield f"compared with the original: {outcome.compared.text}{equal}"
    if outcome.confirmed is not None:
        yield f"{'' if outcome.confirmed else 'not '}confirmed by the whole suite"
    if outcome.beside is not None:
        yield f"run alone, since beside others the wall clock had ended it: {outcome.beside}"
    yield from outcome.divergence
    yield from (f"not compared: {gap}" for gap in outcome.gaps)
    yield from (f"stayed away at {_hits(count)}: {why}" for why, count in outcome.away.items())
    yield _effort(outcome)


def _hits(count: int) -> str:
    return "1 hit" if count == 1 else f"{count} hits"


def _effort(outcome: Outcome, *, with_time: bool = True) -> str:
    text = f"acted at {outcome.acted} of {outcome.hits} hits, {outcome.tests} tests run"
    return f"{text}, {outcome.wall:.1f} s" if with_time else text


_TAB = 4


def excerpt(source: str, span: Span, *, around: int = 2) -> list[str]:
    """The lines of a span and ``around`` lines before and after it, with a caret underline.

    Columns of the span count UTF-8 bytes; the underline counts the cells that a terminal shows.
    """
    lines = source.splitlines()
    if not 1 <= span.line <= len(lines):
        return []
    first, last = max(1, span.line - around), min(len(lines), span.end_line + around)
    width = len(str(last))
    shown = []
    for number in range(first, last + 1):
        line = lines[number - 1]
        shown.append(f"{number:>{width}} │ {line.expandtabs(_TAB)}".rstrip())
        if span.line <= number <= span.end_line:
            shown.append(f"{'':>{width}} │ {_underline(line, number, span)}")
    return shown


def _underline(line: str, number: int, span: Span) -> str:
    raw = line.encode()
    indent = len(raw) - len(raw.lstrip())
    start = span.column if number == span.line else indent
    end = span.end_column if number == span.end_line else len(raw)
    before, marked = _cells_of(raw[:start]), _cells_of(raw[:end])
    return " " * before + "^" * max(1, marked - before)


def _cells_of(raw: bytes) -> int:
    return cell_len(raw.decode(errors="ignore").expandtabs(_TAB))
