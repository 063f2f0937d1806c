"""What ended a test: a check, an exception, a limit, a refusal, or a failure of the tool."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType

import pytest

from mutabot.errors import MutabotError
from mutabot.model import By, Role, Vocabulary

from .activate import Evidence, is_named
from .limits import BudgetExceeded
from .locate import Locator

#: where an object lies in memory differs from run to run and says nothing
_ADDRESS = re.compile(r"\b0x[0-9a-f]{6,16}\b")
_INSIDE = os.path.dirname(os.path.realpath(__file__))


@dataclass(frozen=True, slots=True)
class Ending:
    """Why a test failed; the fields are those of ``TestEnd`` with the same names.

    ``is_syntax`` says that some text was no program.
    """

    by: By
    phase: str
    exception: str
    message: str
    place: str | None
    timeout: str | None = None
    failure: str | None = None
    refused: str | None = None
    is_syntax: bool = False

    @property
    def is_mere_check(self) -> bool:
        """Whether a check ended the test, and nothing else was the matter."""
        return self.by is By.CHECK and self.timeout is None and self.failure is None


def classify(
    error: BaseException,
    phase: str,
    test_file: str,
    locator: Locator,
    vocabulary: Vocabulary,
    evidence: Evidence,
) -> Ending:
    """The ending that this exception means.

    Args:
        error: what pytest caught.
        phase: ``setup``, ``call`` or ``teardown``.
        test_file: file of the test; its folder holds the test's own helpers.
    """
    kind = type(error)
    return Ending(
        by=By.CHECK if _is_check(error, test_file, locator, vocabulary) else By.EXCEPTION,
        phase=phase,
        exception=f"{kind.__module__}:{kind.__qualname__}",
        message=_text(error),
        place=_place(error, locator),
        timeout=str(error) if isinstance(error, BudgetExceeded) else None,
        failure=_failure(error, vocabulary),
        refused=_refusal(error, evidence),
        is_syntax=isinstance(error, SyntaxError),
    )


def _text(error: BaseException) -> str:
    text = _ADDRESS.sub("0x…", str(error))
    if isinstance(error, pytest.FixtureLookupError):
        text = error.msg or f"fixture {error.argname!r} not found"
    lines = text.strip().splitlines() or [type(error).__name__]
    return "\n".join(lines[:12])[:2000]


def _failure(error: BaseException, vocabulary: Vocabulary) -> str | None:
    for link in _chain(error):
        if isinstance(link, MemoryError):
            return "the memory limit was reached"
        if isinstance(link, MutabotError) and not type(link).__module__.startswith("mutabot.cells"):
            return f"{type(link).__name__}: {link}"
        if is_named(link, vocabulary.failures):
            return f"{type(link).__name__}: {link}"
    return None


def _refusal(error: BaseException, evidence: Evidence) -> str | None:
    if evidence.refusal is not None and any(link is evidence.refusal for link in _chain(error)):
        return str(evidence.refusal)
    return None


def _chain(error: BaseException) -> Iterator[BaseException]:
    seen: set[int] = set()
    link: BaseException | None = error
    while link is not None and id(link) not in seen:
        seen.add(id(link))
        yield link
        link = link.__cause__ or (None if link.__suppress_context__ else link.__context__)


def _is_check(error: BaseException, test_file: str, locator: Locator, vocabulary: Vocabulary) -> bool:
    if is_named(error, vocabulary.checks) or isinstance(error, pytest.fail.Exception):
        return True
    if not isinstance(error, AssertionError):
        return False
    # An assertion is a check if the tests made it. Code of helper libraries says nothing, so the frame
    # nearest to the raise decides that is the tests', the program's or an operation's.
    folder = os.path.dirname(os.path.realpath(test_file)) + os.sep
    for frame, _ in _from_the_raise(error):
        filename = locator.real(frame.f_code.co_filename)
        if filename.startswith(_INSIDE):
            return False
        role = locator.role(filename)
        if role is Role.PROGRAM:
            return False
        if role is Role.ORACLE or filename.startswith(folder) or filename.endswith("conftest.py"):
            return True
    return True


def _from_the_raise(error: BaseException) -> list[tuple[FrameType, int]]:
    """The frames that the exception came through and the lines they were at, innermost first."""
    frames = []
    traceback = error.__traceback__
    while traceback is not None:
        frames.append((traceback.tb_frame, traceback.tb_lineno))
        traceback = traceback.tb_next
    return frames[::-1]


def _place(error: BaseException, locator: Locator) -> str | None:
    """The innermost line that is the user's own: the file lies under the root and is not installed."""
    for frame, line in _from_the_raise(error):
        filename = frame.f_code.co_filename
        relative = locator.relative(filename)
        if not relative.startswith("..") and "site-packages" not in relative and not filename.startswith("<"):
            return f"{relative}:{line}"
    return None
