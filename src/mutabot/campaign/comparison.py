"""Compare how a test ended as a mutant with how it ended as the original.

Orientations are compared by the angle between them, and single angles modulo a full turn. Probes are read
along the way of a test too, as often as they cost next to nothing. They are compared at the moments that
mutant and original have in common.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, NamedTuple

from mutabot.campaign.probe_readings import keys_of, quantities_meant, readings_of, step_text, value_of
from mutabot.evidence.calls import what_was_done
from mutabot.frozen import frozen
from mutabot.model import Compared, Kind, Operation, Pattern, Probe, Quantity
from mutabot.model.deviation import TOLERANCES, deviation_of
from mutabot.model.quantity import distinct_texts, is_number, value_text
from mutabot.model.units import apart

#: greatest difference of two equal numbers where the vocabulary names no probe
DEFAULT_TOLERANCE = 1e-6
#: multiples of its tolerance that a difference counts which is not one of numbers
OTHER_WORLD = 1e9
#: a difference of an end so far below the original's own spread is not listed beside one that exceeds it
_FAR_BELOW = 0.1
#: an operation and the notation of its command
CommandName = tuple[str, str | None]


def _angles_of(operations: Sequence[Operation]) -> dict[CommandName, dict[str, Quantity]]:
    """Return the orientations and angles among the values of each command, by name."""
    owners: list[tuple[CommandName, Operation | Pattern]] = [
        ((operation.target, None), operation) for operation in operations
    ]
    owners += [
        ((operation.target, pattern.text), pattern)
        for operation in operations
        for pattern in operation.patterns
    ]
    return {
        command: {
            argument.name: argument
            for argument in (*owner.arguments, *owner.result)
            if argument.is_whole or argument.full_turn is not None
        }
        for command, owner in owners
    }


def _values_distance(before: Any, after: Any, angles: Mapping[str, Quantity]) -> float:
    """Return the greatest distance of two sets of values by quantity."""
    if not angles or not isinstance(before, Mapping) or not isinstance(after, Mapping):
        return _distance(before, after)
    distances = []
    for name in {*before, *after}:
        pair = before.get(name), after.get(name)
        angle = _angle_between(angles.get(name), *pair)
        distances.append(_distance(*pair) if angle is None else angle)
    return max(distances, default=0.0)


#: a number smaller than this part of a difference is rounding
_ROUNDING = 1e-9
#: the module of an operation
_MODULE = re.compile(r"(?<= )[\w.]+:(?=[A-Za-z_])")
#: how a pattern formats a number
_FORMAT = re.compile(r":[^{}]*\}")
#: where a call's text begins and ends
_EXTENT = re.compile(r"(:\d+):\d+-\d+:\d+")
_NO_RETURNS: dict[str, Any] = {"prepared": None, "returned": None}
_NO_MOMENTS: dict[str, Any] = {"moments": None}


@frozen
class TraceCall:
    """One call in a trace, comparable between processes.

    Attributes:
        key: where and what, such as ``mission.py:12 Arm.move_by``.
        written: values it wrote, by quantity or in a fixed order.
        read: values it read, likewise.
        what: the operation and command.
    """

    key: str
    written: Any = None
    read: Any = None
    what: CommandName = ("", None)


@frozen
class Observation:
    """What was seen of one test: its calls in order, and the probes at its end.

    Attributes:
        events: the calls.
        probes: values by ``target.part``.
        truncated: whether the list of calls was cut off.
        unread: why a probe could not be read, by target.
        moments: probes along the way, as in ``TestEnd.moments``; None if they are not to be compared.
        outcome: how the test ended for the suite.
        prepared, returned: what the program returned to the test's fixtures and to the test itself, as in
            ``TestEnd.returned``; None if that is not to be compared.
    """

    events: Sequence[TraceCall] = ()
    probes: Mapping[str, Any] = field(default_factory=dict)
    truncated: bool = False
    unread: Mapping[str, str] = field(default_factory=dict)
    outcome: str = "passed"
    prepared: Sequence[Any] | None = ()
    returned: Sequence[Any] | None = ()
    moments: Sequence[Any] | None = ()

    @property
    def readings(self) -> _Readings:
        """The probes at the end of the test."""
        return _Readings(self.probes, self.unread)


@frozen
class Difference:
    """How far a mutant's test is from the original's. An outcome has the same fields.

    Attributes:
        indistinguishable: whether all that was compared is equal within the tolerance; None if that is not
            to be claimed.
        distance: greatest difference of a probe, in units of the original's spread (``OTHER_WORLD`` for one
            that is not of numbers); None without probes, or if none that differs more is all that is known.
        divergence: one line per difference: the outcome, probes whose ends differ by more than the original's
            spread, a difference along the way that does, other probes, the first call that differs.
        gaps: what could not be compared, one line each.
        way: greatest difference of a probe along the way, likewise; None if none was compared.
        compared: how much was; None if nothing was.
    """

    indistinguishable: bool | None
    distance: float | None
    divergence: tuple[str, ...]
    gaps: tuple[str, ...] = ()
    way: float | None = None
    compared: Compared | None = field(default=None, compare=False)

    @property
    def weight(self) -> tuple[float, float, float, bool]:
        """The sort key for reports: an end beyond the original's spread says more than the way there."""
        end, way = self.distance or 0.0, self.way or 0.0
        return end if end > 1.0 else 0.0, way, end, not self.indistinguishable


def compare(
    original: Observation,
    mutant: Observation,
    probes: Sequence[Probe] = (),
    operations: Sequence[Operation] = (),
    spread: ProbeSpread | None = None,
) -> Difference:
    """Compare a mutant's test with the original's.

    Numbers are equal when they differ by no more than their probe's tolerance; values in the trace, when
    they differ by no more than the greatest tolerance of any probe. Orientations are compared by the angle
    between them, angles modulo a full turn. All else is compared by equality.
    Two cut-off traces are compared as far as they go. What the program returned is compared by the finest of
    these tolerances if it is a fraction, and exactly if not.
    ``spread``: how far runs of the original with different seeds are apart; None if that is not known.
    """
    spread = spread or ProbeSpread()
    found = list(_probe_differences(original.readings, mutant.readings, probes))
    found.sort(key=lambda difference: difference.rank(spread.ends))
    gaps = tuple(
        f"{_short(target)} cannot be read: {mutant.unread[target]}"
        for target in original.unread
        if target in mutant.unread
    )
    if probes and not (original.probes or mutant.probes or original.unread or mutant.unread):
        gaps = ("no probe reads anything",)
    tolerance = max((probe.tolerance for probe in probes), default=DEFAULT_TOLERANCE)
    trace_line = _first_difference(original, mutant, tolerance, _angles_of(operations))
    returned_line = _returned_difference(original, mutant, probes)
    distances = [difference.deviation(spread.ends) for difference in found]
    different = [difference for difference in found if difference.distance > 1.0]
    beyond = [difference.text for difference in different if difference.deviation(spread.ends) > 1.0]
    way, way_line, moments = _on_the_way(original, mutant, probes, spread)
    # beside one that matters, what is far below the original's own spread is left out
    least = _FAR_BELOW if beyond or (way or 0.0) > 1.0 else -1.0
    within = [
        difference.text
        for difference in different
        if difference.is_clock or least < difference.deviation(spread.ends) <= 1.0
    ]
    is_same_end = original.outcome == mutant.outcome
    end_line = "" if is_same_end else f"the test ended {mutant.outcome} instead of {original.outcome}"
    probe_lines = (*beyond, way_line, *within) if (way or 0.0) > 1.0 else (*beyond, *within, way_line)
    lines = [line for line in (end_line, *probe_lines, returned_line, trace_line) if line]
    distance = max(distances, default=None)
    if gaps and not different:  # what cannot be read may be anywhere
        distance = None
    compared = _compared(original, mutant, moments)
    return Difference(not lines, distance, tuple(lines), gaps, way, compared)


def _on_the_way(
    original: Observation, mutant: Observation, probes: Sequence[Probe], spread: ProbeSpread
) -> tuple[float | None, str, int]:
    """Compare readings after the same calls, up to the first call that differs.

    Returns the greatest deviation (None if there is nothing to compare), a description of the greatest
    difference, empty if it is within the tolerance, and how many moments were compared.
    """
    common = _common_moments(original, mutant)
    found = [
        (difference, call)
        for call, before, after in common
        if before != after
        for difference in _probe_differences(_Readings(before), _Readings(after), probes)
    ]
    worst = max((difference.deviation(spread.ways) for difference, _ in found), default=0.0)
    farthest_pair = min(
        (pair for pair in found if pair[0].distance > 1.0),
        key=lambda pair: pair[0].rank(spread.ways),
        default=None,
    )
    line = ""
    if farthest_pair is not None:
        place = _place_text(mutant.events[farthest_pair[1] - 1].key)
        line = f"on the way, after call {farthest_pair[1]}, {place}: {farthest_pair[0].text}"
    return worst if common else None, line, len(common)


def _common_moments(
    first: Observation, second: Observation
) -> list[tuple[int, dict[str, Any], dict[str, Any]]]:
    """Return the calls after which both runs were read, while they made the same calls, and the readings."""
    before, after = _readings(first.moments or ()), _readings(second.moments or ())
    same = _same_calls(first, second)
    return [
        (call, before[call], after[call])
        for call in before
        if before[call] and call in after and call <= same
    ]


@frozen
class ProbeSpread:
    """How far probes are apart in runs of one test of the original with different seeds.

    Attributes:
        ends: by what is compared, at the ends.
        ways: along the way, after the same calls.
    """

    ends: Mapping[str, float] = field(default_factory=dict)
    ways: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def between(
        cls, first: Observation, others: Iterable[Observation], probes: Sequence[Probe]
    ) -> ProbeSpread:
        """Return how far the other runs are from the first.

        A seed may decide what there is to do, such as where a box belongs: only runs in which the same was
        done are compared, if there are any.
        """
        others, done = [*others], _done(first)
        others = [other for other in others if _done(other) == done] or others
        ends: dict[str, float] = {}
        ways: dict[str, float] = {}
        for other in others:
            pairs = [(ways, before, after) for _, before, after in _common_moments(first, other)]
            for sizes, before, after in [(ends, first.probes, other.probes), *pairs]:
                for difference in _probe_differences(_Readings(before), _Readings(after), probes):
                    if math.isfinite(difference.size):
                        sizes[difference.key] = max(difference.size, sizes.get(difference.key, 0.0))
        return cls(ends, ways)


def _done(run: Observation) -> frozenset[Any]:
    return what_was_done((call.key, call.read) for call in run.events)


def _same_calls(original: Observation, mutant: Observation) -> int:
    """Return the number of calls at the beginning that are the same."""
    pairs = zip(original.events, mutant.events, strict=False)
    shorter = min(len(original.events), len(mutant.events))
    return next((number for number, (call, other) in enumerate(pairs) if call.key != other.key), shorter)


def _readings(moments: Sequence[Any]) -> dict[int, dict[str, Any]]:
    """Return all readings by moment; a trace that is cut off repeats its last moment."""
    found: dict[int, dict[str, Any]] = {}
    last: dict[str, Any] = {}
    for call, parts, is_whole in moments:
        last = dict(parts) if is_whole else {**last, **parts}
        found.setdefault(call, last)
    return found


def as_steady(
    first: Observation,
    second: Observation,
    probes: Sequence[Probe],
    operations: Sequence[Operation] = (),
) -> Observation | None:
    """Return the observation that mutants are compared with: what two runs of the original have in common.

    Without what the program returned, or probes along the way, if only that differs; None if more does.
    """
    for dropped in ({}, _NO_RETURNS, _NO_MOMENTS, {**_NO_RETURNS, **_NO_MOMENTS}):
        observation = replace(first, **dropped)
        if compare(observation, second, probes, operations).indistinguishable:
            return (
                observation
                if observation.moments is None or observation.moments
                else replace(observation, moments=second.moments)
            )
    return None


def farthest(comparisons: Sequence[Difference]) -> Difference:
    """Merge the comparisons of several tests of one mutant: the largest differences; equal if all are."""
    if not comparisons:
        return Difference(True, None, ())
    ranked = sorted(comparisons, key=lambda difference: difference.weight, reverse=True)
    distances = [comparison.distance for comparison in comparisons if comparison.distance is not None]
    lines = dict.fromkeys(line for difference in ranked for line in difference.divergence)
    together = all(comparison.indistinguishable for comparison in comparisons)
    gaps = tuple(dict.fromkeys(gap for comparison in comparisons for gap in comparison.gaps))
    distance = max(distances, default=None)
    if gaps and (distance or 0.0) <= 1.0:
        distance = None
    compared = Compared.together(
        comparison.compared for comparison in comparisons if comparison.compared is not None
    )
    way = max((comparison.way for comparison in comparisons if comparison.way is not None), default=None)
    return Difference(together, distance, tuple(lines), gaps, way, compared)


def _first_difference(
    original: Observation,
    mutant: Observation,
    tolerance: float,
    angles: Mapping[CommandName, Mapping[str, Quantity]],
) -> str | None:
    for index, (before, after) in enumerate(zip(original.events, mutant.events, strict=False), start=1):
        if before.key != after.key:
            return f"call {index}: {_place_text(after.key)} instead of {_place_text(before.key)}"
        known = angles.get(before.what, {})
        for verb, was, is_now in (
            ("wrote", before.written, after.written),
            ("read", before.read, after.read),
        ):
            if _values_distance(was, is_now, known) > tolerance:
                change = _change_of_values(was, is_now, known, tolerance)
                return f"call {index}, {_place_text(after.key)}: {verb} {change}"
    more = len(mutant.events) - len(original.events)
    if more == 0 or original.truncated or mutant.truncated:
        return None
    return f"{abs(more)} {'calls' if abs(more) > 1 else 'call'} {'more' if more > 0 else 'fewer'}"


def _compared(original: Observation, mutant: Observation, moments: int) -> Compared:
    returned = 0
    for before, after in ((original.prepared, mutant.prepared), (original.returned, mutant.returned)):
        if before is not None and after is not None:
            returned += sum("opaque" not in str(entry[1]) for entry in before[: len(after)])
    return Compared(
        calls=min(len(original.events), len(mutant.events)),
        moments=moments + bool(original.probes and mutant.probes),
        returned=returned,
    )


def _returned_difference(original: Observation, mutant: Observation, probes: Sequence[Probe]) -> str | None:
    """Return the first difference in the values that the program returned; None if there is none.

    A fixture that tests share is set up in one of them, in another one if others are run before: the last of
    what was returned to fixtures is from those that the test has alone.
    """
    tolerance = min((probe.tolerance for probe in probes), default=DEFAULT_TOLERANCE)
    first, second = original.prepared, mutant.prepared
    common = min(len(first), len(second)) if first is not None and second is not None else 0
    pairs = [*zip(first[-common:], second[-common:], strict=True)] if first and second and common else []
    before, after = original.returned, mutant.returned
    if before is not None and after is not None:
        pairs += zip(before, after, strict=False)
    for was, is_now in pairs:
        # most are the same, and their texts are compared in a tenth of the time
        if repr(was) != repr(is_now) and not _is_same(was, is_now, tolerance):
            return _returned_text(was, is_now, tolerance)
    if before is None or after is None or len(before) == len(after):
        return None
    if len(after) > len(before):
        return f"{_event_text(*after[len(before)])} only with the mutant"
    return f"{_event_text(*before[len(after)])} only in the original"


def _returned_text(before: Any, after: Any, tolerance: float) -> str:
    (name, was), (other, is_now) = before, after
    if name != other:
        return f"{other} returned to the test instead of {name}"
    if isinstance(is_now, Mapping):
        return _event_text(name, is_now)
    if isinstance(was, Mapping):
        return f"{name} returned {value_text(is_now[0])} instead of raising {was['raised']}"
    if any(isinstance(value, Mapping) and "digest" in value for value in (*was, *is_now)):
        return f"{name} returned something else"
    path, first, other = _first_part(was[0], is_now[0], tolerance)
    return f"{name} returned {f'{path} ' if path else ''}{_change(first, other)}"


def _event_text(name: str, value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{name} raised {value['raised']}"
    return f"{name} returned {value_text(value[0])}"


def _place_text(key: str) -> str:
    """Return a call's place without columns, module and formats of its command: ``a.py:8 Arm.move_by``."""
    return _FORMAT.sub("}", _MODULE.sub("", _EXTENT.sub(r"\1", key), count=1))


class _ProbeDifference(NamedTuple):
    """How far one part of a probe is from the original's.

    Attributes:
        key: which part.
        size: the difference, in the unit of the part; infinite if it is not one of numbers.
        tolerance: difference up to which it counts as the same.
        unit: of the part, if the vocabulary says it.
        is_clock: whether it is a time, which is no distance.
        text: description of the difference.
    """

    key: str
    size: float
    tolerance: float
    unit: str | None
    is_clock: bool
    text: str

    @property
    def distance(self) -> float:
        """The difference in multiples of the tolerance."""
        return min(self.size / self.tolerance, OTHER_WORLD)

    def deviation(self, spread: Mapping[str, float]) -> float:
        """Return the difference in units of the original's spread; None for clocks, which only show delay."""
        if self.is_clock:
            return 0.0
        tolerance = max(self.tolerance, TOLERANCES.get(self.unit or "", 0.0))
        return min(deviation_of(self.size, spread.get(self.key, 0.0), tolerance), OTHER_WORLD)

    def rank(self, spread: Mapping[str, float]) -> tuple[float, bool, float, float]:
        """Return the sort key of a difference; the lowest is the largest deviation.

        A delay goes before what differs by no more than the original's spread.
        """
        deviation, is_late = self.deviation(spread), self.is_clock and self.size > TOLERANCES["s"]
        return -deviation if deviation > 1.0 else 0.0, not is_late, -deviation, -self.distance


def _probe_differences(
    original: _Readings, mutant: _Readings, probes: Sequence[Probe]
) -> Iterator[_ProbeDifference]:
    """Yield how far each part of the probes is from the original's, equal ones included."""
    unread = original.unread.keys() | mutant.unread.keys()
    for target in sorted(original.unread.keys() ^ mutant.unread.keys()):
        text = f"{_short(target)}: {_readable(original, mutant, target)}"
        yield _ProbeDifference(target, math.inf, 1.0, None, is_clock=False, text=text)
    done: set[str] = set()
    for name, quantity in _parts(original.values, probes):
        keys = keys_of(name, quantity, original.values)
        if not keys or not all(key in original.values and key in mutant.values for key in keys):
            continue
        before, after = (value_of(quantity, keys, values) for values in (original.values, mutant.values))
        found = _of_quantity(name, quantity, before, after, _tolerance(keys[0], probes))
        if found is not None:
            done.update(keys)
            yield found
    for key in dict.fromkeys([*original.values, *mutant.values]):
        if key in done or any(key == target or _lies_below(key, target) for target in unread):
            continue
        before, after = original.values.get(key), mutant.values.get(key)
        text = f"{_short(key)}: {_change(before, after)}"
        size = _distance(before, after)
        yield _ProbeDifference(key, size, _tolerance(key, probes), None, is_clock=False, text=text)


def _of_quantity(
    name: str, quantity: Quantity, before: Any, after: Any, tolerance: float
) -> _ProbeDifference | None:
    """Return the difference of a part whose meaning is known; None if it is compared like any other value."""
    part = f"{name}{quantity.path}"
    short = _short(f"{name}{''.join(map(step_text, quantity.path.steps))}")
    if quantity.kind is Kind.STAMP and is_number(before) and is_number(after):
        late = f"{value_text(abs(after - before), 3)} s {'later' if after > before else 'earlier'}"
        times = [value_text(moment) for moment in (after, before)]
        text = f"the clock {short}: {times[0]} s instead of {times[1]} s ({late})"
        return _ProbeDifference(part, abs(after - before), tolerance, "s", is_clock=True, text=text)
    angle = _angle_between(quantity, before, after)
    unit = quantity.unit or ("rad" if angle is not None else None)
    if angle is not None:
        shown = " instead of ".join(distinct_texts(after, before, value_text, 4))
        text = f"{short}: {shown} (turned by {angle:.3g} {unit})"
        return _ProbeDifference(part, angle, tolerance, unit, is_clock=False, text=text)
    if not (is_number(before) and is_number(after)):
        return None
    text = f"{short}: {_change(before, after)}"
    return _ProbeDifference(part, _distance(before, after), tolerance, unit, is_clock=False, text=text)


def _parts(values: Mapping[str, Any], probes: Sequence[Probe]) -> Iterator[tuple[str, Quantity]]:
    """Yield the quantities of the readings among some values, with the names of the readings."""
    for probe in probes:
        for name in readings_of(probe, values) if probe.result else ():
            for quantity in probe.result:
                yield from ((name, part) for part in quantities_meant(name, quantity, values))


def _readable(original: _Readings, mutant: _Readings, target: str) -> str:
    """Describe how a probe differs that only one of both runs can read."""
    if target in mutant.unread:
        return f"cannot be read, as it could be in the original: {mutant.unread[target]}"
    return f"can be read, as it could not be in the original: {original.unread[target]}"


def _tolerance(key: str, probes: Sequence[Probe]) -> float:
    fitting = [probe for probe in probes if key == probe.target or _lies_below(key, probe.target)]
    if not fitting:
        return DEFAULT_TOLERANCE
    # A tolerance of nothing is meant as "exactly equal".
    return max(max(fitting, key=lambda probe: len(probe.target)).tolerance, 1e-300)


def _lies_below(key: str, target: str) -> bool:
    return key.startswith(target) and key[len(target)] in ".[#"


def _short(key: str) -> str:
    """Return a target without its module."""
    return key.partition(":")[2]


@frozen
class _Readings:
    """Readings of probes at one moment.

    Attributes:
        values: by ``target.part``.
        unread: why a probe could not be read, by target.
    """

    values: Mapping[str, Any] = field(default_factory=dict)
    unread: Mapping[str, str] = field(default_factory=dict)


def _angle_between(quantity: Quantity | None, before: Any, after: Any) -> float | None:
    """Return the distance of two orientations or angles; None for other quantities."""
    if quantity is not None and quantity.is_whole:
        first, second = quantity.orientation(before), quantity.orientation(after)
        return quantity.from_unit(first.distance(second), "rad") if first and second else None
    turn = quantity.full_turn if quantity is not None else None
    if turn is None or not (is_number(before) and is_number(after)):
        return None
    return apart(before, after, turn)


def _distance(before: Any, after: Any) -> float:
    """Return the absolute difference of two numbers, or the greatest in two lists; inf if there is none."""
    if is_number(before) and is_number(after):
        if before == after or (math.isnan(before) and math.isnan(after)):
            return 0.0
        difference = abs(float(before) - float(after))
        return math.inf if math.isnan(difference) else difference
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        keys = {*before, *after}
        return max((_distance(before.get(key), after.get(key)) for key in keys), default=0.0)
    if isinstance(before, list | tuple) and isinstance(after, list | tuple) and len(before) == len(after):
        return max((_distance(*pair) for pair in zip(before, after, strict=True)), default=0.0)
    return 0.0 if before == after else math.inf


def _is_same(before: Any, after: Any, tolerance: float) -> bool:
    """Return whether two values are equal, fractions within the tolerance."""
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        same_keys = before.keys() == after.keys()
        return same_keys and all(_is_same(before[key], after[key], tolerance) for key in before)
    if isinstance(before, list | tuple) and isinstance(after, list | tuple):
        return len(before) == len(after) and all(
            _is_same(*pair, tolerance) for pair in zip(before, after, strict=True)
        )
    if is_number(before) and is_number(after) and isinstance(before + after, float):
        return _distance(before, after) <= tolerance
    return type(before) is type(after) and bool(before == after)


def _first_part(before: Any, after: Any, tolerance: float) -> tuple[str, Any, Any]:
    """Return the path of the first part in which two values differ, and the part's value in each."""
    if isinstance(before, Mapping) and isinstance(after, Mapping) and before.keys() == after.keys():
        pairs = [(f"[{key!r}]", before[key], after[key]) for key in before]
    elif isinstance(before, list | tuple) and isinstance(after, list | tuple) and len(before) == len(after):
        pairs = [(f"[{index}]", *pair) for index, pair in enumerate(zip(before, after, strict=True))]
    else:
        return "", before, after
    for step, first_part, second_part in pairs:
        if not _is_same(first_part, second_part, tolerance):
            path, first, second = _first_part(first_part, second_part, tolerance)
            return f"{step}{path}", first, second
    return "", before, after


def _change_of_values(before: Any, after: Any, angles: Mapping[str, Quantity], tolerance: float) -> str:
    """Return ``after instead of before`` for those quantities of a call that differ."""
    if not isinstance(before, Mapping) or not isinstance(after, Mapping):
        return _change(before, after)
    parts = []
    for name in dict.fromkeys((*after, *before)):
        pair = before.get(name), after.get(name)
        if _values_distance({name: pair[0]}, {name: pair[1]}, angles) > tolerance:
            parts.append(f"{name} {_change(*pair, quantity=angles.get(name))}")
    return ", ".join(parts)


def _without_noise(first: Any, second: Any) -> tuple[Any, Any]:
    """Return values; 0 for a number that is but rounding beside the difference of both."""
    if not (is_number(first) and is_number(second)):
        return first, second
    least = abs(_ROUNDING * first - _ROUNDING * second)  # beside an infinite number, none is rounding
    return (0 if abs(first) < least < math.inf else first), (0 if abs(second) < least < math.inf else second)


def _change(before: Any, after: Any, quantity: Quantity | None = None) -> str:
    """Return ``after instead of before``, with the difference of numbers, angles and orientations."""
    text = " instead of ".join(distinct_texts(*_without_noise(after, before), value_text, 4))
    angle = _angle_between(quantity, before, after)
    if angle is not None and quantity is not None:
        return f"{text} (turned by {value_text(angle, 3)} {quantity.unit or 'rad'})"
    if is_number(before) and is_number(after):
        return f"{text} (off by {value_text(abs(float(after) - float(before)), 3)})"
    return text
