"""The operators on program text, by name: all those defined by files in ``operators/``."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from importlib import import_module
from inspect import isabstract
from pkgutil import iter_modules

from . import operators
from .operator import ConventionalOperator


@cache
def load_all() -> tuple[ConventionalOperator, ...]:
    """Return all operators, in the order of the documentation and of the alternatives at a place."""
    found = [
        kind()
        for file in iter_modules(operators.__path__)
        for kind in vars(import_module(f"{operators.__name__}.{file.name}")).values()
        if isinstance(kind, type) and issubclass(kind, ConventionalOperator) and not isabstract(kind)
        if kind.__module__ == f"{operators.__name__}.{file.name}" and not kind.__name__.startswith("_")
    ]
    return tuple(sorted(found, key=lambda rule: (rule.rank, rule.name)))


def names(family: str | None = None) -> list[str]:
    """Return the names of the operators of one family or of all."""
    return [each.name for each in load_all() if family in (None, each.family)]


def operator(name: str) -> ConventionalOperator:
    """Return the operator with this name. Raises LookupError if there is none."""
    for each in load_all():
        if each.name == name:
            return each
    raise LookupError(f"there is no operator {name!r} on program text; there are {', '.join(names())}")


def select(wanted: Iterable[str] | None) -> list[ConventionalOperator]:
    """Return the operators with these names, in the usual order; all for None. Raises LookupError."""
    if wanted is None:
        return list(load_all())
    picked = {operator(name).name for name in wanted}
    return [each for each in load_all() if each.name in picked]
