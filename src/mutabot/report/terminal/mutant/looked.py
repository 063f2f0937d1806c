"""Who looked at a survivor: the tests that ran it, what they checked, and by how much each check held."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.unlooked import unlooked
from mutabot.model import Check, Looked
from mutabot.report.terminal.console import heading, make_table, plain

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
