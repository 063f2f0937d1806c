"""Show a campaign's progress: bars with times on a terminal, plain lines elsewhere.

Both print survivors as they are found, and count how mutants ended.
"""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TaskID, TextColumn
from rich.table import Column
from rich.text import Text

from mutabot.report.texts import one_line, places_text

from .console import short_place, terminal_text

if TYPE_CHECKING:
    from mutabot.model.mutant_end import MutantEnd

#: part of a stage after which the time left is worth telling: the first steps say little about the others
_TELLING = 0.1
#: part of the time so far, and seconds, beyond which the last step is too long ago: steps that come many at
#: once, as those of tests with many mutants do, say nothing about the rest while there is none
_STALE, _RECENT = 0.25, 5.0
_NOT_COVERED = "not covered"
#: states that are shown at once
_SHOWN = ("survived", _NOT_COVERED)


class Pace:
    """The pace of the steps of one stage.

    Args:
        total: how many there are; None if that is not known.
        clock: seconds that count.

    Attributes:
        total, done: steps.
    """

    def __init__(self, total: int | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self.total, self.done = total, 0
        self._clock = clock
        self._began = self._last = clock()

    def advance(self) -> None:
        """Count one more step."""
        self.done += 1
        self._last = self._clock()

    @property
    def spent(self) -> float:
        """Seconds since the stage began."""
        return self._clock() - self._began

    @property
    def is_over(self) -> bool:
        """Whether all steps are done."""
        return self.total is not None and self.done >= self.total

    @property
    def idle(self) -> float:
        """Seconds since the last step."""
        return self._clock() - self._last

    @property
    def left(self) -> float | None:
        """Seconds until the stage ends; None if too few steps are done to estimate that."""
        if self.total is None or self.done == 0 or self.done < _TELLING * self.total:
            return None
        spent = self.spent
        if self.idle > max(_STALE * spent, _RECENT):
            return None
        return spent / self.done * max(0, self.total - self.done)

    @property
    def text(self) -> str:
        """The times as text: ``0:08 elapsed, 0:20 left``; how long it took when all is done."""
        if self.is_over:
            return f"took {clock_text(self._last - self._began)}"
        left = self.left
        return f"{clock_text(self.spent)} elapsed" + ("" if left is None else f", {clock_text(left)} left")


def clock_text(seconds: float) -> str:
    """Return ``1:02:03`` or ``2:03``."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


class Tally:
    """Counts the last outcomes of mutants in each round."""

    def __init__(self) -> None:
        self._states: dict[tuple[str, int], str] = {}
        self._counts: Counter[str] = Counter()
        self._shown: set[str] = set()
        self._is_shown = False

    def stage(self) -> None:
        """Show no counts until an outcome is added: those of an earlier stage say nothing of the next."""
        self._is_shown = False

    def add(self, end: MutantEnd) -> str | None:
        """Count an outcome. Return a message if a survivor is new, or no longer one."""
        self._is_shown = True
        key, state = (end.mutant.id, end.outcome.round), end.state
        before = self._states.get(key)
        if before == state:
            return None
        if before is not None:
            self._counts[before] -= 1
        self._states[key] = state
        self._counts[state] += 1
        # of a place that no test reaches, the mutants are listed together
        shown = end.mutant.site.id if state == _NOT_COVERED else end.mutant.id
        is_new = state in _SHOWN and shown not in self._shown
        if end.mutant.has_sizes or not (is_new or before in _SHOWN):
            return None
        self._shown.add(shown)
        if end.is_reused:
            return None
        mutant = end.mutant
        place = one_line(places_text(mutant.site, short_place))
        if state == _NOT_COVERED:
            return f"{state}: {place} {mutant.site.text}: no test reaches it (round {end.outcome.round + 1})"
        what = f"{mutant.number} {place} {mutant.operator}: {mutant.description}"
        return f"{state}: {what} (round {end.outcome.round + 1})"

    @property
    def text(self) -> str:
        """The counts as text: ``killed 35, survived 4``; empty if no mutant ended in this stage."""
        if not self._is_shown:
            return ""
        return ", ".join(f"{state} {self._counts[state]}" for state in _ORDER if self._counts[state])


#: the order in which states are counted
_ORDER = (
    "killed", "timeout", "survived", "not covered", "accepted", "refused", "guarded", "invalid", "no effect",
    "unstable", "error",
)  # fmt: skip

#: seconds between two plain lines
EVERY = 30.0

#: columns that stay free at the right: a ^C that the terminal prints there must not begin another line
_SPARE = 3
#: columns of the bar; of the count, the times and the gaps beside it; and from where on there is room for it
_BAR, _BESIDE_BAR, _ROOM_FOR_BAR = 10, 9 + 26 + 6, 70


def _column(width: int | None = None, ratio: int | None = None) -> Column:
    return Column(min_width=width, max_width=width, ratio=ratio, no_wrap=True, overflow="ellipsis")


def make_progress(console: Console) -> Bar | Lines:
    """Return the progress display that suits the console."""
    return Bar(console) if console.is_terminal else Lines(console)


class _Times(ProgressColumn):
    """A column with the elapsed and the remaining time of a stage."""

    def render(self, task: Task) -> Text:
        """Return both times as text."""
        pace = task.fields["pace"]
        return Text(pace.text if isinstance(pace, Pace) else "")


class Bar:
    """A bar per stage on a terminal, in one line each, in which texts are cut before the bar."""

    def __init__(self, console: Console) -> None:
        console.width -= _SPARE
        bar = _BAR if console.width >= _ROOM_FOR_BAR else 0
        room = max(8, min(40, console.width - bar - _BESIDE_BAR))
        self._progress = Progress(
            TextColumn("{task.description}", markup=False, table_column=Column(max_width=room, no_wrap=True)),
            *([BarColumn(bar_width=bar, table_column=_column(bar))] if bar else []),
            MofNCompleteColumn(table_column=_column(9)),
            _Times(table_column=Column(no_wrap=True)),
            TextColumn("{task.fields[line]}", markup=False, table_column=_column(ratio=1)),
            console=console,
            expand=True,
        )
        self._task: TaskID | None = None
        self._pace, self._tally = Pace(), Tally()

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin another bar."""
        self._close_stage()
        self._tally.stage()
        self._pace = Pace(total)
        self._task = self._progress.add_task(text, total=total, line="", pace=self._pace)

    def mutant_ended(self, end: MutantEnd) -> None:
        """Count an outcome, and print a survivor above the bars."""
        text = self._tally.add(end)
        if text is not None:
            self._progress.console.print(
                Text(terminal_text(text), style="red" if end.state in _SHOWN else "")
            )

    def advance(self, line: str | None = None) -> None:
        """Advance the progress bar, and show the counts beside it, or ``line`` if there are none."""
        self._pace.advance()
        if self._task is not None:
            text = self._tally.text or terminal_text(line or "").partition("\n")[0]
            self._progress.update(self._task, advance=1, line=text)

    @property
    def left(self) -> float | None:
        """Seconds until the stage ends; None if that cannot be estimated yet."""
        return self._pace.left

    def note(self, text: str) -> None:
        """Print a line above the bars."""
        self._progress.console.print(terminal_text(text))

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
    """Plain lines: the start and end of each stage, survivors, and the progress every half minute.

    The progress is also printed while no mutant ends: a CI ends a job that prints nothing for minutes.
    """

    def __init__(self, console: Console, *, every: float = EVERY) -> None:
        self._console, self._every = console, every
        self._text, self._pace, self._tally = "", Pace(), Tally()
        self._last = time.monotonic()
        self._lock, self._is_over = threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._live, name="mutabot-progress", daemon=True)

    def stage(self, text: str, total: int | None = None) -> None:
        """Print the stage's name, and how many steps it has, as later lines do: ``mutants 0/100``."""
        self._tally.stage()
        self._text, self._pace = text, Pace(total)
        self._print(f"{text} 0/{total}" if total is not None else text)

    def mutant_ended(self, end: MutantEnd) -> None:
        """Count an outcome, and print a survivor."""
        text = self._tally.add(end)
        if text is not None:
            self._print(text)

    def advance(self, line: str | None = None) -> None:
        """Count a step, and print the progress if the last line about it is long enough ago."""
        self._pace.advance()
        if self._pace.done == self._pace.total or time.monotonic() - self._last >= self._every:
            self._print_progress(line)

    @property
    def left(self) -> float | None:
        """Seconds until the stage ends; None if that cannot be estimated yet."""
        return self._pace.left

    def note(self, text: str) -> None:
        """Print a line."""
        self._print(text)

    def _print_progress(self, line: str | None = None, *, is_life_sign: bool = False) -> None:
        self._last = time.monotonic()
        pace = self._pace
        of = "" if pace.total is None else f"/{pace.total}"
        counts = self._tally.text or line
        times = pace.text + (f", {clock_text(pace.idle)} ago" if is_life_sign and pace.is_over else "")
        self._print(f"{self._text} {pace.done}{of}: {times}{f' ({counts})' if counts else ''}")

    def _live(self) -> None:
        while not self._is_over.wait(self._every / 10):
            if self._text and time.monotonic() - self._last >= self._every:
                self._print_progress(is_life_sign=True)

    def _print(self, text: str) -> None:
        with self._lock:
            self._console.print(terminal_text(text), soft_wrap=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._is_over.set()
        self._thread.join()
