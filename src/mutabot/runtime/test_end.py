"""Classify how a test ended, and by what: a check, an exception, a limit, a refusal, or the tool."""

from __future__ import annotations

import os
import re
import sys
from traceback import walk_tb
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeGuard

import pytest

from mutabot.errors import text_of
from mutabot.extensions import packages
from mutabot.model import By, Role, Vocabulary
from mutabot.model.events import TestEnd
from mutabot.model.path import class_name
from mutabot.runtime import FOLDER
from mutabot.runtime.exceptions import failure_in, is_due_to, leaves
from mutabot.runtime.executed_text import file_of
from mutabot.runtime.meter import TimeExceeded
from mutabot.runtime.paths import real_path
from mutabot.runtime.targets.target import is_named

if TYPE_CHECKING:
    import doctest

    from mutabot.runtime.activity import Activity
    from mutabot.runtime.interception.trace import Locator

#: where an object lies in memory differs from run to run and says nothing
_ADDRESS = re.compile(r"\b0x[0-9a-f]{6,16}\b")
#: exceptions that are checks or time-outs wherever they were raised; their modules may not be loaded
_CHECKS = ("doctest:DocTestFailure",)
_TIMEOUTS = ("hypothesis.errors:DeadlineExceeded",)
#: what lets the suite pass
PASSED, SKIPPED, XFAILED, XPASSED = "passed", "skipped", "xfailed", "xpassed"
FAILED = "failed"


def classify(
    error: BaseException, test: str, file: str, locator: Locator, vocabulary: Vocabulary, activity: Activity
) -> TestEnd:
    """Return the test end that an exception means: why the test failed, and nothing else.

    Of exceptions that hold others, such as exception groups, what they hold decides: a refusal if all are, a
    check if all are that are no refusals; a time-out or a failure if one is.

    Args:
        error: what pytest caught.
        test: node id of the test.
        file: its file, whose folder holds the test's own helpers.
    """
    found = leaves(error)
    culprits = activity.culprits
    is_refused = is_due_to(error, culprits)
    counting = [leaf for leaf in found if is_refused or not is_due_to(leaf, culprits)]
    no_checks = [leaf for leaf in counting if not _is_check(leaf, file, locator, vocabulary)]
    overdue = next((leaf for leaf in found if _is_timeout(leaf)), None)
    shown = overdue or (no_checks or counting)[0]
    is_syntax = all(isinstance(leaf, SyntaxError) for leaf in found)
    return TestEnd(
        test,
        FAILED,
        by=By.EXCEPTION if no_checks else By.CHECK,
        exception=class_name(type(shown)),
        message=_text(shown, len(found)),
        place=_place(shown, locator),
        timeout=_lines(shown)[0] if overdue is not None else None,
        failure=failure_in(error, vocabulary.failures),
        refused=activity.refusal if is_refused else None,
        # a mutant of the program text made a text that is no program or no command
        invalid=activity.is_of_text and (is_syntax or (activity.is_unknown and is_refused)),
    )


def of_activity(end: TestEnd, activity: Activity, cause: TestEnd | None = None) -> dict[str, Any]:
    """Return a mutant's activity as fields of the end of a test.

    ``cause``: what ended it otherwise: also what a test said that it would do.
    """
    cause = cause or end
    refusal = activity.refusal
    if activity.is_of_text and cause.refused is None:
        refusal = None
    # what follows a refusal that is data follows from what the program makes of it
    is_caught = refusal is not None and activity.refusing_answer is None
    # a test that looks at what the robot was asked fails by that, even if nothing changed
    is_asking = activity.asked and end.outcome == FAILED
    return {
        "failure": activity.failure or cause.failure,
        "invalid": cause.invalid,
        "refused": refusal,
        "caught": is_caught and end.outcome == FAILED and cause.refused is None,
        "hits": activity.hits,
        "acted": activity.acted or int(is_asking),
        "away": activity.away,
        "example": activity.example,
    }


def outcome_so_far(report: pytest.TestReport, before: str) -> str:
    """Return the outcome of a test with one more report that is no failure.

    The report of the call comes after those of its subtests and says what they come to; set-up and
    tear-down count where they did not simply pass.
    """
    is_expected = hasattr(report, "wasxfail")
    if report.skipped:
        return XFAILED if is_expected else SKIPPED
    if report.when == "call":
        return XPASSED if is_expected else PASSED
    return before


def _text(error: BaseException, count: int) -> str:
    """Return the text of an exception, shortened; ``count`` is the size of its group."""
    lines = _lines(error)[:12]
    if count > 1:
        lines.append(f"(one of {count} exceptions in a group)")
    return "\n".join(lines)[:2000]


def _lines(error: BaseException) -> list[str]:
    text = text_of(error)
    if isinstance(error, pytest.FixtureLookupError):
        text = error.msg or f"fixture {error.argname!r} not found"
    elif _is_mismatch(error):
        source, want, output = error.example.source.strip(), error.example.want.strip(), error.got.strip()
        text = f"{source}: expected {want or 'nothing'}, got {output or 'nothing'}"
    return _ADDRESS.sub("0x…", text).strip().splitlines() or [type(error).__name__]


def _is_timeout(error: BaseException) -> bool:
    """Return whether a time limit ended the test, mutabot's or the suite's own."""
    if isinstance(error, TimeExceeded) or is_named(error, _TIMEOUTS):
        return True
    return isinstance(error, pytest.fail.Exception) and any(
        frame.f_globals.get("__name__") == "pytest_timeout" for frame, _ in _from_the_raise(error)
    )


def _is_check(error: BaseException, test_file: str, locator: Locator, vocabulary: Vocabulary) -> bool:
    if is_named(error, (*_CHECKS, *vocabulary.checks)) or isinstance(error, pytest.fail.Exception):
        return True
    if not isinstance(error, AssertionError):
        return False
    # An assertion is a check if the tests made it. Code of helper libraries says nothing, so the frame
    # nearest to the raise decides that is the tests', the program's or an operation's.
    folder = os.path.dirname(os.path.realpath(test_file)) + os.sep
    for frame, _ in _from_the_raise(error):
        filename = real_path(file_of(frame.f_code))
        package = str(frame.f_globals.get("__name__", "")).partition(".")[0]
        if filename.startswith(FOLDER) or package in packages():  # such bring operators, or hooks
            return False
        role = locator.role(filename)
        if role is Role.PROGRAM:
            return False
        if role is Role.ORACLE or filename.startswith(folder) or filename.endswith("conftest.py"):
            return True
    return True


def _from_the_raise(error: BaseException) -> list[tuple[FrameType, int]]:
    """Return the frames that the exception came through and the lines they were at, innermost first."""
    return list(walk_tb(error.__traceback__))[::-1]


def _place(error: BaseException, locator: Locator) -> str | None:
    """Return the innermost line that is the user's own: below the root and not installed."""
    lines = [(file_of(frame.f_code), line) for frame, line in _from_the_raise(error)]
    if _is_mismatch(error) and error.test.filename is not None and error.test.lineno is not None:
        lines.append((error.test.filename, error.test.lineno + error.example.lineno + 1))
    for filename, line in lines:
        if locator.is_of_project(filename):
            return f"{locator.relative(filename)}:{line}"
    return None


def _is_mismatch(error: Any) -> TypeGuard[doctest.DocTestFailure]:
    """Return whether an example of a doctest gave an unexpected result."""
    module = sys.modules.get("doctest")  # who raised it has imported it
    return module is not None and isinstance(error, module.DocTestFailure)
