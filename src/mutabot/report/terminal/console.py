"""The terminal as reports use it: texts without markup, tables, sections, and a mark for each verdict."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence
from typing import IO, TYPE_CHECKING, Any

from rich import box
from rich.console import Console, RenderableType
from rich.containers import Lines
from rich.padding import Padding
from rich.segment import Segment, Segments
from rich.table import Table
from rich.text import Text

from mutabot.frozen import frozen
from mutabot.model import By, Outcome, Span, Verdict
from mutabot.report.texts import ESCAPES

if TYPE_CHECKING:
    from mutabot.report.sections import Section
    from mutabot.results.results import MutantResult

#: between the entries of a legend
_GAP = "   "
#: columns of a terminal below which a mutant's operator stands under its place, to leave room for its fault
_NARROW = 70
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


class _Console(Console):
    """A console that strips blanks at line ends and stops if its reader leaves early, as ``head`` does."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print one object as its lines; several objects as in ``Console``."""
        if len(objects) != 1 or options:
            super().print(*objects, **options)
            return
        lines = self.render_lines(objects[0], pad=False)
        segments = (segment for line in lines for segment in (*_without_blanks(line), Segment.line()))
        super().print(Segments(segments), end="")

    def on_broken_pipe(self) -> None:
        self.quiet = True
        leave_pipe()


def _without_blanks(line: Sequence[Segment]) -> list[Segment]:
    """Return a line without trailing blanks."""
    found = list(line)
    while found and not found[-1].control:
        last = found.pop()
        text = last.text.rstrip(" ")
        if text:
            return [*found, Segment(text, last.style)]
    return found


class Breakable(Text):
    """A text that breaks between words, and within too long words after punctuation."""

    def wrap(self, console: Console, width: int, **options: Any) -> Lines:
        """Wrap the text to a width."""
        whole = Text(style=self.style)
        for part in re.split(r"(\s+)", self.plain):
            pieces = _pieces(part, width) if len(part) > width else [part]
            whole.append("\n".join(pieces))
        return whole.wrap(console, width, **options)


def _pieces(word: str, width: int) -> list[str]:
    """Split a long word into parts that fit a width, at its punctuation where possible."""
    pieces = [""]
    for part in re.findall(r"[^_./:\-\[\],=]*[_./:\-\[\],=]?", word):
        if len(pieces[-1]) + len(part) > width and pieces[-1]:
            pieces.append("")
        pieces[-1] += part
    return pieces


def leave_pipe() -> None:
    """Discard all further output, since the reader of standard output has closed it."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, sys.stdout.fileno())
    finally:
        os.close(nowhere)


def make_console(file: IO[str] | None = None, *, width: int | None = None, stderr: bool = False) -> Console:
    """Make a console that prints texts unchanged. ``file`` is standard output if None."""
    return _Console(file=file, width=width, stderr=stderr, markup=False, highlight=False, emoji=False)


def terminal_text(text: str) -> str:
    """Return a program's text without characters that confuse the terminal."""
    return _CONTROLS.sub("", ESCAPES.sub("", text)).expandtabs(4)


def heading(text: str) -> Text:
    """Return the heading of a section."""
    return Text(f"\n{terminal_text(text)}", style="bold", overflow="fold")


def below(text: str, indent: int = 2, style: str = "") -> RenderableType:
    """Return an indented text."""
    breakable = Breakable(terminal_text(text), style=style, overflow="fold")
    return Padding(breakable, (0, 0, 0, indent), expand=False)


def make_table(columns: Sequence[str] = (), *, header: bool = True) -> Table:
    """Make an empty table. ``>name`` is a column of numbers, ``*name`` takes the remaining width.

    Without such a column, those of texts break between words where there is too little room.
    """
    table = Table(
        box=box.SIMPLE_HEAD,
        show_header=header,
        pad_edge=False,
        padding=(0, 1, 0, 0),
        show_edge=False,
        header_style="bold",
    )
    has_wide = any(name.startswith("*") for name in columns)
    for name in columns:
        is_number, is_wide = name.startswith(">"), name.startswith("*")
        table.add_column(
            name.lstrip(">*"),
            justify="right" if is_number else "left",
            no_wrap=has_wide and not is_wide,
            overflow="fold",
            ratio=1 if is_wide else None,
        )
    return table


def is_narrow(console: Console) -> bool:
    """Return whether the operator has to share a cell with the place."""
    return console.width < _NARROW


def short_place(span: Span, width: int = 24) -> str:
    """Return ``file:line``, dropping the first folders of a long path. Line 0 means the whole file."""
    place = span.place
    if len(place) <= width:
        return place
    parts = place.split("/")
    while len(parts) > 1 and len("…/" + "/".join(parts)) > width:
        parts.pop(0)
    return place if "/".join(parts) == place else "…/" + "/".join(parts)


def print_section(console: Console, section: Section, at_most: int | None = None) -> None:
    """Print a section, with at most ``at_most`` rows and lines. Neighbouring text columns share a cell.

    On a narrow terminal so do the place and the operator of a mutant.
    """
    style = "bold red" if section.is_alarm else "bold"
    console.print(Text(f"\n{terminal_text(section.title)}", style=style, overflow="fold"))
    groups: list[list[int]] = []
    for index, name in enumerate(section.columns):
        both_long = groups and name.startswith("*") and section.columns[index - 1].startswith("*")
        if both_long or (
            is_narrow(console) and section.columns[index - 1 : index + 1] == ("place", "operator")
        ):
            groups[-1].append(index)
        else:
            groups.append([index])
    if groups:
        names = (" and ".join(section.columns[index] for index in group) for group in groups)
        table = make_table([name.replace(" and *", " and ") for name in names])
        for row in section.rows[:at_most]:
            table.add_row(
                *(
                    Breakable("\n".join(terminal_text(row[index]) for index in group if row[index]))
                    for group in groups
                )
            )
        console.print(table)
        _print_more(console, len(section.rows), at_most)
    for line in section.code.splitlines():
        console.print(Text(f"  {terminal_text(line)}"), soft_wrap=True)
    for line in section.lines[:at_most]:
        console.print(below(line.lstrip(), 2 + len(line) - len(line.lstrip())))
    _print_more(console, len(section.lines), at_most)


def _print_more(console: Console, count: int, at_most: int | None) -> None:
    if at_most is not None and count > at_most:
        console.print(below(f"and {count - at_most} more", style="dim"))


@frozen
class VerdictMark:
    """The display of an outcome: a letter, its colour, and its text in the legend."""

    letter: str
    style: str
    text: str


_BY_CHECK = VerdictMark("C", "green", "killed by a check")
_BY_EXCEPTION = VerdictMark("X", "cyan", "killed by an exception")
_OTHERS = {
    Verdict.SURVIVED: VerdictMark("S", "bold red", "survived"),
    Verdict.NOT_COVERED: VerdictMark("N", "red", "not covered"),
    Verdict.TIMEOUT: VerdictMark("T", "yellow", "killed by a timeout"),
    Verdict.REFUSED: VerdictMark("R", "blue", "refused by the robot"),
    Verdict.GUARDED: VerdictMark("G", "blue", "refused by the guard"),
    Verdict.INVALID: VerdictMark("I", "blue", "invalid"),
    Verdict.NO_EFFECT: VerdictMark("=", "dim", "no effect"),
    Verdict.UNSTABLE: VerdictMark("U", "magenta", "unstable"),
    Verdict.ERROR: VerdictMark("E", "bold magenta", "error"),
}
_ACCEPTED = VerdictMark("A", "dim", "survived, and is accepted")
_NOT_RUN = VerdictMark("·", "dim", "not run")
_ORDER = [_BY_CHECK, _BY_EXCEPTION, *_OTHERS.values(), _ACCEPTED, _NOT_RUN]
_LET_THROUGH = (_OTHERS[Verdict.SURVIVED], _OTHERS[Verdict.NOT_COVERED])


def mark_of(outcome: Outcome | None) -> VerdictMark:
    """Return the mark of an outcome; that of None means that it has not been run."""
    if outcome is None:
        return _NOT_RUN
    if outcome.verdict is Verdict.KILLED:
        return _BY_CHECK if outcome.by is By.CHECK else _BY_EXCEPTION
    return _OTHERS[outcome.verdict]


def marks_of(result: MutantResult) -> list[VerdictMark]:
    """Return a mark per round; rounds that let an accepted mutant through have one of their own."""
    marks = [mark_of(outcome) for outcome in result.rounds]
    return [_ACCEPTED if result.is_accepted and mark in _LET_THROUGH else mark for mark in marks]


def counts_of(marks: Iterable[VerdictMark]) -> list[tuple[VerdictMark, int]]:
    """Return the marks that occur with their counts, in the order of the legend."""
    marks = [*marks]
    return [(mark, marks.count(mark)) for mark in _ORDER if mark in marks]


def letters(rounds: Sequence[VerdictMark], *, many: bool = False) -> Text:
    """Return one letter per round, or the counts of letters if there are many."""
    if many:
        parts = [Text(f"{mark.letter}{count}", style=mark.style) for mark, count in counts_of(rounds)]
    else:
        parts = [Text(mark.letter, style=mark.style) for mark in rounds]
    return Text(" ").join(parts)


class _Legend(Text):
    """A text that breaks only between its entries, which three blanks separate."""

    def wrap(self, console: Console, width: int, **options: Any) -> Lines:
        """Wrap the text to a width."""
        lines: list[Text] = []
        for entry in self.split(_GAP):
            if lines and lines[-1].cell_len + len(_GAP) + entry.cell_len <= width:
                lines[-1] = Text.assemble(lines[-1], _GAP, entry)
            else:
                lines.append(entry)
        return Lines(lines)


def legend(marks: Iterable[VerdictMark]) -> Text:
    """Return the explanation of the letters that occur."""
    parts = [
        part for mark, _ in counts_of(marks) for part in ((mark.letter, mark.style), f" {mark.text}", _GAP)
    ]
    return _Legend.assemble(*parts[:-1])
