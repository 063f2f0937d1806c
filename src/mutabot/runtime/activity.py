"""Activity of a mutant at work in a test."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.model.data import data_of, is_scalar_of_numpy
from mutabot.model.path import opaque
from mutabot.runtime.exceptions import KnownError, Refusal

#: refusals of one test that are kept
REFUSALS = 16
#: items of a list or tuple that is shown
_SHOWN = 12


@dataclass(slots=True)
class Activity:
    """What a mutant did in the running test.

    Attributes:
        hits: calls at its site.
        acted: hits at which it changed something.
        asked: whether it asked the robot something, which robots and mocks may count.
        example: value before and after, at the first hit at which it acted.
        refusals: how the robot refused mutated calls by exceptions, the latest last; not all of many.
        refusing_answer: the answer by which the robot refused a mutated call; None if there was none.
        failure: what went wrong in the tool or the operator itself, or None.
        is_of_text: whether the mutant is one of the program text, which makes no calls itself: a refusal
            then counts only if it ends the test.
        is_unknown: whether what the robot refused is no command at all.
        away: hits at which it stayed away, by the reason, as far as the operator says.
    """

    hits: int = 0
    acted: int = 0
    asked: bool = False
    example: tuple[Any, ...] | None = None
    refusals: tuple[Refusal, ...] = ()
    refusing_answer: str | None = None
    failure: str | None = None
    is_of_text: bool = False
    is_unknown: bool = False
    away: dict[str, int] = field(default_factory=dict)

    def copy(self) -> Activity:
        """Return an independent copy."""
        return replace(self, away=dict(self.away))

    @property
    def culprits(self) -> tuple[KnownError, ...]:
        """The refusals and all exceptions in them."""
        return tuple(error for refusal in self.refusals for error in refusal.noted)

    @property
    def refusal(self) -> str | None:
        """The robot's message where it refused a mutated call; None if it refused none."""
        return self.refusals[-1].text if self.refusals else self.refusing_answer


def shown(value: Any) -> Any:
    """Return a copy of a value for reports, made without running code of the program."""
    found = value if type(value) in (list, tuple) else data_of(value)
    if type(found) in (list, tuple) and len(found) <= _SHOWN:
        return tuple(shown(item) for item in found)
    if is_scalar_of_numpy(found):
        found = found.item()
    is_plain = found is None or type(found) in (bool, int, float, str)
    return found if is_plain else opaque(value)
