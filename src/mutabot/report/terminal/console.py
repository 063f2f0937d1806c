"""The terminal as reports use it: never any markup in what users wrote, readable without colour."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence
from typing import IO

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mutabot.frozen import frozen
from mutabot.model import By, Outcome, Span, Verdict
from mutabot.results.statistics import Interval

_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07]*\x07|.)")
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


class _Console(Console):
    """A console whose reader may leave early, as ``head`` does: then nothing more is printed."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        leave_pipe()


def leave_pipe() -> None:
    """Nobody reads standard output any more: what is still to be printed goes nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, sys.stdout.fileno())
    finally:
        os.close(nowhere)


def make_console(file: IO[str] | None = None, *, width: int | None = None, stderr: bool = False) -> Console:
    """A console that prints texts as they are. ``file`` is standard output if None."""
    return _Console(file=file, width=width, stderr=stderr, markup=False, highlight=False, emoji=False)


def plain(text: str) -> str:
    """A text from a program under test without what would confuse the terminal."""
    return _CONTROLS.sub("", _ESCAPES.sub("", text)).expandtabs(4)


def heading(text: str) -> Text:
    """The heading of a section."""
    return Text(f"\n{text}", style="bold")


def make_table(*, header: bool = True) -> Table:
    """An empty table in the look of all our tables."""
    return Table(box=box.SIMPLE_HEAD, show_header=header, pad_edge=False, padding=(0, 1), header_style="bold")


def add_row(
    table: Table, number: int | str, facts: Sequence[str], text: str, *more: Text, narrow: bool
) -> None:
    """A row about a mutant: short facts, one text, and what follows it.

    On a narrow terminal the facts stand on a line above the text, in the same column.
    """
    cells = [f"{' · '.join(facts)}\n{plain(text)}"] if narrow else [*facts, plain(text)]
    table.add_row(str(number), *cells, *more)


def make_mutant_table(facts: Sequence[str], text: str, *, narrow: bool) -> Table:
    """A table for ``add_row``, with the headings of the facts and of the text."""
    table = make_table()
    table.add_column("no.", justify="right", no_wrap=True)
    for name in () if narrow else facts:
        table.add_column(name, no_wrap=True)
    table.add_column("mutant" if narrow else text, overflow="fold", ratio=1)
    return table


def short_place(span: Span, width: int = 24) -> str:
    """``file:line``; a long path loses its first folders. What stands in no line has line 0."""
    place = span.place
    if len(place) <= width:
        return place
    parts = place.split("/")
    while len(parts) > 1 and len("…/" + "/".join(parts)) > width:
        parts.pop(0)
    return place if "/".join(parts) == place else "…/" + "/".join(parts)


def percent(share: float | None) -> str:
    """A score as text: ``92.3 %``, or ``–`` where nothing was valid."""
    return "–" if share is None else f"{100 * share:.1f} %"


def between(interval: Interval | None) -> str:
    """An interval as text: ``34–90 %``, or ``–`` where there is none."""
    return "–" if interval is None else f"{100 * interval.low:.0f}–{100 * interval.high:.0f} %"


def plural(count: int, singular: str, several: str | None = None) -> str:
    """``1 mutant``, ``2 mutants``."""
    return f"{count} {singular if count == 1 else several or singular + 's'}"


@frozen
class Mark:
    """How an outcome is shown.

    Attributes:
        letter: a letter or sign of its own, so that colour is not needed.
        style: colour.
        words: what the legend says.
    """

    letter: str
    style: str
    words: str

    @property
    def text(self) -> Text:
        """The coloured letter."""
        return Text(self.letter, style=self.style)


_BY_CHECK = Mark("C", "green", "killed by a check")
_BY_EXCEPTION = Mark("X", "cyan", "killed by an exception")
_OTHERS = {
    Verdict.SURVIVED: Mark("S", "bold red", "survived"),
    Verdict.NOT_COVERED: Mark("N", "red", "not covered"),
    Verdict.TIMEOUT: Mark("T", "yellow", "killed by a time-out"),
    Verdict.REFUSED: Mark("R", "blue", "refused by the robot"),
    Verdict.INVALID: Mark("I", "blue", "invalid"),
    Verdict.NO_EFFECT: Mark("=", "dim", "no effect"),
    Verdict.UNSTABLE: Mark("U", "magenta", "unstable"),
    Verdict.ERROR: Mark("E", "bold magenta", "error"),
}
_NOT_RUN = Mark("·", "dim", "not run")
_ORDER = [_BY_CHECK, _BY_EXCEPTION, *_OTHERS.values(), _NOT_RUN]


def mark_of(outcome: Outcome | None) -> Mark:
    """The mark of an outcome; None is one that has not been run."""
    if outcome is None:
        return _NOT_RUN
    if outcome.verdict is Verdict.KILLED:
        return _BY_CHECK if outcome.by is By.CHECK else _BY_EXCEPTION
    return _OTHERS[outcome.verdict]


def marks_in(outcomes: Iterable[Outcome | None]) -> list[tuple[Mark, int]]:
    """The marks that occur and how often, in the order of the legend."""
    marks = [mark_of(outcome) for outcome in outcomes]
    return [(mark, marks.count(mark)) for mark in _ORDER if mark in marks]


def legend(outcomes: Iterable[Outcome | None]) -> Text:
    """What the letters that occur mean."""
    # Spaces that do not break keep a letter and its words on one line.
    words = [(mark, mark.words.replace(" ", "\N{NO-BREAK SPACE}")) for mark, _ in marks_in(outcomes)]
    return Text("   ").join(Text.assemble(mark.text, f"\N{NO-BREAK SPACE}{text}") for mark, text in words)
