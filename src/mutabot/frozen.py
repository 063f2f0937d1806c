"""Classes of plain data that does not change, made in a tenth of the time that dataclasses take.

``dataclass(frozen=True)`` writes and compiles six functions for each class. Every process beside a robot
program has about a hundred such classes, which were half of what it took to import ours, and makes objects of
a few of them.
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

    Only its ``__init__`` is compiled for it, with its first object or by ``compile_all``; what compares,
    hashes and shows is shared by all. That nobody sets a field is for the type checker: what operators and
    reports of others are given is better made by ``dataclass(frozen=True)``, which refuses at run time.
    """
    made = dataclass(slots=True, init=False, eq=False, repr=False)(kind)
    made.__init__ = _init_later(made)  # type: ignore[method-assign]
    shown = [one.name for one in fields(made) if one.repr]  # type: ignore[arg-type]
    compared = [one.name for one in fields(made) if one.compare]  # type: ignore[arg-type]
    for method in (*_comparing(_values_of(compared)), _showing(shown)):
        if method.__name__ not in vars(made):
            setattr(made, method.__name__, method)
    return made


#: what compiles the ``__init__`` of the classes that have had no object yet
_pending: dict[type[Any], Callable[[], None]] = {}


def compile_all() -> None:
    """Compile all that is left to compile: in a process that will be forked, else each fork would do it."""
    for compile_one in list(_pending.values()):
        compile_one()


def _init_later(kind: type[Any]) -> Callable[..., None]:
    """An ``__init__`` that gives way to a compiled one when it is called first."""

    def compile_one() -> None:
        taken = ("__module__", "__qualname__", "__doc__", "__post_init__")
        body = {name: getattr(kind, name) for name in taken if hasattr(kind, name)}
        body["__annotations__"] = {one.name: one.type for one in fields(kind)}
        body |= {one.name: one for one in fields(kind)}
        kind.__init__ = dataclass(eq=False, repr=False)(type(kind.__name__, (), body)).__init__  # type: ignore[misc]
        _pending.pop(kind, None)

    def __init__(self: Any, *values: Any, **named: Any) -> None:  # noqa: N807  # a method to be
        compile_one()
        kind.__init__(self, *values, **named)

    _pending[kind] = compile_one
    return __init__


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
