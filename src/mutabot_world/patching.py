"""Wraps functions and classes, and finds the objects that a class has made."""

from __future__ import annotations

import gc
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from threading import get_ident
from types import ModuleType
from typing import Any

from .change import Undo

#: called before the function, with its arguments; what it returns, if anything, are others in their place
Before = Callable[..., tuple[tuple[Any, ...], dict[str, Any]] | None]
#: called after the function, with its first argument (of a method, the object) and its result
After = Callable[[Any, Any], object]
#: marks an exception as one of the function's own, and returns it
Own = Callable[[BaseException], BaseException]

#: flags of classes whose objects refer to them: made while Python runs, with objects that its collector knows
_REFER = 1 << 9 | 1 << 14

_marks: list[Own] = []


def resolve(reference: str) -> tuple[Any, str, Any]:
    """Return the owner, the last name, and the object of ``module:Class.method``.

    Raises LookupError if there is none.
    """
    module, _, path = reference.partition(":")
    *way, last = path.split(".")
    try:
        owner: Any = import_module(module)
        for name in way:
            owner = getattr(owner, name)
        return owner, last, getattr(owner, last)
    except (ImportError, AttributeError) as error:
        raise LookupError(f"there is no {reference}: {error}") from error


def mark_raised(error: BaseException) -> BaseException:
    """Mark an exception that a function raises itself as not caused by the disturbance, and return it."""
    return _marks[-1](error) if _marks else error


def mark_by(own: Own) -> None:
    """Let a disturbance mark exceptions that functions raise themselves; only one is active in a process."""
    _marks[:] = [own]


def rebind(old: Any, new: Any) -> None:
    """Replace a function by another one, under every name by which a module refers to it."""
    for module in [*sys.modules.values()]:
        for name, found in [*(getattr(module, "__dict__", None) or {}).items()]:
            if found is old:
                setattr(module, name, new)


def wrap(reference: str, *, before: Before | None = None, after: After | None = None) -> Undo:
    """Call a function before or after another function or method, or when objects of a class are made.

    Of an object it is called after all that makes it, also where a subclass does more than the class.
    Returns what takes it away again. Raises LookupError.
    """
    owner, last, found = resolve(reference)
    if not isinstance(found, type):
        return _wrap_attribute(owner, last, before, after, set())
    below = [cls for cls in dict.fromkeys(_below(found)) if after and "__init__" in vars(cls)]
    running: set[Any] = set()
    undoes = [_wrap_attribute(found, "__init__", before, after, running)]
    undoes += [_wrap_attribute(cls, "__init__", None, after, running) for cls in below]
    return lambda: [each() for each in undoes]


def _below(kind: type) -> Iterator[type]:
    """Yield all subclasses of a class."""
    below: list[type] = kind.__subclasses__()
    for cls in below:
        yield cls
        yield from _below(cls)


def _wrap_attribute(
    owner: Any, last: str, before: Before | None, after: After | None, running: set[Any]
) -> Undo:
    """Call a function before or after ``owner.last``, but not in nested calls (see ``running``)."""
    found, kept = getattr(owner, last), inspect.getattr_static(owner, last)
    is_maker = isinstance(owner, type) and last == "__init__"
    is_inherited = isinstance(owner, type) and last not in vars(owner)

    def around(*arguments: Any, **named: Any) -> Any:
        key = id(arguments[0]) if is_maker else get_ident()
        is_first = key not in running
        replaced = before(*arguments, **named) if before is not None and is_first else None
        if replaced is not None:
            arguments, named = replaced
        running.add(key)
        try:
            result = found(*arguments, **named)
        except BaseException as error:
            mark_raised(error)
            raise
        finally:
            if is_first:
                running.discard(key)
        if after is not None and is_first:
            after(arguments[0] if arguments else None, arguments[0] if is_maker else result)
        return result

    around.__wrapped__ = found  # type: ignore[attr-defined]  # as functools.wraps does
    around.__name__ = getattr(found, "__name__", last)
    is_static = isinstance(kept, staticmethod) or (isinstance(owner, type) and not inspect.isroutine(kept))
    setattr(owner, last, staticmethod(around) if is_static and not is_maker else around)
    is_of_module = isinstance(owner, ModuleType)
    if is_of_module:  # others may have imported it by its name
        rebind(found, around)

    def undo() -> None:
        if is_inherited:
            delattr(owner, last)
        else:
            setattr(owner, last, kept)
        if is_of_module:
            rebind(around, found)

    return undo


def instances_of(references: list[str]) -> Iterator[Any]:
    """Yield the objects of these classes that are alive, each once; references to functions yield nothing."""
    kinds = tuple(found for reference in references if isinstance(found := resolve(reference)[2], type))
    if kinds:
        # what is frozen is in no list; to freeze more than the program did would keep garbage
        gc.unfreeze()
        yield from {id(held): held for held in _held(kinds) if isinstance(held, kinds)}.values()


def _held(kinds: tuple[type, ...]) -> Iterable[Any]:
    """Return objects among which are all of these classes."""
    classes = {*kinds, *(cls for kind in kinds for cls in _below(kind))}
    if all(cls.__flags__ & _REFER == _REFER for cls in classes):
        return gc.get_referrers(*classes)  # writes to no other object: a fork would get a copy of each
    # those that Python's collector does not know are held by others
    return (held for holder in gc.get_objects() for held in (holder, *gc.get_referents(holder)))
