"""Which styles there are: every file of this folder that sets ``STYLE``."""

from __future__ import annotations

from functools import cache

from mutabot.suggestion.project import Project

from . import functions, scenarios, test_cases
from .style import Place, Style


@cache
def styles() -> tuple[Style, ...]:
    """In the order in which they are asked."""
    found: list[Style] = [functions.STYLE, scenarios.STYLE, test_cases.STYLE]
    return tuple(sorted(found, key=lambda one: one.order))


def style_of(place: Place) -> Style:
    """The style of a place."""
    return next(one for one in styles() if one.name == place.style)


def place_of(project: Project, test: str) -> Place | None:
    """The place of a test by its node id; None if no style knows how to add to it."""
    node = test.partition("[")[0]
    found = (style.place(project, node) for style in styles())
    return next((one for one in found if one is not None), None)
