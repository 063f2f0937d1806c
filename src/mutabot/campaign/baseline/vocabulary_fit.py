"""Find entries of a vocabulary that do not fit the original: unreadable probes, values out of range.

Without readings of probes comparisons would say nothing.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from mutabot.campaign.baseline.remarks import lines_of
from mutabot.campaign.probe_readings import is_pattern, parts_of, readings_of
from mutabot.config.mistakes import problem_error
from mutabot.errors import plural
from mutabot.extensions import brought
from mutabot.model.events import Problem, Remark, TestEnd
from mutabot.model.quantity import holds_number, is_number, value_text
from mutabot.operators.kinds.readings import DEFAULT_DEVIATION

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.request import Progress
    from mutabot.model import Clock, Operation, Pattern, Probe, Quantity, Vocabulary

#: reasons why tests cannot read a probe that are said
_REASONS = 3
_NO_MIDDLEWARE = (
    "it is a name on a middleware, but no installed package brings one, so that nothing would be seen of it; "
    "that of ROS is mutabot_ros, which comes with mutabot: install it whole"
)
_NEEDED = {
    "rotation_vector": "three numbers",
    "euler": "three angles",
    "quaternion": "four numbers, not all zero",
}
_NOISY = "positions, distances, angles and orientations"
#: where an object lies, which differs between equal runs
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")
#: why a probe says nothing that was read without an error
_NOTHING = "it reads nothing (None); a probe returns what it reads"


def refuse_unhooked(vocabulary: Vocabulary) -> None:
    """Refuse names on a middleware if no installed package knows its names.

    Raises ConfigurationError that says where the first of them stands, and what is needed.
    """
    named = next((operation for operation in vocabulary.operations if operation.named is not None), None)
    if named is not None and not brought("middlewares"):
        raise problem_error(Problem(named.source, "", _NO_MIDDLEWARE))


def refuse_unfit(baseline: Baseline, vocabulary: Vocabulary) -> None:
    """Refuse a probe that no test can read, and an orientation or angle that no recorded value is.

    Raises ConfigurationError that names the key, the value or the reason, and what is needed.
    """
    for problem in (
        *_unreadable(baseline, vocabulary),
        *_of_operations(baseline, vocabulary),
        *_of_probes(baseline, vocabulary),
    ):
        raise problem_error(problem)


def note_fit(
    baseline: Baseline, vocabulary: Vocabulary, progress: Progress, shared: Iterable[Remark] = ()
) -> None:
    """Note probes that some tests cannot read, a clock that never ticks, and values out of range.

    ``shared``: of sites that are one for several calls.
    """
    ends = _with_calls(baseline)
    for probe in vocabulary.probes:
        blind = {end.test: why for end in ends if (why := _why_not(probe, end)) is not None}
        if blind:
            test, why = next(iter(blind.items()))
            count = len({end.test for end in ends})
            progress.note(
                f"{probe.target} cannot be read in {len(blind)} of {count} tests, such as {test} ({why}): "
                "survivors there cannot be classified as indistinguishable"
            )
    if vocabulary.clock is not None and ends and all(end.simulated is None for end in ends):
        progress.note(never_ticks_text(vocabulary.clock))
    remarks = (
        *_out_of_range(baseline, vocabulary),
        *_no_numbers(baseline, vocabulary),
        *useless_noise(vocabulary),
        *shared,
    )
    baseline.add_remarks(remarks)
    for line in lines_of(remarks):
        progress.note(line)


def never_ticks_text(clock: Clock) -> str:
    """Return the note on a clock that no test calls."""
    return f"clock: no test calls {clock.tick}, so there is no simulated time"


def _with_calls(baseline: Baseline) -> list[TestEnd]:
    """Return the tests that call operations; all tests if none does."""
    ends = list(baseline.ends.values())
    return [end for end in ends if end.trace] or [end for end in ends if end.outcome != "skipped"]


def _why_not(probe: Probe, end: TestEnd) -> str | None:
    """Return why a probe could not be read at the end of a test; None if it could."""
    return end.unread.get(probe.target) or (None if readings_of(probe, end.probes) else _NOTHING)


def _unreadable(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Problem]:
    for probe in vocabulary.probes:
        reasons = [_why_not(probe, end) for end in _with_calls(baseline)]
        if reasons and all(reasons):
            counts = Counter(filter(None, reasons)).most_common(_REASONS)
            where = [f" ({plural(count, 'test')})" if len(counts) > 1 else "" for _, count in counts]
            why = "; ".join(f"{reason}{there}" for (reason, _), there in zip(counts, where, strict=True))
            text = f"{probe.target} cannot be read at the end of any test: {why}"
            yield Problem(probe.source, "call", text)


def _of_operations(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Problem]:
    for owner, side, quantity, values in _recorded(baseline, vocabulary):
        wrong = _wrong(quantity, values)
        if wrong is not None:
            yield Problem(owner.source, f"{side}.{quantity.name}", wrong)


def _of_probes(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Problem]:
    readings = [end.probes for end in baseline.ends.values()]
    for probe in vocabulary.probes:
        known = [(values, names) for values in readings if (names := readings_of(probe, values))]
        for quantity in probe.result if known else ():
            values = [
                value
                for values, names in known
                for name in names
                for value in parts_of(name, quantity, values)
            ]
            if not values and (is_pattern(quantity) or _is_of_operation(quantity, probe, vocabulary)):
                continue
            wrong = _wrong(quantity, values) if values else "the probe never reads such a part"
            if wrong is not None:
                yield Problem(probe.source, f"result.{quantity.name}", wrong)


def _is_of_operation(quantity: Quantity, probe: Probe, vocabulary: Vocabulary) -> bool:
    """Return whether a part of a probe is known only from the operation of the same callable."""
    operation = vocabulary.operation(probe.target)
    return operation is not None and quantity in operation.result


def _wrong(quantity: Quantity, values: Iterable[Any]) -> str | None:
    """Return why recorded values cannot be orientations or angles; None if at least one can."""
    seen = [value for value in values if value is not None]
    if not quantity.is_whole or not seen or any(quantity.orientation(value) is not None for value in seen):
        return None
    return f"{quantity.kind} needs {_NEEDED[quantity.kind]}, and the value is {value_text(seen[0])}"


def _out_of_range(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Remark]:
    for owner, side, quantity, values in _recorded(baseline, vocabulary):
        if quantity.range is None:
            continue
        each = (value if isinstance(value, list | tuple) else [value] for value in values)
        numbers = [found for items in each if (found := [*filter(is_number, items)])]
        outside = [[number for number in some if not quantity.allows(number)] for some in numbers]
        examples = [some[0] for some in outside if some]
        limits = "[{:g}, {:g}]".format(*quantity.range)
        remedy = f"clip = {limits} if the robot limits what it is sent, else a wider range"
        if examples:
            yield Remark(
                owner.source,
                f"{side}.{quantity.name}",
                f"{len(examples)} of {len(numbers)} recorded values are outside range = {limits}, such as "
                f"{quantity.text(examples[0])}, and mutants stay away from what is outside; "
                f"give it {remedy if side == 'arguments' else 'a wider range'}",
            )


def _no_numbers(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Remark]:
    """Remark on quantities whose recorded values are objects instead of numbers."""
    for owner, side, quantity, values in _recorded(baseline, vocabulary):
        seen = [value for value in values if value is not None]
        if quantity.is_numeric and seen and not any(map(holds_number, seen)):
            path = f'{side}."{quantity.name}.{quantity.axis or "x"}"'
            text = (
                f"its value is not a number, such as {_ADDRESS.sub('', value_text(seen[0]))}, so that no "
                f"{quantity.kind} is mutated; name a number in it by its path, such as {path}"
            )
            yield Remark(owner.source, f"{side}.{quantity.name}", text)


def useless_noise(vocabulary: Vocabulary) -> Iterator[Remark]:
    """Remark on noise that is described of quantities to which no operator adds noise."""
    for operation in vocabulary.operations:
        for pattern in (None, *operation.patterns):
            owner = pattern or operation
            for quantity in owner.result:
                if quantity.noise is not None and quantity.kind not in DEFAULT_DEVIATION:
                    text = f"noise is added to {_NOISY}, and to no {quantity.kind}: leave it out"
                    key = "result" if quantity.name == "result" else f"result.{quantity.name}"
                    yield Remark(owner.source, f"{key}.noise", text)


def _recorded(
    baseline: Baseline, vocabulary: Vocabulary
) -> Iterator[tuple[Operation | Pattern, str, Quantity, list[Any]]]:
    """Yield the recorded values of each quantity of an operation or pattern, and their side of the call."""
    for operation in vocabulary.operations:
        for pattern in (None, *operation.patterns):
            owner, text = pattern or operation, pattern.text if pattern is not None else None
            found = [
                {**hit.read, **hit.written}
                for place, hits in baseline.hits.items()
                if (place.operation, place.pattern) == (operation.target, text)
                for hit in hits
            ]
            for side, quantities in (("arguments", owner.arguments), ("result", owner.result)):
                for quantity in quantities if found else ():
                    yield owner, side, quantity, [values.get(quantity.name) for values in found]
