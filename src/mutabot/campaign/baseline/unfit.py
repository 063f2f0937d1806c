"""What a vocabulary has and the original does not: mistakes that nothing else would tell."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from mutabot.border.events import Problem
from mutabot.campaign.comparing.orientations import parts_of, readings_of
from mutabot.extensions import brought
from mutabot.model import Quantity, Vocabulary
from mutabot.model.values.quantity import value_text
from mutabot.vocabulary import problem_error

from .baseline import Baseline

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
