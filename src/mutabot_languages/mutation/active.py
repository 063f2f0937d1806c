"""A mutant of a program's text in the processes of the tests: what is loaded there is another text."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.api.faults import ActiveFault
from mutabot_languages.edits import ActiveEdits, Edit, activate


class TextDifference(ActiveFault):
    """Programs that are loaded while a test runs have the mutant's text.

    What the program raises then comes from this package as well, and is the program's error.
    """

    is_checked: ClassVar[bool] = False

    def start_test(self, test: str, random: Random) -> None:
        """From now on."""
        edits = [Edit(*one) for one in self.data["edits"]]
        self._edits = ActiveEdits(self.data["file"], self.data["digest"], edits, self.acts)
        activate([self._edits])

    def end_test(self) -> None:
        """No longer."""
        activate(())
        for missed in self._edits.missed:
            self.reached()
            self.evidence.away[missed] = 1
