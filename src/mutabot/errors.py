"""The errors that mutabot raises on purpose.

    MutabotError
    ├── UsageError                  wrong command line, nothing to do with the user's files    (exit 2)
    │   ├── SelectionError          an id or a pattern that selects nothing
    │   └── MergeError              journals that are not the shards of one campaign
    ├── ConfigurationError          a configuration or vocabulary file that cannot be used     (exit 2)
    │   ├── VocabularyError         a mistake in a vocabulary
    │   └── UnknownNameError        a name that does not exist, with the nearest that does
    ├── BaselineError               the tests do not pass on the unmutated program             (exit 3)
    ├── NothingToDoError            no tests, no mutants, or every mutant refused              (exit 3)
    ├── ControlError                a control mutant ended wrongly                             (exit 4)
    ├── UnstableError               more tests are flaky than the configuration allows         (exit 4)
    ├── JournalError                the journal is missing, foreign or cannot be written       (exit 2)
    ├── PathError                   a path into an argument or result that does not fit
    ├── ExtensionError              a package beside the core that cannot be used              (exit 2)
    └── OperatorError               an operator of a package that breaks the contract          (exit 2)

Every message names the thing, the value, where it stands and what would have been right.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import IntEnum

#: signs of a value, and of a name, that a message shows
_SHOWN, _LONGEST_NAME = 80, 300


class ExitCode(IntEnum):
    """The number that a command ends with; ``meaning`` is what docs/verdicts.md says of it."""

    meaning: str

    def __new__(cls, code: int, meaning: str) -> ExitCode:
        """Make an exit code with its meaning."""
        member = int.__new__(cls, code)
        member._value_, member.meaning = code, meaning
        return member

    FINE = 0, "fine"
    SCORE_TOO_LOW = (
        1,
        "a score is under `--min-score` (or `min_score` in the configuration), in percent, a site tolerates "
        "more than a `demand` allows, or there is something that `--fail-on` names",
    )
    USAGE = 2, "the command line or a file is wrong"
    NOTHING_KNOWN = 3, "the tests fail on the original, there are no mutants, or none of them was valid"
    UNRELIABLE = (
        4,
        "a control ended wrongly, more errors than `error_limit` allows, too much is unstable, `--verify` "
        "found a disagreement, the journal lacks an outcome, or `mutabot merge` lacks a shard",
    )
    TOO_MANY_TIMEOUTS = 5, "more time-outs than `timeout_limit` allows"
    INTERNAL_ERROR = 70, "an internal error; `.mutabot/crash.txt` has the details"
    INTERRUPTED = 130, "interrupted by Ctrl-C; `mutabot results` shows the results so far"
    TERMINATED = 143, "ended by SIGTERM, as Ctrl-C ends it; `mutabot results` shows the results so far"


class MutabotError(Exception):
    """Base of all errors that mutabot raises on purpose.

    ``exit_code`` is what the command line ends with when the error reaches it.
    """

    exit_code: int = ExitCode.INTERNAL_ERROR


class UsageError(MutabotError):
    """The command line asks for something impossible."""

    exit_code = ExitCode.USAGE


class SelectionError(UsageError):
    """A selection names mutants that do not exist."""


class MergeError(UsageError):
    """Journals cannot be merged: they are not the shards of one campaign."""


class ConfigurationError(MutabotError):
    """A configuration or vocabulary file cannot be used.

    Attributes:
        file: the file as the user named it, or None where no file is to blame.
        key: the dotted key inside the file, or None.
        line: 1-based line, or None where it is not known.
    """

    exit_code = ExitCode.USAGE

    def __init__(
        self, problem: str, *, file: str | None = None, key: str | None = None, line: int | None = None
    ) -> None:
        self.file, self.key, self.line = file, key, line
        where = ":".join(str(part) for part in (file, line) if part is not None)
        parts = [part for part in (where, key) if part]
        super().__init__(f"{' · '.join(parts)}: {problem}" if parts else problem)


class VocabularyError(ConfigurationError):
    """A vocabulary contains a contradiction or an invalid value."""


class UnknownNameError(VocabularyError):
    """A vocabulary or configuration uses a name that does not exist."""


class BaselineError(MutabotError):
    """The tests fail on the unmutated program, so no verdict would mean anything."""

    exit_code = ExitCode.NOTHING_KNOWN


class NothingToDoError(MutabotError):
    """There are no tests, no mutants, or none that the robot accepted. Never to be read as 100 %."""

    exit_code = ExitCode.NOTHING_KNOWN


class ControlError(MutabotError):
    """A control mutant ended wrongly, so that the verdicts of this campaign cannot be trusted."""

    exit_code = ExitCode.UNRELIABLE


class UnstableError(MutabotError):
    """More tests are flaky than the configuration allows."""

    exit_code = ExitCode.UNRELIABLE


class JournalError(MutabotError):
    """The journal is missing, was not written by mutabot, or cannot be written.

    ``version`` is the journal's own, if another version of mutabot has written it.
    """

    exit_code = ExitCode.USAGE

    def __init__(self, message: str, *, version: int | None = None) -> None:
        super().__init__(message)
        self.version = version


class PathError(MutabotError):
    """A path into an argument or result does not fit the object it is used on.

    Attributes:
        step: the step that failed, as text; None where it is not about a step.
        known: names or keys that exist there.
    """

    def __init__(self, message: str, *, step: str | None = None, known: Iterable[str] = ()) -> None:
        super().__init__(message)
        self.step, self.known = step, tuple(known)


class StrangeValueError(PathError):
    """A value of the user's program is missing or no plain data, so mutabot neither reads nor changes it."""


class ExtensionError(MutabotError):
    """A package beside the core cannot be loaded, or brings something invalid."""

    exit_code = ExitCode.USAGE


class OperatorError(MutabotError):
    """An operator of a package violates the operator contract."""

    exit_code = ExitCode.USAGE


def text_of(error: BaseException) -> str:
    """Return the text of an exception; the name of its class if the user's code fails to give one."""
    return str(error) if has_text(error) else type(error).__name__


def has_text(error: BaseException) -> bool:
    """Return whether the code of an exception's class gives it a text."""
    try:
        str(error)
    except KeyboardInterrupt:
        raise
    except BaseException:  # whatever the program raises there, and the fatal control
        return False
    return True


def error_text(error: BaseException) -> str:
    """Return an exception's class and text."""
    return f"{type(error).__name__}: {text_of(error)}"


def in_short(names: Sequence[str], most: int = 3) -> str:
    """Return the first of these names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def plural(count: int, singular: str, several: str | None = None) -> str:
    """Return a count with its noun: ``1 mutant``, ``2 mutants``."""
    return f"{count} {singular if count == 1 else several or singular + 's'}"


def shortened(text: str, most: int = _SHOWN) -> str:
    """Return a text, shortened for a message."""
    return text if len(text) <= most else f"{text[:most]}…"


def nearest_name(name: str, known: Iterable[str], alike: float = 0.5) -> str | None:
    """Return the known name most like ``name``, or None if none is near: of ``alike`` letters, 0 to 1."""
    by_folded = {candidate.casefold(): candidate for candidate in known}
    from difflib import get_close_matches  # noqa: PLC0415  # slow, and most processes make no mistake

    matches = get_close_matches(name.casefold(), list(by_folded), n=1, cutoff=alike)
    return by_folded[matches[0]] if matches else None


def unknown_name_text(kind: str, name: str, known: Iterable[str], nearest: str | None = None) -> str:
    """Return a message for a name that does not exist: it suggests the nearest name, or lists all."""
    known = sorted(set(known))
    shown = shortened(name, _LONGEST_NAME)
    nearest = nearest or nearest_name(name, known)
    if nearest is not None:
        return f"unknown {kind} {shown!r}; did you mean {nearest!r}?"
    listed = ", ".join(known[:12]) + (" …" if len(known) > 12 else "")
    return f"unknown {kind} {shown!r}; known: {listed or 'none'}"
