"""Classes of plain data that does not change, made in a quarter of the time that dataclasses take.

``dataclass(frozen=True)`` writes and compiles six functions for each class. Every test process has about a
hundred such classes, which were half of what it took to import ours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform

T = TypeVar("T")


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T]) -> type[T]:
    """Make a dataclass with slots of a class, with the methods of ``dataclass(frozen=True)``.

    Only its ``__init__`` is compiled for it; what compares, hashes and shows is shared by all. That nobody
    sets a field is for the type checker: what operators and reports of others are given is better made by
    ``dataclass(frozen=True)``, which refuses at run time.
    """
    made = dataclass(slots=True, eq=False, repr=False)(kind)
    shown = [one.name for one in fields(made) if one.repr]  # type: ignore[arg-type]
    compared = [one.name for one in fields(made) if one.compare]  # type: ignore[arg-type]
    for method in (*_comparing(_values_of(compared)), _showing(shown)):
        if method.__name__ not in vars(made):
            setattr(made, method.__name__, method)
    return made


def _values_of(names: list[str]) -> Callable[[Any], Any]:
    return attrgetter(*names) if names else lambda one: ()


def _comparing(values: Callable[[Any], Any]) -> tuple[Callable[..., Any], ...]:
    def __eq__(self: Any, other: object) -> bool:  # noqa: N807  # methods to be
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:  # noqa: N807
        return hash(values(self))

    return __eq__, __hash__


def _showing(names: list[str]) -> Callable[..., str]:
    def __repr__(self: Any) -> str:  # noqa: N807
        values = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{type(self).__qualname__}({values})"

    return __repr__
