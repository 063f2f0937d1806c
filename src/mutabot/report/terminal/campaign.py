"""Print a campaign on the terminal: its plan, the summary of a run, its mutants, and operators."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from itertools import groupby
from typing import TYPE_CHECKING, Any

from rich.console import Console, RenderableType
from rich.text import Text

from mutabot.errors import plural
from mutabot.report.document import data_of
from mutabot.report.sections import Section, sections, size_text, skipped, untested
from mutabot.report.texts import next_steps, places_text

from .console import (
    Breakable,
    below,
    heading,
    is_narrow,
    legend,
    letters,
    make_table,
    marks_of,
    print_section,
    short_place,
    terminal_text,
)

if TYPE_CHECKING:
    from mutabot.journal.records import Untested
    from mutabot.model import LeftOut, Mutant
    from mutabot.results.results import Results

#: rounds from which on a row gives counts in place of one letter each
_MANY_ROUNDS = 12
#: rows of a table in the summary
_ROWS = 10
#: the site in a mutant's id, and the value in a reason for leaving it out
_SITE = re.compile(r".*#\d+(?=:)")
_VALUE = re.compile(r" \(value [^()]*\)$")
_ALL = "`mutabot results` lists all mutants."


def print_results(console: Console, results: Results) -> None:
    """Print all mutants and all sections."""
    console.print(Text(title(results), style="bold"))
    console.print(Text(_circumstances(results), style="dim"))
    for part in (*_earlier(results), *_mutants(results, are_joined=is_narrow(console))):
        console.print(part)
    for section in sections(results, short_place):
        print_section(console, section)


def print_summary(console: Console, results: Results) -> None:
    """Print how a run ended: errors, scores, survivors, and the titles of tables that are only details."""
    console.print(Text(title(results), style="bold"))
    for section in sections(results, short_place):
        if section.columns or not section.is_detail:
            print_section(console, Section(section.title) if section.is_detail else section, _ROWS)
    console.print(Text(f"\n{' '.join(filter(None, [next_steps(results), _ALL]))}", style="dim"))


def title(results: Results) -> str:
    """Return how many mutants and rounds there are, and how the campaign ended."""
    text = f"{size_text(results)}: {results.state}"
    return text if results.done == results.planned else f"{text}, {results.known}"


def _circumstances(results: Results) -> str:
    meta = results.meta
    parts = [f"{key} {meta[key]}" for key in ("mutabot", "engine", "seed") if meta.get(key) is not None]
    started = meta.get("started")
    if isinstance(started, int | float):
        parts.append(f"started {datetime.fromtimestamp(started).astimezone():%Y-%m-%d %H:%M}")
    tests = {row.test.test for row in results.baseline}
    return " · ".join([*parts, *([plural(len(tests), "test")] if tests else [])])


def _earlier(results: Results) -> Iterator[RenderableType]:
    """Yield results of earlier campaigns, and a note on a later one that ended before it ran anything."""
    if results.attempt == "running":
        yield Text("A new campaign is still running its baseline; these are the previous results.")
    elif results.attempt is not None:
        ended = f"A later run ended before its first mutant ({terminal_text(results.attempt)})"
        yield Text(f"{ended}; these are the previous results.", style="bold")
    if results.earlier:
        outdated = sum(result.outdated for result in results.earlier)
        known = f"{len(results.earlier)} of {plural(len(results.mutants), 'mutant')} from earlier runs"
        more = f"; {outdated} of them (*) are outdated: something they depend on has changed since"
        yield Text(f"{known}{more if outdated else ''}.")


def _mutants(results: Results, *, are_joined: bool) -> Iterator[RenderableType]:
    """Yield a row per mutant, with one letter per round; place and operator share a cell if joined."""
    if not results.mutants:
        return
    many = results.rounds > _MANY_ROUNDS
    numbers = " ".join(str(number)[-1] for number in range(1, results.rounds + 1)) or "–"
    where = ("place and operator",) if are_joined else ("place", "operator")
    table = make_table((">no.", "role", *where, "*fault", "*rounds" if many else numbers))
    for result in results.mutants:
        mutant = result.mutant
        cells = (places_text(mutant.site, short_place), mutant.operator)
        table.add_row(
            f"{mutant.number}{'*' if result.outdated else ''}",
            mutant.site.role.value,
            *(["\n".join(cells)] if are_joined else cells),
            Breakable(terminal_text(mutant.description)),
            letters(marks_of(result), many=many),
        )
    yield table
    yield legend(mark for result in results.mutants for mark in marks_of(result))


def print_plan(
    console: Console,
    mutants: Sequence[Mutant],
    left_out: Sequence[LeftOut],
    reach: Untested,
    *,
    everything: bool = False,
) -> None:
    """Print every planned mutant, a ladder in one line; and what no test reaches of the program.

    ``everything`` adds ids, all that was left out, and each name of what no test reaches.
    """
    if everything:
        _print_each(console, mutants)
    else:
        print_section(console, _of_plan(mutants))
    for section in (*untested(reach, everything=everything), *skipped(left_out, are_listed=everything)):
        print_section(console, section)
    if everything:
        _print_left_out(console, left_out)


def _of_plan(mutants: Sequence[Mutant]) -> Section:
    """Return the planned mutants, a ladder in one line."""
    ladders = Counter(mutant.ladder for mutant in mutants if mutant.ladder)
    others = {name: f", and {count - 1} other magnitudes" for name, count in ladders.items() if count > 1}
    firsts = {mutant.ladder or mutant.id: mutant for mutant in reversed(mutants)}
    of_them = f" ({plural(len(ladders), 'ladder')} in one line each)" if ladders else ""
    rows = [
        (
            str(mutant.number),
            mutant.site.role.value,
            places_text(mutant.site, short_place),
            mutant.operator,
            mutant.description + others.get(mutant.ladder, ""),
        )
        for mutant in mutants
        if mutant is firsts[mutant.ladder or mutant.id]
    ]
    columns = (">no.", "role", "place", "operator", "*fault")
    return Section(f"{plural(len(mutants), 'mutant')}{of_them}", columns, rows)


def _print_each(console: Console, mutants: Sequence[Mutant]) -> None:
    """Print each mutant with its id, which stays whole, as ``--only`` takes it."""
    console.print(heading(plural(len(mutants), "mutant")))
    width = len(str(len(mutants)))
    for mutant in mutants:
        place = places_text(mutant.site, short_place)
        console.print(
            below(f"{mutant.number:>{width}}  {mutant.site.role.value}  {place}  {mutant.operator}")
        )
        console.print(below(mutant.description, width + 4))
        name = Text(f"{' ' * (width + 4)}{terminal_text(mutant.id)}", style="dim")
        console.print(name, no_wrap=True, overflow="ignore", crop=False)


def _print_left_out(console: Console, left_out: Iterable[LeftOut]) -> None:
    """Print what is left out; those of one site and reason together, by the rest of their ids."""
    found: dict[tuple[str, str], list[LeftOut]] = {}
    for item in left_out:
        reason = _VALUE.sub("", item.reason)
        found.setdefault((_site_of(item.id), reason), []).append(item)
    for (site, reason), items in found.items():
        if len(items) == 1:
            console.print(below(f"{items[0].id}  {items[0].description}: {items[0].reason}"))
            continue
        console.print(below(f"{site}  {reason}:"))
        console.print(below(", ".join(item.id.removeprefix(f"{site}:") for item in items), 4))


def _site_of(name: str) -> str:
    """Return the part of a mutant's id that names its site; the id if it names none."""
    found = _SITE.match(name)
    return found[0] if found else name


def plan_data(mutants: Sequence[Mutant], left_out: Sequence[LeftOut], reach: Untested) -> dict[str, Any]:
    """Return the plan, and what no test reaches of the program, as JSON-like data."""
    return {"mutants": data_of(mutants), "left_out": data_of(left_out), "untested": data_of(reach)}


def print_rules(console: Console, rules: Iterable[Mapping[str, str]]) -> None:
    """Print operators, family by family: what each does, where it applies, and its source."""
    found = list(rules)
    for family, group in groupby(found, key=lambda rule: rule["family"]):
        console.print(heading(family))
        for rule in group:
            console.print(Text(rule["name"], style="bold"))
            more = [f"{name}: {rule[name]}" for name in ("where", "source", "common") if rule[name]]
            for line in (rule["summary"], *more):
                console.print(below(line, 3))
    console.print(f"\n{plural(len(found), 'operator')}")
