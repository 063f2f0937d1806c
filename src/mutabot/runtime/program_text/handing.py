"""Operations that are handed on without being called, and what stands in their place.

The robot's own operations see their calls by themselves, from wherever (``targets``). What stands in for them
does not, so it is made to where the program hands it on: ``go = arm.move``, ``partial(arm.move, 0.5)``,
``pool.submit(arm.move, 1)``. Mocks stay the objects that they are: all calls of mocks are seen, and one that
was handed on, or has the name of an operation and is called by the program, makes a call of it. Anything else
is handed on in a wrapper that is equal to it, and looks like it.

The site of such a call is the nearest call of the program on the stack, as of any that no text shows; in
another thread, where there is none, the call to which it was given. What was handed on as the same object in
several places has none there, which is said.
"""

from __future__ import annotations

import copy
import sys
from functools import partial
from pkgutil import resolve_name
from types import FrameType, MethodType, ModuleType
from typing import Any

import wrapt

from mutabot.model import Role, Span
from mutabot.runtime.interception.adapter import Adapter
from mutabot.runtime.interception.dispatcher import is_coroutine_function, is_under_way
from mutabot.runtime.program_text.call_sites import NOTHING, CallSite
from mutabot.runtime.program_text.standing import WRAPPERS, Standing, mock_of, stands_for_property

#: what a mock stands for, as noted on it: the operation, what it was read from, and where it was handed on,
#: which is None if nobody knows any more
_MARK = "_mutabot_handed"


class Handed(wrapt.FunctionWrapper):  # type: ignore[type-arg]
    """A callable that was handed on; a partial makes its calls."""

    def __new__(cls, wrapped: Any, handed: Any) -> Any:
        """With an object in place of the partial, as weak methods do it: a function bound to it."""
        if type(handed) is partial:
            return super().__new__(cls, wrapped, handed)  # type: ignore[call-arg]
        return MethodType(wrapped, handed)

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        return Handed(copy.deepcopy(self.__wrapped__, known), self._self_wrapper)

    def __reduce_ex__(self, protocol: Any) -> Any:
        function = self.__wrapped__
        owner = getattr(function, "__self__", None)
        if owner is None or isinstance(owner, ModuleType):
            return resolve_name, (f"{function.__module__}:{function.__qualname__}",)
        return getattr, (owner, function.__name__)


class Handing:
    """Decides what is handed on, and sees the calls of mocks.

    Args:
        standing: decides what stands for an operation.
        given: takes where functions of the robot were handed on; None if nobody knows any more.
    """

    def __init__(self, standing: Standing, given: dict[Adapter, tuple[Span, Role] | None]) -> None:
        self._standing = standing
        self._given = given
        wrapt.register_post_import_hook(self._watch, "unittest.mock")

    def __call__(self, site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        """What is handed on at a site: ``found``, or what is equal to it."""
        if not callable(found) or isinstance(found, type) or type(found) is Handed:
            return found
        place = self._standing.place(site, frame)
        if type(found) in WRAPPERS:
            own = self._standing.candidate_of(found._self_wrapper)
            if own is None:
                return found
            self._standing.stood[place[0]] = own.operation.target
            if type(found) is wrapt.FunctionWrapper:  # all names of a function mean this very object
                known = self._given.setdefault(own, place)
                if known == place or not site.is_given:
                    self._given[own] = place if known == place else None
                    return found
            return self._wrapped(own, place, receiver, found, found.__wrapped__)
        one = self._standing.candidate(site, found, receiver, frame)
        if one is None:
            return found
        if self._standing.noted is not None:
            self._standing.noted.note(site, one.operation, found, receiver)
        mock = mock_of(found)
        if mock is not None:
            known = vars(mock).get(_MARK, (one, receiver, place))
            if known[2] == place or not site.is_given:
                vars(mock)[_MARK] = (*known[:2], place if known[2] == place else None)
                return found
        return self._wrapped(one, place, receiver, found, found)

    def _wrapped(
        self, one: Adapter, place: tuple[Span, Role], receiver: Any, looks: Any, found: Any
    ) -> Handed:
        """What looks like one callable and calls ``found``, which may be the same, as an operation."""
        calls = partial(self._call, one, place, receiver, found)
        says_it_is_one = mock_of(looks) is looks and isinstance(looks, WRAPPERS)
        # such a mock was made after a wrapped function. wrapt would ask it how it binds, which it refuses to
        # say, and then no wrapper can be made on Python 3.13: so wrapt first sees another callable
        made: Handed = Handed(calls if says_it_is_one else looks, calls)
        if says_it_is_one:
            made.__wrapped__ = looks
        return made

    def _call(
        self,
        one: Adapter,
        place: tuple[Span, Role],
        receiver: Any,
        found: Any,
        wrapped: Any,
        instance: Any,
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
    ) -> Any:
        __tracebackhide__ = True
        if receiver is NOTHING and instance is not None:  # it was made a method, or is one
            receiver, found = instance, wrapped
        where = {"handed": place, "frame": sys._getframe(1)}
        return self._standing.call(one, where, found, receiver, *args, **kwargs)

    def _watch(self, mock: ModuleType) -> None:
        """See the calls of all mocks."""
        kind: Any = mock.CallableMixin
        original = kind.__call__

        def call(self: Any, /, *args: Any, **kwargs: Any) -> Any:
            __tracebackhide__ = True
            return seen(original, self, sys._getframe(1), args, kwargs)

        seen = self._seen
        call.__name__, call.__qualname__ = original.__name__, original.__qualname__
        kind.__call__ = call

    def _seen(
        self, original: Any, mock: Any, frame: FrameType, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> Any:
        __tracebackhide__ = True
        own = vars(mock)
        mark = own.get(_MARK)
        name = own.get("_mock_new_name") or own.get("_mock_name")
        is_written = bool(args) and stands_for_property(mock)
        if is_under_way() or is_written or (mark is None and name not in self._standing.by_name):
            return original(mock, *args, **kwargs)
        caller = _caller(frame)
        if mark is not None:
            one, receiver, place = mark
        else:
            parent = own.get("_mock_new_parent")
            one, receiver, place = None, NOTHING if parent is None else parent, None
            if caller is not None and self._standing.locator.role(caller.f_code.co_filename) is not None:
                one = self._standing.named(name, mock, receiver, caller)
        if one is None:
            return original(mock, *args, **kwargs)
        if place is None and mark is not None and self._standing.noted is not None:
            self._standing.noted.note_elsewhere(one.operation, self._standing.locator.locate(caller))
        where = {"handed": place, "frame": caller, "is_awaited": is_coroutine_function(mock)}
        return self._standing.call(one, where, partial(original, mock), receiver, *args, **kwargs)


def _caller(frame: FrameType | None) -> FrameType | None:
    """The frame that calls a mock, without those of its making."""
    while frame is not None and (
        frame.f_globals.get("__name__") == "unittest.mock" or "_checksig_" in frame.f_globals
    ):
        frame = frame.f_back
    return frame
