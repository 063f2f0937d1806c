"""What reading and running a robot program can raise."""

from __future__ import annotations

from mutabot.api.reports import MutabotError


class LanguageError(MutabotError):
    """A program cannot be read or run."""


class ProgramError(RuntimeError):
    """The program itself stops with an error, as a controller would: a mutant of it is killed."""


class UnreachableError(ValueError):
    """No joint angles bring the tool to a pose; the statement that asks for them ends by a ``ProgramError``.

    Attributes:
        is_limit: whether there would be some, beyond the joints' limits.
    """

    def __init__(self, text: str, *, is_limit: bool) -> None:
        super().__init__(text)
        self.is_limit = is_limit


class UnsupportedError(LanguageError):
    """The program uses something that is not carried out; the message names it and its line."""
