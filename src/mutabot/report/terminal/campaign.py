"""A campaign on the terminal: the summary of a run, and the whole table of mutants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import datetime

from rich.console import Console, RenderableType
from rich.text import Text

from mutabot.model import Outcome
from mutabot.report.sections import Section, plural, sections, size_text
from mutabot.results.results import Results

from .console import legend, make_table, mark_of, marks_in, plain, print_section, short_place

#: rounds from which on a row gives counts in place of one letter each
_MANY_ROUNDS = 12
#: rows of a table in the summary
_ROWS = 10
_NEXT = (
    "\n`mutabot show N` prints the details of a mutant, `mutabot results` lists all, "
    "`mutabot suggest` searches for checks that kill survivors."
)


def print_results(console: Console, results: Results) -> None:
    """Print all mutants and all sections."""
    console.print(Text(title(results), style="bold"))
    console.print(Text(_circumstances(results), style="dim"))
    for part in (*_earlier(results), *_mutants(results)):
        console.print(part)
    for section in sections(results, short_place):
        print_section(console, section)


def print_summary(console: Console, results: Results) -> None:
    """Print how a run ended: errors, scores, survivors, and the titles of tables that are only details."""
    console.print(Text(title(results), style="bold"))
    for section in sections(results, short_place):
        if section.columns or not section.is_detail:
            print_section(console, Section(section.title) if section.is_detail else section, _ROWS)
    console.print(Text(_NEXT, style="dim"))


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
    tests = {one.test.test for one in results.baseline}
    return " · ".join([*parts, *([plural(len(tests), "test")] if tests else [])])


def _earlier(results: Results) -> Iterator[RenderableType]:
    """What the last campaign did not find itself, and a later one that ended before it ran anything."""
    if results.attempt == "running":
        yield Text("A new campaign is still running its baseline; these are the previous results.")
    elif results.attempt is not None:
        ended = f"A later run ended before its first mutant ({plain(results.attempt)})"
        yield Text(f"{ended}; these are the previous results.", style="bold")
    if results.earlier:
        outdated = sum(result.outdated for result in results.earlier)
        known = f"{len(results.earlier)} of {plural(len(results.mutants), 'mutant')} from earlier runs"
        more = f"; {outdated} of them (*) are outdated: something they depend on has changed since"
        yield Text(f"{known}{more if outdated else ''}.")


def _mutants(results: Results) -> Iterator[RenderableType]:
    """One row per mutant, one letter per round."""
    if not results.mutants:
        return
    many = results.rounds > _MANY_ROUNDS
    numbers = " ".join(str(number)[-1] for number in range(1, results.rounds + 1)) or "–"
    table = make_table((">no.", "role", "place", "operator", "*fault", "*rounds" if many else numbers))
    for result in results.mutants:
        mutant = result.mutant
        table.add_row(
            f"{mutant.number}{'*' if result.outdated else ''}",
            mutant.site.role.value,
            short_place(mutant.site.span),
            mutant.operator,
            plain(mutant.description),
            letters(result.rounds, many=many),
        )
    yield table
    yield legend(outcome for result in results.mutants for outcome in result.rounds)


def letters(rounds: Sequence[Outcome | None], *, many: bool = False) -> Text:
    """Return one letter per round, or how often each occurs."""
    if many:
        parts = [Text(f"{mark.letter}{count}", style=mark.style) for mark, count in marks_in(rounds)]
    else:
        parts = [Text(mark_of(one).letter, style=mark_of(one).style) for one in rounds]
    return Text(" ").join(parts)
