"""Whether a speed or ratio has a direction, by the values that the baseline recorded of it."""

from __future__ import annotations

from typing import Any

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.model.mutant import Place
from mutabot.model.values.quantity import is_number
from mutabot.operators import Subject

#: why a speed or ratio is not reversed
NO_SIGN = (
    "no negative value was recorded, so it may be a mere magnitude; if it has a direction, give it an axis, "
    "or a range or clip that goes below 0"
)


def has_negative(baseline: Baseline, place: Place, subject: Subject) -> bool:
    """Whether any call of the same command has a negative value of the subject's quantity."""
    name = subject.quantity.name if subject.quantity is not None else ""
    return any(
        number < 0
        for other, hits in baseline.hits.items()
        if (other.operation, other.pattern) == (place.operation, place.pattern)
        for hit in hits
        for number in _numbers({**hit.read, **hit.written}.get(name))
    )


def _numbers(value: Any) -> list[float]:
    items = value if isinstance(value, list | tuple) else [value]
    return [item for item in items if is_number(item)]
