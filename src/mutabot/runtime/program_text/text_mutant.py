"""The active fault of mutants of program text, which is in place before any import."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

from mutabot.runtime.active_fault import ActiveFault, FaultContext
from mutabot.runtime.activity import Activity

if TYPE_CHECKING:
    from random import Random

    from mutabot.runtime.program_text.instrument import SessionText


class TextContext(FaultContext, Protocol):
    """The interface of a process whose program text can be instrumented."""

    text: SessionText | None


class TextMutant(ActiveFault):
    """A mutant of program text; its data are the number of its place, and its index there."""

    context: TextContext
    is_checked: ClassVar[bool] = False
    is_of_text: ClassVar[bool] = True

    def prepare_process(self) -> None:
        """Activate the alternative in place of the original."""
        if self.context.text is not None:
            self.context.text.alternatives.activate(*self.data)

    def start_test(self, test: str, random: Random) -> None:
        """Do nothing, as the text resets its own activity."""

    def end_test(self) -> None:
        """Leave the alternative active between tests."""

    def begin_count(self) -> None:
        """Do nothing, as the text resets its own activity."""

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        return self.context.text.activity if self.context.text is not None else Activity()
