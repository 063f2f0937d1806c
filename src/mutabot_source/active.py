"""A mutant that really changes its file, in the test processes."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.api.faults import ActiveFault


class ChangedText(ActiveFault):
    """A program file with a mutant in its text, for tests that read the file as text.

    ``data``: the file, what it holds, in Latin-1, and what stands where in it then: the first byte, the one
    after the last, and the text.
    """

    is_of_text: ClassVar[bool] = True

    def prepare_process(self) -> None:
        """Change the file, before anything imports or reads it."""
        start, end, text = self.data["edit"]
        content = self.data["content"]
        changed = f"{content[:start]}{text}{content[end:]}"
        self.context.change_file(self.data["file"], changed.encode("latin-1"))
        self.acts()  # whatever reads or imports the file from here on gets the mutant

    def start_test(self, test: str, random: Random) -> None:
        """Note that the mutant is active."""
        self.acts()

    def end_test(self) -> None:
        """Do nothing: the mutant is active from the first test to the last."""
