"""How a test ends for the suite, from pytest's reports of its phases and subtests."""

from __future__ import annotations

import pytest

#: what lets the suite pass
PASSED, SKIPPED, XFAILED, XPASSED = "passed", "skipped", "xfailed", "xpassed"
FAILED = "failed"


def is_expected_failure(report: pytest.TestReport) -> bool:
    """Whether something failed as the test said it would."""
    return report.skipped and hasattr(report, "wasxfail")


def outcome_so_far(report: pytest.TestReport, before: str) -> str:
    """The outcome of a test with one more report that is no failure.

    The report of the call comes after those of its subtests and says what they come to; set-up and
    tear-down count where they did not simply pass.
    """
    is_expected = hasattr(report, "wasxfail")
    if report.skipped:
        return XFAILED if is_expected else SKIPPED
    if report.when == "call":
        return XPASSED if is_expected else PASSED
    return before
