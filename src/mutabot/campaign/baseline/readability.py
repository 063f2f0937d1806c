"""Whether the probes can be read at all: a campaign whose comparisons would say nothing does not begin."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mutabot.border.events import Problem, TestEnd
from mutabot.campaign.request import Progress
from mutabot.model import Probe, Vocabulary
from mutabot.vocabulary import problem_error

#: why a probe says nothing that was read without an error
_NOTHING = "it reads nothing (None); a probe returns what it reads"


def refuse_unreadable(vocabulary: Vocabulary, ends: Sequence[TestEnd]) -> None:
    """Refuse a probe that no test of the original can read.

    ``ends``: the tests that passed.

    Raises ConfigurationError that names the key, the reason and what is needed.
    """
    ends = _with_calls(ends)
    for probe in vocabulary.probes:
        reasons = [_why_not(probe, end) for end in ends]
        if reasons and all(reasons):
            text = f"{probe.target} cannot be read at the end of any test: {reasons[0]}"
            raise problem_error(Problem(probe.source, "call", text))


def note_readability(vocabulary: Vocabulary, ends: Sequence[TestEnd], progress: Progress) -> None:
    """Say which probes some tests cannot read, and that a clock never ticks."""
    ends = _with_calls(ends)
    for probe in vocabulary.probes:
        blind = {end.test: why for end in ends if (why := _why_not(probe, end)) is not None}
        if blind:
            test, why = next(iter(blind.items()))
            count = len({end.test for end in ends})
            progress.note(
                f"{probe.target} cannot be read in {len(blind)} of {count} tests, such as {test} ({why}): "
                "what survives there is not called indistinguishable"
            )
    if vocabulary.clock is not None and ends and all(end.simulated is None for end in ends):
        progress.note(
            f"the clock {vocabulary.clock.tick} never ticks in a test: there is no limit of simulated time"
        )


def _with_calls(ends: Sequence[TestEnd]) -> Sequence[TestEnd]:
    """The tests that have anything to do with the robot; all of them if none has."""
    return [end for end in ends if end.trace] or [end for end in ends if end.outcome != "skipped"]


def is_read(probe: Probe, names: Iterable[str]) -> bool:
    """Whether there is a value of the probe among these names."""
    return any(
        name == probe.target or (name.startswith(probe.target) and name[len(probe.target)] in ".[#")
        for name in names
    )


def _why_not(probe: Probe, end: TestEnd) -> str | None:
    if probe.target in end.unread:
        return end.unread[probe.target]
    return None if is_read(probe, end.probes) else _NOTHING
