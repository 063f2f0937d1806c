"""Which styles there are."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.suggestion.project import Insertion, Project
from mutabot.suggestion.style import Addition, Place, Style
from mutabot.suggestion.styles.functions import PYTEST, UNITTEST

from .scenarios import PYTEST_BDD

#: in the order in which they are asked
STYLES: tuple[Style, ...] = (UNITTEST, PYTEST_BDD, PYTEST)


def style_of(place: Place) -> Style:
    """The style of a place."""
    return next(one for one in STYLES if one.name == place.style)


def place_of(project: Project, test: str) -> Place | None:
    """The place of a test by its node id; None if no style knows how to add to it."""
    node = test.partition("[")[0]
    found = (style.place(project, node) for style in STYLES)
    return next((one for one in found if one is not None), None)


def insertions_of(project: Project, additions: Sequence[Addition]) -> list[Insertion]:
    """What puts additions where they belong, by the styles of their tests."""
    found: list[Insertion] = []
    by_file: dict[tuple[str, str], list[Addition]] = {}
    for one in additions:
        by_file.setdefault((one.place.style, one.place.file), []).append(one)
    for same in by_file.values():
        found += style_of(same[0].place).at_end(project, same)
    return found
