"""The operators on program text, by name: all that the files in ``operators/`` define."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pathlib import Path

from mutabot.errors import OperatorError, unknown_name_text
from mutabot.operators.registry import classes_in, modules_in

from .extension import OF_TEXT
from .operator import ConventionalOperator

_PACKAGE = f"{__package__}.operators"


@cache
def load_all() -> tuple[ConventionalOperator, ...]:
    """All operators, in the order of the documentation and of the alternatives at a place.

    Raises OperatorError when two have the same name, or one a family that is not of program text.
    """
    owners: dict[str, ConventionalOperator] = {}
    for module in modules_in(Path(__file__).parent / "operators"):
        for kind in classes_in(import_module(f"{_PACKAGE}.{module}"), ConventionalOperator):
            made: ConventionalOperator = kind()
            if made.name in owners:
                other = type(owners[made.name]).__module__
                text = f"operator {made.name!r} stands in {other} and in {kind.__module__}"
                raise OperatorError(text)
            if made.family not in OF_TEXT:
                text = f"operator {made.name!r} is of family {made.family!r}, which is none of {OF_TEXT}"
                raise OperatorError(text)
            owners[made.name] = made
    return tuple(sorted(owners.values(), key=lambda rule: (rule.rank, rule.name)))


def names(family: str | None = None) -> list[str]:
    """Names of the operators, of one family or of all."""
    return [each.name for each in load_all() if family in (None, each.family)]


def operator(name: str) -> ConventionalOperator:
    """The operator of this name. Raises OperatorError if there is none."""
    for each in load_all():
        if each.name == name:
            return each
    raise OperatorError(unknown_name_text("operator", name, names()))


def chosen(wanted: Iterable[str] | None) -> list[ConventionalOperator]:
    """The operators of these names, in the usual order; all for None. Raises OperatorError."""
    if wanted is None:
        return list(load_all())
    picked = {operator(name).name for name in wanted}
    return [each for each in load_all() if each.name in picked]
