"""The one letter, the colour and the words that stand for an outcome in every terminal table."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rich.text import Text

from mutabot.model import By, Outcome, Verdict


@dataclass(frozen=True, slots=True)
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
