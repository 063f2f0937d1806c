"""Everything about one mutant on the terminal, for ``mutabot show``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mutabot.analysis.divergence import change_text
from mutabot.analysis.results import MutantResult
from mutabot.analysis.score import KillRate
from mutabot.campaign.verify import Replayed, end_in_words
from mutabot.model import Kind, Mutant, Outcome, Quantity

from .console import between, heading, make_table, percent, plain
from .excerpt import excerpt
from .marks import mark_of

#: facts that a mutant of the program text has not
_OF_CALLS = ("operation", "quantity")


def print_mutant(console: Console, result: MutantResult, source: str | None) -> None:
    """Print one mutant; ``source`` is the text of its file, or None if it is not known."""
    for part in _parts(result, source):
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


def _parts(result: MutantResult, source: str | None) -> Iterator[RenderableType]:
    mutant = result.mutant
    yield Text(f"Mutant {mutant.number}: {plain(mutant.description)}", style="bold", overflow="fold")
    yield _facts(result)
    lines = excerpt(source, mutant.site.span) if source is not None else []
    if lines:
        yield Text("\n" + "\n".join(plain(line) for line in lines), no_wrap=True, overflow="ellipsis")
    change = next(filter(None, (change_text(mutant, one, result.quantity) for one in result.outcomes)), None)
    if change is not None:
        yield Text(f"\nWhere it first acted, the program {plain(change)}.")
    yield heading("Rounds")
    for number, outcome in enumerate(result.rounds, start=1):
        yield from _round(number, outcome)


def _facts(result: MutantResult) -> Table:
    mutant, rate = result.mutant, result.kill_rate
    table = make_table(header=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    facts = {
        "id": mutant.id,
        "place": "; ".join(f"{one.site.place} in {one.site.span.function}" for one in mutant.singles),
        "role": mutant.site.role.value,
        "operator": f"{mutant.operator} ({mutant.family})",
        "operation": mutant.operation + (f", command {mutant.pattern_name}" if mutant.pattern else ""),
        "quantity": _quantity_text(mutant.quantity, result.quantity),
        "killed": f"in {rate.killed} of the {rate.valid} rounds in which it was valid{_interval_text(rate)}",
        "result": result.why,
    }
    for name, text in facts.items():
        if mutant.operation or name not in _OF_CALLS:
            table.add_row(name, plain(text))
    return table


def _interval_text(rate: KillRate) -> str:
    if rate.interval is None:
        return ""
    return f": {percent(rate.rate)}, 95 % interval {between(rate.interval)}"


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


def _round(number: int, outcome: Outcome | None) -> Iterator[RenderableType]:
    mark = mark_of(outcome)
    line = Text.assemble(f"{number:>3}  ", mark.text, f"  {mark.words}")
    if outcome is None:
        yield line
        return
    if outcome.test is not None:
        line.append(f" in {outcome.test}")
    yield line
    for text in _evidence(outcome):
        yield Padding(Text(plain(text), overflow="fold"), (0, 0, 0, 8), expand=False)


def _evidence(outcome: Outcome) -> Iterator[str]:
    if outcome.message:
        exception = f"{outcome.exception.rpartition(':')[2]}: " if outcome.exception else ""
        yield f"{exception}{outcome.message.rstrip()}"
    if outcome.place is not None:
        yield f"at {outcome.place}"
    if outcome.indistinguishable:
        yield "calls and probes as in the original (indistinguishable)"
    yield from outcome.divergence
    yield from (f"not compared: {gap}" for gap in outcome.gaps)
    yield f"acted at {outcome.acted} of {outcome.hits} hits, {outcome.tests} tests run, {outcome.wall:.1f} s"
