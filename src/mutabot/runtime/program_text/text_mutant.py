"""The active fault of mutants of program text, which is in place before any import."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from mutabot.runtime.active_fault import ActiveFault, FaultContext
from mutabot.runtime.activity import Activity

if TYPE_CHECKING:
    from random import Random

    from mutabot.model import Mutant
    from mutabot.runtime.program_text.instrument import SessionText


class TextContext(FaultContext, Protocol):
    """The interface of a process whose program text can be instrumented."""

    text: SessionText | None


class TextMutant(ActiveFault):
    """A mutant of program text.

    ``data``: the number of its place, and its index there. If tests read the file as text, also what
    ``Activation.with_file`` adds: then the file is changed as well, as compiled code would not show there.
    Code of it that is loaded in a process has the alternative; what is loaded later has the text.
    """

    context: TextContext
    is_checked: ClassVar[bool] = False
    is_of_text: ClassVar[bool] = True

    def __init__(self, mutant: Mutant, data: Any, context: TextContext) -> None:
        super().__init__(mutant, data, context)
        self._place, self._index, *self._changed = data

    def prepare_process(self) -> None:
        """Activate the alternative in place of the original."""
        text = self.context.text
        if self._changed:
            file, content, (start, end, written) = self._changed
            self.context.change_file(file, f"{content[:start]}{written}{content[end:]}".encode("latin-1"))
            if text is not None:
                text.leave_out(file)
            self.acts()  # whatever reads the file from here on gets the mutant
        if text is not None:
            text.alternatives.activate(self._place, self._index)

    def start_test(self, test: str, random: Random) -> None:
        """Note that a changed file is active; the text resets its own activity."""
        if self._changed:
            self.acts()

    def end_test(self) -> None:
        """Leave the alternative active between tests."""

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        if self._changed:
            return self._activity
        return self.context.text.activity if self.context.text is not None else Activity()
