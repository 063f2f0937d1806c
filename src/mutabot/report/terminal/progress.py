"""Progress of a campaign: a bar with the time left on a terminal, a plain line now and then elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn
from rich.table import Column

from mutabot.report.terminal.console import plain

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
_BAR, _OTHERS = 10, 9 + 7 + 6


def _column(width: int | None = None, ratio: int | None = None) -> Column:
    return Column(min_width=width, max_width=width, ratio=ratio, no_wrap=True, overflow="ellipsis")


def make_progress(console: Console) -> Bar | Lines:
    """Make the progress that fits the console; each is one as ``mutabot.campaign`` wants it."""
    return Bar(console) if console.is_terminal else Lines(console)


class Bar:
    """A bar per stage on a terminal, each on one line: texts are cut before the bar is."""

    def __init__(self, console: Console) -> None:
        console.width -= _SPARE
        room = max(10, min(40, console.width - _BAR - _OTHERS))
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
        """Move the bar on; ``line`` stands beside it."""
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
