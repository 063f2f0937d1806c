"""The terminal as reports use it: texts without markup, tables, notes, a mark for each verdict, and progress.

Progress is a bar with the time left on a terminal, and a plain line now and then elsewhere.
"""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from typing import IO, TYPE_CHECKING, Self

from rich import box
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn
from rich.table import Column, Table
from rich.text import Text

from mutabot.frozen import frozen
from mutabot.model import By, Outcome, Span, Verdict
from mutabot.report.texts import ESCAPES

if TYPE_CHECKING:
    from mutabot.report.sections import Section

_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


class _Console(Console):
    """A console whose reader may leave early, as ``head`` does: then it prints nothing more."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        leave_pipe()


def leave_pipe() -> None:
    """Discard all further output: nobody reads standard output any more."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, sys.stdout.fileno())
    finally:
        os.close(nowhere)


def make_console(file: IO[str] | None = None, *, width: int | None = None, stderr: bool = False) -> Console:
    """Make a console that prints texts as they are. ``file`` is standard output if None."""
    return _Console(file=file, width=width, stderr=stderr, markup=False, highlight=False, emoji=False)


def plain(text: str) -> str:
    """Return a program's text without what would confuse the terminal."""
    return _CONTROLS.sub("", ESCAPES.sub("", text)).expandtabs(4)


def heading(text: str) -> Text:
    """Return the heading of a section."""
    return Text(f"\n{plain(text)}", style="bold", overflow="fold")


def below(text: str, indent: int = 2, style: str = "") -> RenderableType:
    """Return an indented text."""
    return Padding(Text(plain(text), style=style, overflow="fold"), (0, 0, 0, indent), expand=False)


def make_table(columns: Sequence[str] = (), *, header: bool = True) -> Table:
    """Make an empty table. ``>name`` is a column of numbers, ``*name`` takes the room that is left."""
    look = box.SIMPLE_HEAD
    table = Table(box=look, show_header=header, pad_edge=False, padding=(0, 1), header_style="bold")
    for name in columns:
        is_number, is_wide = name.startswith(">"), name.startswith("*")
        table.add_column(
            name.lstrip(">*"),
            justify="right" if is_number else "left",
            no_wrap=not is_wide,
            overflow="fold",
            ratio=1 if is_wide else None,
        )
    return table


def short_place(span: Span, width: int = 24) -> str:
    """Return ``file:line``; a long path loses its first folders. What stands in no line has line 0."""
    place = span.place
    if len(place) <= width:
        return place
    parts = place.split("/")
    while len(parts) > 1 and len("…/" + "/".join(parts)) > width:
        parts.pop(0)
    return place if "/".join(parts) == place else "…/" + "/".join(parts)


def print_section(console: Console, section: Section, at_most: int | None = None) -> None:
    """Print a section, of many rows and lines the first. Neighbouring columns of texts share a cell."""
    style = "bold red" if section.is_alarm else "bold"
    console.print(Text(f"\n{plain(section.title)}", style=style, overflow="fold"))
    groups: list[list[int]] = []
    for index, name in enumerate(section.columns):
        if groups and name.startswith("*") and section.columns[index - 1].startswith("*"):
            groups[-1].append(index)
        else:
            groups.append([index])
    if groups:
        names = (" and ".join(section.columns[index] for index in group) for group in groups)
        table = make_table([name.replace(" and *", " and ") for name in names])
        for row in section.rows[:at_most]:
            table.add_row(*("\n".join(plain(row[index]) for index in group) for group in groups))
        console.print(table)
    for line in section.lines[:at_most]:
        console.print(below(line.lstrip(), 2 + len(line) - len(line.lstrip())))
    left = max(len(section.rows), len(section.lines)) - (at_most or 0)
    if at_most is not None and left > 0:
        console.print(below(f"and {left} more", style="dim"))


@frozen
class VerdictMark:
    """How an outcome is shown: a letter, so that colour is not needed, its colour, and the legend's words."""

    letter: str
    style: str
    words: str


_BY_CHECK = VerdictMark("C", "green", "killed by a check")
_BY_EXCEPTION = VerdictMark("X", "cyan", "killed by an exception")
_OTHERS = {
    Verdict.SURVIVED: VerdictMark("S", "bold red", "survived"),
    Verdict.NOT_COVERED: VerdictMark("N", "red", "not covered"),
    Verdict.TIMEOUT: VerdictMark("T", "yellow", "killed by a timeout"),
    Verdict.REFUSED: VerdictMark("R", "blue", "refused by the robot"),
    Verdict.INVALID: VerdictMark("I", "blue", "invalid"),
    Verdict.NO_EFFECT: VerdictMark("=", "dim", "no effect"),
    Verdict.UNSTABLE: VerdictMark("U", "magenta", "unstable"),
    Verdict.ERROR: VerdictMark("E", "bold magenta", "error"),
}
_NOT_RUN = VerdictMark("·", "dim", "not run")
_ORDER = [_BY_CHECK, _BY_EXCEPTION, *_OTHERS.values(), _NOT_RUN]


def mark_of(outcome: Outcome | None) -> VerdictMark:
    """Return the mark of an outcome; None is one that has not been run."""
    if outcome is None:
        return _NOT_RUN
    if outcome.verdict is Verdict.KILLED:
        return _BY_CHECK if outcome.by is By.CHECK else _BY_EXCEPTION
    return _OTHERS[outcome.verdict]


def marks_in(outcomes: Iterable[Outcome | None]) -> list[tuple[VerdictMark, int]]:
    """Return the marks that occur and how often, in the order of the legend."""
    marks = [mark_of(outcome) for outcome in outcomes]
    return [(mark, marks.count(mark)) for mark in _ORDER if mark in marks]


def letters(rounds: Sequence[Outcome | None], *, many: bool = False) -> Text:
    """Return one letter per round, or how often each occurs."""
    if many:
        parts = [Text(f"{mark.letter}{count}", style=mark.style) for mark, count in marks_in(rounds)]
    else:
        parts = [Text(mark_of(one).letter, style=mark_of(one).style) for one in rounds]
    return Text(" ").join(parts)


def legend(outcomes: Iterable[Outcome | None]) -> Text:
    """Explain the letters that occur."""
    # Spaces that do not break keep a letter and its words on one line.
    parts = [
        Text.assemble((mark.letter, mark.style), f" {mark.words}".replace(" ", "\N{NO-BREAK SPACE}"))
        for mark, _ in marks_in(outcomes)
    ]
    return Text("   ").join(parts)


#: part of a stage after which the time left is worth telling: the first steps say little about the others
_TELLING = 0.1


class Pace:
    """The steps of one stage.

    Args:
        total: how many there are; None if that is not known.
        clock: seconds that count.

    Attributes:
        total, done: steps.
    """

    def __init__(self, total: int | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self.total, self.done = total, 0
        self._clock = clock
        self._began = clock()

    def advance(self) -> None:
        """One more is done."""
        self.done += 1

    @property
    def spent(self) -> float:
        """Seconds since it began."""
        return self._clock() - self._began

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take; None as long as too little is known to tell."""
        if self.total is None or self.done == 0 or self.done < _TELLING * self.total:
            return None
        return self.spent / self.done * max(0, self.total - self.done)


#: seconds between two plain lines
EVERY = 5.0

#: columns that stay free at the right: a ^C that the terminal prints there must not begin another line
_SPARE = 3
#: columns of the bar, the count, the time left and the gaps
_BAR, _BESIDE_BAR = 10, 9 + 7 + 6


def _column(width: int | None = None, ratio: int | None = None) -> Column:
    return Column(min_width=width, max_width=width, ratio=ratio, no_wrap=True, overflow="ellipsis")


def make_progress(console: Console) -> Bar | Lines:
    """Make the progress that fits the console; each is one as ``mutabot.campaign`` wants it."""
    return Bar(console) if console.is_terminal else Lines(console)


class Bar:
    """A bar per stage on a terminal, each on one line: texts are cut before the bar is."""

    def __init__(self, console: Console) -> None:
        console.width -= _SPARE
        room = max(10, min(40, console.width - _BAR - _BESIDE_BAR))
        self._progress = Progress(
            TextColumn("{task.description}", markup=False, table_column=Column(max_width=room, no_wrap=True)),
            BarColumn(bar_width=_BAR, table_column=_column(_BAR)),
            MofNCompleteColumn(table_column=_column(9)),
            TimeRemainingColumn(elapsed_when_finished=True, table_column=_column(7)),
            TextColumn("{task.fields[line]}", markup=False, table_column=_column(ratio=1)),
            console=console,
            expand=True,
        )
        self._task: TaskID | None = None

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin another bar."""
        self._close_stage()
        self._task = self._progress.add_task(text, total=total, line="")

    def advance(self, line: str | None = None) -> None:
        """Advance the progress bar and show ``line`` beside it."""
        if self._task is not None:
            self._progress.update(self._task, advance=1, line=plain(line or "").partition("\n")[0])

    def note(self, text: str) -> None:
        """Print a line above the bars."""
        self._progress.console.print(plain(text))

    def _close_stage(self) -> None:
        if self._task is not None:
            self._progress.update(self._task, line="")
            self._progress.stop_task(self._task)

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._close_stage()
        self._progress.stop()


class Lines:
    """Plain lines: the start and end of each stage, and how far it is every few seconds."""

    def __init__(self, console: Console, *, every: float = EVERY) -> None:
        self._console, self._every = console, every
        self._text, self._pace = "", Pace()
        self._last = 0.0

    def stage(self, text: str, total: int | None = None) -> None:
        """Print the stage's name."""
        self._text, self._pace = text, Pace(total)
        self._last = time.monotonic()
        self._print(f"{text}: {total}" if total is not None else text)

    def advance(self, line: str | None = None) -> None:
        """Count, and print how far it is if the last line is long enough ago."""
        self._pace.advance()
        now = time.monotonic()
        if self._pace.done != self._pace.total and now - self._last < self._every:
            return
        self._last = now
        self._print(f"{self._text} {self._how_far()}" + (f" ({line})" if line else ""))

    def note(self, text: str) -> None:
        """Print a line."""
        self._print(text)

    def _how_far(self) -> str:
        pace = self._pace
        if pace.total is None:
            return str(pace.done)
        took = f", took {pace.spent:.0f} s" if pace.done >= pace.total else ""
        left = f", {pace.left:.0f} s left" if not took and pace.left is not None else ""
        return f"{pace.done}/{pace.total}{took or left}"

    def _print(self, text: str) -> None:
        self._console.print(plain(text), soft_wrap=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        pass
