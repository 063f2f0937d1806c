"""Which styles there are: every file of this folder that sets ``STYLE``."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import Insertion

from .style import Addition, Place, Style


@cache
def styles() -> tuple[Style, ...]:
    """In the order in which they are asked."""
    names = sorted(one.name for one in iter_modules([str(Path(__file__).parent)]))
    modules = [import_module(f"{__package__}.{name}") for name in names if name != "choice"]
    found: list[Style] = [module.STYLE for module in modules if hasattr(module, "STYLE")]
    return tuple(sorted(found, key=lambda one: one.order))


def style_of(place: Place) -> Style:
    """The style of a place."""
    return next(one for one in styles() if one.name == place.style)


def place_of(project: Project, test: str) -> Place | None:
    """The place of a test by its node id; None if no style knows how to add to it."""
    node = test.partition("[")[0]
    found = (style.place(project, node) for style in styles())
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
