"""Exceptions of a test: those in groups and chains, and whether a refusal of the robot caused one."""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Iterator, Sequence

from mutabot.errors import MutabotError, error_text, text_of
from mutabot.extensions import brought
from mutabot.model.path import class_name

#: classes that are identified by their names, since their modules may not be loaded, with what they hold
_WRAPPED, _SEVERAL = "doctest:UnexpectedException", "_pytest.doctest:MultipleDoctestFailures"


def leaves(error: BaseException) -> list[BaseException]:
    """Return the exceptions in a group, in order; the exception itself if it is no group."""
    held = _held(error)
    return [leaf for part in held for leaf in leaves(part)] if held else [error]


def everything(error: BaseException) -> Iterator[BaseException]:
    """Yield the exception, those in its group, and all their causes and contexts."""
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
    """Return the failure of the tool or the machine that an exception reports; None if it reports none.

    ``failures``: names of exceptions that the vocabulary says mean nothing else; packages name others.
    """
    from mutabot.runtime.targets.target import is_named  # noqa: PLC0415  # few exceptions are looked at

    failures = (*failures, *(part.reference for part in brought("failures").values()))
    for link in everything(error):
        if isinstance(link, MemoryError):
            return "the memory limit was reached"
        if isinstance(link, MutabotError) or is_named(link, failures):
            return error_text(link)
    return None


class KnownError:
    """Recognizes an exception without keeping it, or what its frames hold, alive.

    Most classes of Python's own cannot be referred to weakly. Of these, one that takes the place of another
    in memory and says the same is taken for it.
    """

    __slots__ = ("_address", "_reference", "_said")

    def __init__(self, error: BaseException) -> None:
        self._address = id(error)
        self._reference: weakref.ref[BaseException] | None = None
        try:
            self._reference = weakref.ref(error)
        except TypeError:
            self._said = (type(error), text_of(error))

    def matches(self, error: BaseException) -> bool:
        """Return whether this is the exception."""
        if self._reference is not None:
            return self._reference() is error
        return self._address == id(error) and self._said == (type(error), text_of(error))


class Refusal:
    """An exception by which the robot refused a mutated call.

    Attributes:
        text: what it said.
        noted: itself, and those that it held.
    """

    __slots__ = ("noted", "text")

    def __init__(self, error: BaseException) -> None:
        held = leaves(error)
        self.text = text_of(held[0])
        self.noted = tuple(map(KnownError, (error, *(leaf for leaf in held if leaf is not error))))


def is_due_to(error: BaseException, culprits: Sequence[KnownError]) -> bool:
    """Return whether an exception is one of the culprits, or was caused by them alone.

    A group is so if all that it holds are, or if it was made of one: with ``raise … from``, or while a
    culprit was handled. What a group was raised beside says nothing otherwise: a task group ends beside
    the cancellation of its body.
    """
    return _is_due(error, culprits, frozenset())


def _is_due(error: BaseException | None, culprits: Sequence[KnownError], above: frozenset[int]) -> bool:
    """Return whether an exception is due to culprits; ``above`` has those on the way, against circles."""
    if error is None or id(error) in above:
        return False
    if any(culprit.matches(error) for culprit in culprits):
        return True
    above |= {id(error)}
    held = _held(error)
    if not held:
        return _is_due(_cause(error), culprits, above)
    if all(_is_due(part, culprits, above) for part in held) or _is_due(error.__cause__, culprits, above):
        return True
    cause = _cause(error)
    is_known = cause is not None and any(culprit.matches(cause) for culprit in culprits)
    return is_known and all(cause is not leaf for leaf in leaves(error))


def _held(error: BaseException) -> tuple[BaseException, ...]:
    if isinstance(error, BaseExceptionGroup):
        return error.exceptions
    names = {class_name(kind) for kind in type(error).__mro__}
    if _WRAPPED in names:
        return (error.exc_info[1],)  # type: ignore[attr-defined]  # see above
    return tuple(error.failures) if _SEVERAL in names else ()  # type: ignore[attr-defined]


def _cause(error: BaseException) -> BaseException | None:
    return error.__cause__ or (None if error.__suppress_context__ else error.__context__)
