"""Tests that fail on the original: an error if they do in every round, set aside in a single one.

Each is named with its seed and with the command that makes plain pytest draw the seeds of that round.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping

from mutabot.border.events import TestEnd
from mutabot.campaign.request import Request
from mutabot.errors import BaselineError
from mutabot.model.seed import CAMPAIGN_SEED_VARIABLE, DEFAULT_SEED, ROUND_VARIABLE, derive

#: how the reason begins why such a test is set aside: its seed makes it fail, not chance
FAILS = "fails on the unmutated program"
#: the tests that fail in all runs of a round, by (round, test)
Failing = Mapping[tuple[int, str], TestEnd]


def rounds_to_repeat(ends: Mapping[int, Iterable[TestEnd]]) -> list[int]:
    """The rounds that a second run says more about: tests fail in them, and none fails in all rounds.

    With a single round, that is the one if tests fail in it.
    """
    failed = {round: {end.test for end in these if end.outcome == "failed"} for round, these in ends.items()}
    if len(failed) > 1 and set.intersection(*failed.values()):
        return []
    return [round for round, tests in sorted(failed.items()) if tests]


def repeat_command(request: Request, round: int, test: str) -> str:
    """What to type to run this test with plain pytest as in this round, from the project's folder."""
    variables = f"{ROUND_VARIABLE}={round + 1}"
    if request.seed != DEFAULT_SEED:
        variables += f" {CAMPAIGN_SEED_VARIABLE}={request.seed}"
    return f"{variables} {shlex.join(['pytest', *request.configuration.pytest_args, test])}"


def why_set_aside(request: Request, round: int, end: TestEnd) -> str:
    """Why a test that fails on the original in this round is set aside in it."""
    seed = derive(request.seed, round, end.test)
    text = f"{FAILS} with seed {seed}: {_first_line(end)}"
    return f"{text}; repeat it by {repeat_command(request, round, end.test)}"


def refuse_failing(request: Request, failing: Failing) -> None:
    """Raise BaselineError if a test fails in all rounds."""
    rounds = range(request.rounds)
    always = [end for (_, test), end in failing.items() if all((round, test) in failing for round in rounds)]
    found = list({end.test: end for end in reversed(always)}.values())[::-1]
    if not found:
        return
    where = "in round 1" if request.rounds == 1 else f"in all {request.rounds} rounds"
    shown = "\n".join(f"  {end.test}: {_first_line(end)}" for end in found[:10])
    more = f"\n  … and {len(found) - 10} more" if len(found) > 10 else ""
    noun = "test fails" if len(found) == 1 else "tests fail"
    again = f"\nrepeat by {repeat_command(request, 0, found[0].test)}"
    raise BaselineError(
        f"{len(found)} {noun} on the unmutated program {where}:\n{shown}{more}{again}",
        tests=[end.test for end in found],
    )


def _first_line(end: TestEnd) -> str:
    lines = (end.message or "").strip().splitlines()
    return lines[0] if lines else "no message"
