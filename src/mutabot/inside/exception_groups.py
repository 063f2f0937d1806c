"""Exceptions that hold others: the leaves are what was really raised.

Exception groups hold what went wrong side by side, at any depth; doctest and pytest wrap what an example
raised, and the mismatches of a whole doctest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mutabot.errors import MutabotError
from mutabot.inside.targets.names import is_named
from mutabot.model.class_name import class_name

#: classes that are told by their names, since their modules may not be loaded, with what they hold
_WRAPPED, _SEVERAL = "doctest:UnexpectedException", "_pytest.doctest:MultipleDoctestFailures"


def leaves(error: BaseException) -> list[BaseException]:
    """What was really raised, in order; the exception itself if it holds no others."""
    held = _held(error)
    return [leaf for one in held for leaf in leaves(one)] if held else [error]


def everything(error: BaseException) -> Iterator[BaseException]:
    """The exception, all that it holds, and all that these were caused by or raised beside."""
    seen: set[int] = set()
    waiting = [error]
    while waiting:
        link = waiting.pop()
        if id(link) in seen:
            continue
        seen.add(id(link))
        yield link
        cause = _cause(link)
        waiting += [*_held(link), *([cause] if cause is not None else [])]


def failure_in(error: BaseException, failures: Iterable[str]) -> str | None:
    """What went wrong in the tool or the machine, as far as an exception tells; None if nothing did.

    ``failures``: names of exceptions that the vocabulary says mean nothing else.
    """
    for link in everything(error):
        if isinstance(link, MemoryError):
            return "the memory limit was reached"
        if isinstance(link, MutabotError) or is_named(link, failures):
            return f"{type(link).__name__}: {link}"
    return None


def is_due_to(error: BaseException, culprits: frozenset[int]) -> bool:
    """Whether an exception is one of the culprits (by ``id``), or caused by them and by nothing else.

    A group is so if all that it holds are, or if it was made of one: with ``raise … from``, or while a
    culprit was handled. What a group was raised beside says nothing otherwise: a task group ends beside
    the cancellation of its body.
    """
    return _is_due(error, culprits, frozenset())


def _is_due(error: BaseException | None, culprits: frozenset[int], above: frozenset[int]) -> bool:
    """``above``: what led here; a chain of exceptions may be a circle."""
    if error is None or id(error) in above:
        return False
    if id(error) in culprits:
        return True
    above |= {id(error)}
    held = _held(error)
    if not held:
        return _is_due(_cause(error), culprits, above)
    if all(_is_due(one, culprits, above) for one in held) or _is_due(error.__cause__, culprits, above):
        return True
    return id(_cause(error)) in culprits.difference(map(id, leaves(error)))


def _held(error: BaseException) -> tuple[BaseException, ...]:
    if isinstance(error, BaseExceptionGroup):
        return error.exceptions
    names = {class_name(kind) for kind in type(error).__mro__}
    if _WRAPPED in names:
        return (error.exc_info[1],)  # type: ignore[attr-defined]  # see above
    return tuple(error.failures) if _SEVERAL in names else ()  # type: ignore[attr-defined]


def _cause(error: BaseException) -> BaseException | None:
    return error.__cause__ or (None if error.__suppress_context__ else error.__context__)
