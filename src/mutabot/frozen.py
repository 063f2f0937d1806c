"""Immutable classes of plain data, made in a fraction of the time that dataclasses take.

``dataclass(frozen=True)`` writes and compiles six functions for each class. Every process beside a robot
program has about a hundred such classes, which were half of what it took to import ours, and makes objects of
a few of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field
from operator import attrgetter, ge, gt, le, lt
from typing import Any, TypeVar, dataclass_transform, overload

T = TypeVar("T")
#: where ``dataclasses`` keeps the fields of a class
_FIELDS = "__dataclass_fields__"


@overload
def frozen(kind: type[T], /) -> type[T]: ...


@overload
def frozen(*, refuses: bool = ..., order: bool = ...) -> Callable[[type[T]], type[T]]: ...


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T] | None = None, /, *, refuses: bool = False, order: bool = False) -> Any:
    """Turn a class into a dataclass with slots and the methods of ``dataclass(frozen=True)``.

    Its ``__init__`` and its fields are made when they are first asked for, with its first object as a rule,
    or by ``compile_all``; what compares, hashes and shows is shared by all. All annotations are of fields.

    Args:
        refuses: whether fields cannot be set at run time either. Without, that is for the type checker; what
            operators and reports of others are given is better off with it.
        order: as in ``dataclass``.
    """
    if kind is None:
        return lambda kind: _frozen(kind, refuses=refuses, order=order)
    return _frozen(kind, refuses=refuses, order=order)


def _frozen(kind: type[T], *, refuses: bool, order: bool) -> type[T]:
    own = dict(vars(kind))
    inherited: dict[str, tuple[Any, Any]] = {}
    for base in reversed(kind.__mro__[1:]):
        inherited |= _given.get(base, {})
    names = own.get("__annotations__", {})
    given = inherited | {name: (text, own.pop(name, MISSING)) for name, text in names.items()}
    shown = [name for name, (_, default) in given.items() if not _is_without(default, "repr")]
    compared = [name for name, (_, default) in given.items() if not _is_without(default, "compare")]
    values = _values_of(compared)
    methods = [*_comparing(values), _showing(shown)]
    methods += [*_REFUSING] if refuses else []
    methods += [_ordering(values, compare) for compare in (lt, le, gt, ge)] if order else []
    for method in methods:
        own.setdefault(method.__name__, method)
    for name in ("__dict__", "__weakref__"):
        own.pop(name, None)
    own |= {"__slots__": tuple(name for name in given if name not in inherited), _FIELDS: _Later()}
    metaclass: Any = type(kind)
    made = metaclass(kind.__name__, kind.__bases__, own)
    made.__qualname__, made.__init__ = kind.__qualname__, _init_later(made)
    _given[made] = given
    _pending.add(made)
    return made  # type: ignore[no-any-return]


def _is_without(default: Any, method: str) -> bool:
    """Return whether a field excludes itself from this method."""
    return isinstance(default, Field) and not getattr(default, method)


#: the annotation of each field, and its default as the class body has it
_given: dict[type[Any], dict[str, tuple[Any, Any]]] = {}
#: the classes that have had no object yet
_pending: set[type[Any]] = set()
#: the classes whose methods they have. They are kept, since a class refers to itself: a test of the user's
#: may count what the collector of garbage finds
_helpers: list[type[Any]] = []


def compile_all() -> None:
    """Compile all remaining classes, in a process that will be forked, as otherwise each fork would."""
    for kind in list(_pending):
        _compile(kind)


def _compile(kind: Any) -> None:
    given = _given[kind]
    taken = ("__module__", "__qualname__", "__doc__", "__post_init__")
    body = {name: getattr(kind, name) for name in taken if hasattr(kind, name)}
    body["__annotations__"] = {name: text for name, (text, _) in given.items()}
    body |= {name: default for name, (_, default) in given.items() if default is not MISSING}
    refuses = kind.__setattr__ is _REFUSING[0]
    helper: type[Any] = dataclass(eq=False, repr=False, frozen=refuses)(type(kind.__name__, (), body))
    _helpers.append(helper)
    made = vars(helper)
    for name in ("__init__", "__match_args__", "__dataclass_params__", _FIELDS):
        setattr(kind, name, made[name])
    _pending.discard(kind)


def _init_later(kind: Any) -> Callable[..., None]:
    """Return an ``__init__`` that replaces itself by a compiled one when it is first called."""

    def __init__(self: Any, *values: Any, **named: Any) -> None:  # noqa: N807  # a method to be
        _compile(kind)
        kind.__init__(self, *values, **named)

    return __init__


class _Later:
    """The fields of a class that has had no object yet."""

    def __get__(self, instance: object, kind: type[Any]) -> Any:
        _compile(next(base for base in kind.__mro__ if vars(base).get(_FIELDS) is self))
        return getattr(kind, _FIELDS)


def _values_of(names: list[str]) -> Callable[[Any], Any]:
    return attrgetter(*names) if names else lambda value: ()


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


def _ordering(values: Callable[[Any], Any], compare: Callable[[Any, Any], bool]) -> Callable[..., Any]:
    def method(self: Any, other: object) -> bool:
        return compare(values(self), values(other)) if other.__class__ is self.__class__ else NotImplemented

    method.__name__ = f"__{compare.__name__}__"
    return method


def _refusing() -> tuple[Callable[..., None], ...]:
    def __setattr__(self: Any, name: str, value: Any) -> None:  # noqa: N807  # methods to be
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    def __delattr__(self: Any, name: str) -> None:  # noqa: N807
        raise FrozenInstanceError(f"cannot delete field {name!r}")

    def __setstate__(self: Any, state: tuple[None, dict[str, Any]]) -> None:  # noqa: N807
        for name, value in state[1].items():  # as copies and pickle have it
            object.__setattr__(self, name, value)

    return __setattr__, __delattr__, __setstate__


_REFUSING = _refusing()
