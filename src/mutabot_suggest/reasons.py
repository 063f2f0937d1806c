"""Explains in a sentence why no check kills a survivor."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mutabot.api.reports import MutantResult

from .bands import band_of
from .candidates import ONLY_TIME
from .checks import CheckProposal, Monitor
from .forms import is_clock, is_number, last_name
from .project import in_one_line
from .readings import Measured, is_reading, reading_of
from .results import Unsolved
from .suite import SuiteChecks

NOTHING_DIFFERS = (
    "nothing that was compared differs from the original (indistinguishable): "
    "another [[probe]] may show a difference; if not, accept them"
)
_CHECK_THERE = "a check on the way may notice it"
NOTHING_READ = f"nothing that was read at the ends of its tests differs: {_CHECK_THERE}"
NO_PROBE = (
    "nothing that was read at the ends of its tests differs; a [[probe]] in the vocabulary may show more"
)
#: the reason where a recording of the world shows the same movements
LATER = "only times differ: add a deadline if the task has one"
NOT_REACHED = "no test reaches it: add a test that does"
#: a difference in what a function of the program returned
_RETURNED = re.compile(r"(\w+) returned (?!to )")
#: m, and degrees, below which a way is too near to the original for a monitor
_NEAR, _TURNED = 0.03, 15.0
#: how the line of a difference begins that a probe shows only after a command, not at the end of the test
_WAY = "on the way, "
#: how the reason begins for a survivor that the suite allows
_SO_LITTLE = "at most"
#: the reason where only the way differs
_END_ALLOWED = "at the end within your smallest tolerance of"
#: what a thing moves that a robot holds
_IN_GRIP = {"slip", "drag"}
#: names of lengths and of angles in checks
_LENGTHS, _ANGLES = {"x", "y", "z"}, {"theta_x", "theta_y", "theta_z", "roll", "pitch", "yaw"}


def why_unsolved(
    survivor: MutantResult,
    measured: Measured,
    suite: SuiteChecks,
    found: Sequence[CheckProposal],
    failed: Mapping[CheckProposal, str],
    refused: Mapping[str, str],
) -> Unsolved:
    """Return the reason for a survivor: how its checks failed, or how little of it differs."""
    mutant = survivor.mutant.id
    recorded = _of_recordings(survivor, measured, suite)
    if recorded.startswith(_SO_LITTLE) or recorded == LATER:
        return Unsolved(mutant, recorded)
    gaps = [gap for outcome in survivor.survived for gap in outcome.gaps]
    if gaps and not recorded:  # what its readings differ by may be the original's own
        return Unsolved(mutant, f"it could not be compared with the original: {gaps[0]}")
    tried = [proposal for proposal in found if proposal in failed and mutant in dict(proposal.trials)]
    if _END_ALLOWED in recorded:  # what a test reads at its end is then no check of what differs
        tried = [proposal for proposal in tried if isinstance(proposal, Monitor)]
    if tried:
        return Unsolved(mutant, _why_failed(tried[0], failed[tried[0]]))
    if mutant in measured.lost:
        return Unsolved(mutant, measured.lost[mutant])
    if recorded:
        return Unsolved(mutant, recorded)
    refusal, passed = refused.get(mutant, ""), _on_the_way(survivor)
    if refusal and not (passed and refusal == ONLY_TIME):
        return Unsolved(mutant, refusal)
    is_probed = any(outcome.distance is not None for outcome in survivor.survived)
    if survivor.indistinguishable:
        unread = NOTHING_DIFFERS
    else:
        unread = _allowed(survivor) or (NOTHING_READ if is_probed else NO_PROBE)
    most, reason = max(_differences(mutant, measured), default=(0.0, unread))
    if passed and most <= 1.0 and not _allowed(survivor):  # at the ends there are only noise and times
        reason = f"{passed}; of what was read at the ends of its tests, nothing shows it: {_CHECK_THERE}"
    return Unsolved(mutant, reason)


def _on_the_way(survivor: MutantResult) -> str:
    """Return by what the readings of the probes on the way differed; empty if they do not."""
    lines = (line for outcome in survivor.survived for line in outcome.divergence)
    return next((line for line in lines if line.startswith(_WAY)), "")


def _allowed(survivor: MutantResult) -> str:
    """Return what a function returned that a check compared and let through; empty if there is none."""
    for outcome in survivor.survived:
        for line in outcome.divergence:
            function = _RETURNED.search(line)
            for check in (check for looked in outcome.looked if looked.acted for check in looked.checks):
                if function and check.spare is not None and re.search(rf"\b{function[1]}\(", check.text):
                    return f"{line}, which your check allows: {check.text}"
    return ""


def _why_failed(check: CheckProposal, why: str) -> str:
    statement = in_one_line(check.statement)
    if why.startswith("its test"):
        return "with a check of it, the test fails on the original with another seed"
    if why.startswith("fails in"):
        return f"what would notice it, the original itself breaks with another seed: {statement}"
    return f"a check that would notice it failed its proof ({why}): {statement}"


def _of_recordings(survivor: MutantResult, measured: Measured, suite: SuiteChecks) -> str:
    """Describe the difference in recordings of the world; empty without any recordings."""
    shown = (outcome.shown_difference for outcome in survivor.survived)
    stories = [difference for difference in shown if difference is not None and difference.apart]
    if not stories:
        return ""
    found = max(stories, key=lambda divergence: divergence.rank)
    own = [deviation for deviation in found.apart if not deviation.is_delay and deviation.deviation > 1.0]
    if found.story.startswith("the same movements") or not (own or found.story):
        return LATER
    turned = max(
        (deviation.aside or 0.0 for deviation in own if deviation.unit == "deg" and not deviation.is_value),
        default=0.0,
    )
    for unit, names in (("m", _LENGTHS), ("deg", _ANGLES)):
        apart = [deviation for deviation in own if deviation.unit == unit and not deviation.is_value]
        limit = _tolerance(measured, suite, names)
        ends = max((deviation.final for deviation in apart), default=0.0)
        way = max((deviation.aside or 0.0 for deviation in apart), default=0.0)
        if not apart or ends > limit or limit == 0.0:
            continue
        far, allowed = _amount(max(ends, way), unit), _amount(limit, unit)
        if way <= limit and turned < _TURNED:
            return f"{_SO_LITTLE} {far}, within your smallest tolerance of {allowed}"
        why = "no bound on the way distinguishes it from the original"
        if turned >= _TURNED:
            why = "no bound on the way distinguishes it from the original, which turns as well"
        elif unit == "m" and way < _NEAR:
            why = "on the way it is too near to the original for a bound"
        return f"{found.story}: {_END_ALLOWED} {allowed}; {why}"
    moved = [
        measurement.value or 0.0
        for measurement in found.measurements
        if measurement.name in _IN_GRIP and measurement.deviation > 1.0
    ]
    limit = _tolerance(measured, suite, _LENGTHS)
    if moved and max(moved) <= limit:
        return f"{found.story}: within your smallest tolerance of {_amount(limit, 'm')}"
    return f"{found.story}: nothing that its tests can read distinguishes it from the original"


def _tolerance(measured: Measured, suite: SuiteChecks, names: set[str]) -> float:
    """Return the least tolerance that the tests have for anything with one of these names; 0 without any."""
    sizes = [
        tolerance
        for reads in measured.originals.values()
        for read in reads.values()
        for check in suite.checks
        for number, _, _, tolerance in check.parts_in(read)
        if names & {last_name(name) for name in check.names(number)}
    ]
    return min(sizes, default=0.0)


def _differences(mutant: str, measured: Measured) -> Iterator[tuple[float, str]]:
    """Yield how far readings are from the original's, in units of its own spread."""
    for place, by_mutant in measured.mutants.items():
        originals = measured.originals.get(place, {})
        for key, read in by_mutant.get(mutant, {}).items():
            for text, value in read.items():
                before: Any = originals.get(key, {}).get(text)
                numbers = is_reading(text) and is_number(value) and is_number(before)
                if not numbers or value == before:
                    continue
                values = [original[text] for original in originals.values() if is_number(original.get(text))]
                tolerance = reading_of(measured, place, text).tolerance
                band, apart = band_of(values, tolerance), abs(value - before)
                # what differs by little more than runs of the original do is no difference for a check either
                own = f"the original itself spreads {_short(band.spread)}"
                if abs(value - band.middle) > band.tolerance:
                    own = "but no check of it holds in every run of the original and notices it"
                elif tolerance == band.tolerance:
                    own = f"its tolerance is {_short(tolerance)}"
                text_and_reason = f"{text} differs by {_short(apart)}, {own}"
                yield ((0.0, ONLY_TIME) if is_clock(text) else (apart / band.tolerance, text_and_reason))


def _short(value: float) -> str:
    return repr(float(f"{value:.3g}"))


def _amount(value: float, unit: str) -> str:
    """Return a value with its unit as text: ``1.4 mm``, ``0.31 m``, ``12 deg``."""
    return f"{1e3 * value:.2g} mm" if unit == "m" and value < 0.1 else f"{value:.2g} {unit}"
