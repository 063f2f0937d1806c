"""What reading and running a robot program can raise."""

from __future__ import annotations

from mutabot.api.reports import MutabotError


class LanguageError(MutabotError):
    """A program cannot be read or run."""


class ProgramError(RuntimeError):
    """The program itself stops with an error, as a controller would: a mutant of it is killed."""


class UnreachableError(ValueError):
    """A pose is out of reach; the statement that goes there makes a ``ProgramError`` of it."""


class UnsupportedError(LanguageError):
    """The program uses something that is not carried out; the message names it and its line."""
