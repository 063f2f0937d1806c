"""A mutant of a program's text in the processes of the tests: what is run there is another text."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.api.faults import ActiveFault
from mutabot_languages.edits import ActiveEdits, Edit, activate, were_read
from mutabot_languages.errors import LanguageError


class TextDifference(ActiveFault):
    """Programs that this process runs have the mutant's text, also before any test and between two.

    What the program raises then comes from this package as well, and is the program's error.
    """

    is_checked: ClassVar[bool] = False
    is_of_text: ClassVar[bool] = True

    def prepare_process(self) -> None:
        """Activate the edits. Raises LanguageError if the file has already run here as the original."""
        edits = [Edit(*fields) for fields in self.data["edits"]]
        self._edits = ActiveEdits(self.data["file"], self.data["digest"], edits, self._reached)
        self._has_acted = False
        if any(map(self._edits.is_of, were_read())):
            raise LanguageError(
                f"{self._edits.file} was run before the first test, where this process was not yet the "
                "mutant; run it in a fixture or a test, or choose --engine replay"
            )
        activate([self._edits])

    def start_test(self, test: str, random: Random) -> None:
        """Go on; what the program did before may be looked at in this test."""
        if self._has_acted:
            self.acts()

    def end_test(self) -> None:
        """Go on, and say of which file it is not known whether it is the mutant's."""
        for missed in self._edits.missed:
            self.reached()
            self.activity.away[missed] = 1
        self._edits.missed.clear()

    def _reached(self) -> None:
        self._has_acted = True
        self.acts()
