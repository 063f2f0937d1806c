"""The JSON of a shields.io endpoint badge. Families and roles stand beside each other, as in every report."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.analysis.score import Group
from mutabot.report.as_json import dumps
from mutabot.report.format import Format, Material

#: from which score on, in percent, a badge has a colour; the lowest score decides
_COLOURS = (
    (90, "brightgreen"),
    (80, "green"),
    (70, "yellowgreen"),
    (60, "yellow"),
    (50, "orange"),
    (0, "red"),
)
#: of a badge that says nothing about the tests
_GREY = "lightgrey"


def make(material: Material) -> str:
    """The report."""
    scored = [group for group in material.campaign.scores if group.scores.mean is not None]
    message = ", ".join(_text(group, scored) for group in scored) or "unknown"
    if not material.campaign.is_complete:
        message += " (not complete)"
    is_known = bool(scored) and material.campaign.is_complete
    return dumps(
        {
            "schemaVersion": 1,
            "label": "mutation score",
            "message": message,
            "color": _colour(scored) if is_known else _GREY,
        }
    )


def _text(group: Group, scored: Sequence[Group]) -> str:
    """``program 83 %``; with the family where there are several."""
    families = {one.family for one in scored}
    name = group.role if len(families) == 1 else f"{group.family} {group.role}"
    return f"{name} {_percent(group)} %"


def _colour(scored: Sequence[Group]) -> str:
    lowest = min(map(_percent, scored))
    return next(colour for limit, colour in _COLOURS if lowest >= limit)


def _percent(group: Group) -> int:
    """Rounded down: 100 % is only what kills every mutant."""
    return int(100 * (group.scores.mean or 0.0) + 1e-9)


FORMAT = Format("badge", make)
