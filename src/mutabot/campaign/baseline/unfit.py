"""What a vocabulary has and the original does not: mistakes that nothing else tells, values out of range."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.comparison import parts_of, readings_of
from mutabot.campaign.request import Progress
from mutabot.config.vocabulary import problem_error
from mutabot.extensions import brought
from mutabot.model import Operation, Pattern, Quantity, Vocabulary
from mutabot.model.events import Problem, Remark
from mutabot.model.quantity import is_number, value_text


@dataclass(slots=True)
class _Count:
    """How often a quantity had a value, how often one outside its range, and the first of these."""

    values: int = 0
    outside: int = 0
    example: float | None = None

    def add(self, quantity: Quantity, value: Any) -> None:
        numbers = [item for item in _items(value) if is_number(item)]
        beyond = [number for number in numbers if not quantity.allows(number)]
        self.values += bool(numbers)
        self.outside += bool(beyond)
        if self.example is None and beyond:
            self.example = beyond[0]


def note_ranges(baseline: Baseline, vocabulary: Vocabulary, progress: Progress) -> None:
    """Tell once about each quantity whose recorded values leave its own range."""
    remarks = tuple(_out_of_range(baseline, vocabulary))
    baseline.remarks = (*baseline.remarks, *remarks)
    for remark in remarks:
        progress.note(str(remark))


def _out_of_range(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Remark]:
    for operation in vocabulary.operations:
        for pattern in operation.patterns or (None,):
            owner = pattern if pattern is not None else operation
            for quantity in (*owner.arguments, *owner.result):
                count = _Count()
                if quantity.range is not None:
                    _count(count, baseline, operation, pattern, quantity)
                if count.outside:
                    yield _remark(owner, quantity, count)


def _count(
    count: _Count, baseline: Baseline, operation: Operation, pattern: Pattern | None, quantity: Quantity
) -> None:
    text = pattern.text if pattern is not None else None
    for place, hits in baseline.hits.items():
        if (place.operation, place.pattern) == (operation.target, text):
            for hit in hits:
                count.add(quantity, {**hit.read, **hit.written}.get(quantity.name))


def _remark(owner: Operation | Pattern, quantity: Quantity, count: _Count) -> Remark:
    is_written = quantity in owner.arguments
    limits = "[{:g}, {:g}]".format(*quantity.range or ())
    remedy = f"clip = {limits} if the robot limits what it is sent, else a wider range"
    return Remark(
        owner.source,
        f"{'arguments' if is_written else 'result'}.{quantity.name}",
        f"{count.outside} of {count.values} recorded values are outside range = {limits}, such as "
        f"{quantity.text(count.example)}, and mutants stay away from what is outside; "
        f"give it {remedy if is_written else 'a wider range'}",
    )


def _items(value: Any) -> Sequence[Any]:
    return value if isinstance(value, list | tuple) else [value]


_NO_MIDDLEWARE = (
    "it is a name on a middleware, but no installed package brings one, so that nothing would be seen of it; "
    "that of ROS is mutabot_ros, which comes with mutabot: install it whole"
)
_NEEDED = {
    "rotation_vector": "three numbers",
    "euler": "three angles",
    "quaternion": "four numbers, not all zero",
}


def refuse_unhooked(vocabulary: Vocabulary) -> None:
    """Refuse names on a middleware where nothing is installed that knows any.

    Raises ConfigurationError that says where the first of them stands, and what is needed.
    """
    named = next((one for one in vocabulary.operations if one.named is not None), None)
    if named is not None and not brought("middlewares"):
        raise problem_error(Problem(named.source, "", _NO_MIDDLEWARE))


def refuse_unfit(baseline: Baseline, vocabulary: Vocabulary) -> None:
    """Refuse an orientation, or an angle of a probe, that no recorded value is.

    Raises ConfigurationError that names the key, the value and what is needed.
    """
    for problem in (*_of_operations(baseline, vocabulary), *_of_probes(baseline, vocabulary)):
        raise problem_error(problem)


def _of_operations(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Problem]:
    for place, hits in baseline.hits.items():
        operation = vocabulary.operation(place.operation)
        if operation is None:
            continue
        owner = operation.pattern(place.pattern) or operation
        for side, quantities in (("arguments", owner.arguments), ("result", owner.result)):
            for quantity in quantities:
                values = ({**hit.read, **hit.written}.get(quantity.name) for hit in hits)
                wrong = _wrong(quantity, values)
                if wrong is not None:
                    yield Problem(owner.source, f"{side}.{quantity.name}", wrong)


def _of_probes(baseline: Baseline, vocabulary: Vocabulary) -> Iterator[Problem]:
    readings = [end.probes for end in baseline.ends.values()]
    for probe in vocabulary.probes:
        known = [(one, names) for one in readings if (names := readings_of(probe, one))]
        for quantity in probe.result if known else ():
            values = [
                value for one, names in known for name in names for value in parts_of(name, quantity, one)
            ]
            wrong = _wrong(quantity, values)
            if not values:
                wrong = "the probe never reads such a part"
            if wrong is not None:
                yield Problem(probe.source, f"result.{quantity.name}", wrong)


def _wrong(quantity: Quantity, values: Iterable[Any]) -> str | None:
    """What is wrong if values were recorded of which none is an orientation."""
    seen = [value for value in values if value is not None]
    if not quantity.is_whole or not seen or any(quantity.orientation(value) is not None for value in seen):
        return None
    return f"{quantity.kind} needs {_NEEDED[quantity.kind]}, and the value is {value_text(seen[0])}"
