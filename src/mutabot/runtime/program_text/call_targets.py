"""Decide what is called at a call site: an operation, a replacement, or another callable of that name.

People who test hardware code put mocks, fakes and patched classes in the place of the robot. A person who
edits the text changes these; so does a mutant. Hence a call is seen at its site wherever what
is called is not the operation itself, which sees its calls (``targets``). In the place of an operation stands

1. an attribute of its name, of an object of the operation's class, or of what stands in for that class;
2. what the operation's name means now, or a name of a module that meant it when the module was loaded;
3. a mock of it: by what it is made of, or by its name alone if only one operation has that name;
4. at the site of a mutant of this session, whatever has the name.

What the program defines itself is program: the calls in it are seen.

What stood in for the robot in the tests, and which calls of an operation's name were left alone.

Operations that are handed on without being called, and what stands in their place.

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
import inspect
import sys
import weakref
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from inspect import Signature
from sys import _getframe
from types import BuiltinMethodType, FrameType, FunctionType, MethodType, ModuleType
from typing import Any

import wrapt

from mutabot.languages.python import function_of
from mutabot.model import ANY, Operation, Role, Span
from mutabot.model.data import is_mock
from mutabot.model.path import class_name
from mutabot.model.signature import signature_of
from mutabot.runtime.executed_text import file_of
from mutabot.runtime.interception.adapter import Adapter
from mutabot.runtime.interception.dispatcher import is_coroutine_function, is_untracked
from mutabot.runtime.interception.frames import ModuleCache, borders
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.program_text.call_sites import NOTHING, CallSite, Guards
from mutabot.runtime.targets.callables import Callables
from mutabot.runtime.targets.target import CallPlace, Finding, Handler, Where, named_class
from mutabot.runtime.targets.wrapper import WRAPPERS, Wrapper, unbound

#: calls that are listed in one sentence
_MOST = 5


@dataclass(slots=True)
class CallFindings:
    """What was called at sites, for the check of a vocabulary.

    Args:
        test: returns the running test.
        relative: returns a path below the root.
    """

    test: Callable[[], str]
    relative: Callable[[str], str]
    _replaced: dict[str, dict[str, set[str]]] = field(default_factory=dict)
    _alone: dict[str, dict[str, str]] = field(default_factory=dict)
    _sites: set[CallSite] = field(default_factory=set)
    _elsewhere: dict[str, set[str]] = field(default_factory=dict)

    def note(self, site: CallSite, operation: Operation | None, found: Any, receiver: Any) -> None:
        """Note what was called at a site, as this operation or as none."""
        what = _shown(found, receiver, site.name)
        if operation is not None:
            self._sites.add(site)
            self._replaced.setdefault(operation.target, {}).setdefault(what, set()).add(self.test())
        elif site.role is Role.PROGRAM and site not in self._sites:
            place = f"{self.relative(site.path)}:{site.extent[0]}"
            self._alone.setdefault(site.name, {})[place] = what

    def note_elsewhere(self, operation: Operation, place: CallPlace | None) -> None:
        """Note a call whose place only a frame can give, if anything can."""
        if place is None:
            self._elsewhere.setdefault(operation.target, set()).add(self.test())

    def findings(self, operations: Iterable[Operation]) -> Iterator[tuple[Operation, Finding]]:
        """Yield findings about replaced operations, calls without a place, and calls that were left alone."""
        for operation in operations:
            target, name, reasons = operation.target, operation.last_name, []
            replaced = self._replaced.get(target, {})
            if replaced and not target.startswith(ANY):
                shown = (f"{what} in {_count(len(tests), 'test')}" for what, tests in replaced.items())
                reasons.append(f"it is replaced by {', '.join(shown)}")
            if target in self._elsewhere:
                which = _count(len(self._elsewhere[target]), "test")
                where = "handed on in several places and called in a thread or by an operation"
                reasons.append(f"{where} in {which}: such calls are not mutated")
            if reasons:
                yield operation, Finding("call", "; ".join(reasons), is_remark=True)
            alone = self._alone.pop(name, {})
            if alone:
                listed = ", ".join(f"{place} ({what})" for place, what in list(alone.items())[:_MOST])
                more = f" and {len(alone) - _MOST} more" if len(alone) > _MOST else ""
                text = f"{_count(len(alone), 'call')} of {name} on other objects may be another function"
                advice = f'they get no mutants; if they are this one, write method = "{name}"'
                yield operation, Finding("method", f"{text}: {listed}{more}; {advice}", is_remark=True)


def mock_of(found: Any) -> Any:
    """Return the mock that this callable is or wraps; None if there is none."""
    made = vars(found).get("mock") if type(found) is FunctionType else found
    return made if is_mock(made) else None


def _shown(found: Any, receiver: Any, name: str) -> str:
    if mock_of(found) is not None or mock_of(receiver) is not None:
        return "a mock"
    if type(found) in (FunctionType, MethodType) and found is inspect.getattr_static(receiver, name, None):
        return f"{found.__module__}:{found.__qualname__}"  # an attribute of this object alone
    if receiver is NOTHING or isinstance(receiver, ModuleType):
        return str(getattr(type(found), "__name__", ""))
    return class_name(receiver if isinstance(receiver, type) else type(receiver))


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


@dataclass(slots=True)
class CallTargets:
    """Decides what is called at the sites of one process.

    Args:
        adapters: of the operations that can be called.
        callables: where they were found.
        locator: whose file is whose.
        sees_itself: handlers of what sees its calls itself.

    Attributes:
        known: operations by the sites of this session's mutants.
        noted: what is to be reported of it; None if that is not wanted.
        stood: operations that stood at sites which something was left alone at, or could be.
        alone: where something was left alone.
        wrapped: where the call of a decorator's function was left to the calls in it.
        by_name: the operations by their last names.
    """

    adapters: Collection[Adapter]
    callables: Callables
    locator: Locator
    sees_itself: Collection[Handler]
    known: Mapping[Span, str] = field(default_factory=dict)
    noted: CallFindings | None = None
    stood: dict[Span, str] = field(default_factory=dict)
    alone: set[Span] = field(default_factory=set)
    wrapped: set[Span] = field(default_factory=set)
    by_name: dict[str, list[Adapter]] = field(default_factory=dict)
    _signatures: dict[Adapter, Signature | None] = field(default_factory=dict)
    _meant: ModuleCache[int, dict[str, Any]] = field(default_factory=ModuleCache)

    def __post_init__(self) -> None:
        for adapter in self.adapters:
            self.by_name.setdefault(adapter.operation.last_name, []).append(adapter)

    def __call__(self, site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        """Return what is called at a site: ``found``, or a wrapper that calls it as an operation."""
        adapter = self.candidate(site, found, receiver, frame)
        if self.noted is not None and (adapter is not None or not self._is_seen(found)):
            operation = adapter.operation if adapter is not None else None
            self.noted.note(site, operation, found, receiver)
        if adapter is None:
            if _is_decided_by_type(found, receiver):
                kind = type(found)
                own = found.__func__ if kind is MethodType else found if kind is FunctionType else kind
                site.left_alone[type(receiver), own] = self._guards(site, frame)
            return found
        where = {"site": self.place(site, frame), "is_awaited": site.is_awaited, "frame": frame}
        where["stands_in"] = self.stands_in(found)
        return partial(self.call, adapter, where, found, receiver)

    def _guards(self, site: CallSite, frame: FrameType) -> Guards:
        """Return the conditions for skipping this call: operations and their classes are unchanged."""
        here = frame.f_globals
        named = {(id(here), name): (here, name, here.get(name)) for name in self._names_of(here)}
        for adapter in self.by_name[site.name]:
            module, _, qualname = adapter.operation.target.partition(":")
            names, first = vars(sys.modules.get(module, sys)), qualname.partition(".")[0]
            named[id(names), first] = (names, first, names.get(first))
        return tuple(named.values())

    def note_modules(self, paths: set[str]) -> None:
        """Note which names denote operations in the modules of these files, which were just loaded."""
        for module in list(sys.modules.values()) if paths else ():
            if isinstance(module, ModuleType) and getattr(module, "__file__", None) in paths:
                self._names_of(vars(module))
        paths.clear()

    def call(
        self, adapter: Adapter, where: dict[str, Any], found: Any, receiver: Any, /, *args: Any, **kwargs: Any
    ) -> Any:
        """Call a callable that was read from ``receiver`` as an operation; ``where`` is of type ``Where``."""
        __tracebackhide__ = True
        owner = self._owner(adapter)
        is_method = owner is not None or adapter.operation.target.startswith(ANY)
        given = None if receiver is NOTHING else receiver
        instance = given if is_method else None
        is_own = adapter.operation.overrides and type(found) is MethodType
        signature = signature_of(found) if is_own else self._signature_of(adapter)
        if args and isinstance(receiver, type) and _is_of_objects(owner, adapter):  # called through its class
            instance, found, args = args[0], partial(found, args[0]), args[1:]
        try:
            return adapter.handler(
                found, instance, args, kwargs, Where(receiver=given, signature=signature, **where)
            )
        except BaseException:
            found = receiver = args = kwargs = where = given = instance = None  # type: ignore[assignment]
            raise  # who keeps the exception keeps this frame

    def stands_in(self, found: Any) -> bool:
        """Return whether a callable is a mock, or a fake: a function of the project that is no operation."""
        file = _file_of(found)
        return mock_of(unbound(found)) is not None or bool(file and self.locator.is_of_project(file))

    def place(self, site: CallSite, frame: FrameType) -> CallPlace:
        """Return the place of a site."""
        if site.place is None:
            span = Span(self.locator.relative(site.path), *site.extent, function_of(frame.f_code))
            site.place = (span, site.role)
        return site.place

    def candidate(self, site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Adapter | None:
        """Return the operation at a site, unless its calls are intercepted anyway."""
        if self._is_seen(found):
            if type(unbound(found)) is FunctionType:
                self.wrapped.add(self.place(site, frame)[0])
            return None
        adapter = self.named(site.name, found, receiver, frame)
        if adapter is None and self.known:
            target = self.known.get(self.place(site, frame)[0])
            named = self.by_name[site.name]
            adapter = next((other for other in named if other.operation.target == target), None)
        if adapter is None:
            self.alone.add(self.place(site, frame)[0])
        else:
            self.stood[self.place(site, frame)[0]] = adapter.operation.target
        return adapter

    def _is_seen(self, found: Any) -> bool:
        """Return whether calls are intercepted whatever name they have."""
        if type(found) is PassedCallable:
            return True
        return any(handler in self.sees_itself for handler in _handlers(found))

    def named(self, name: str, found: Any, receiver: Any, frame: FrameType) -> Adapter | None:
        """Return the operation of this name that a callable replaces."""
        mock = mock_of(found)
        is_read = is_mock(mock, "PropertyMock")  # called when the attribute is read
        raw, kinds = self.callables.found, (property, cached_property)
        ones = [
            adapter
            for adapter in self.by_name[name]
            if isinstance(raw.get(adapter.operation.target), kinds) is is_read
        ]
        fitting = [adapter for adapter in ones if self._is_of_class(adapter, found, receiver, frame)]
        if fitting:
            return max(fitting, key=lambda adapter: len(getattr(self._owner(adapter), "__mro__", ())))
        fitting += [adapter for adapter in ones if self._means(adapter, found, receiver, frame)]
        if mock is not None:
            fitting += (
                ones if len(ones) == 1 else [adapter for adapter in ones if self._is_mocked(adapter, mock)]
            )
        fitting += [adapter for adapter in ones if adapter.operation.target.startswith(ANY)]
        return fitting[0] if fitting else None

    def _is_of_class(self, adapter: Adapter, found: Any, receiver: Any, frame: FrameType) -> bool:
        """Return whether a callable is an attribute of an object of the operation's class."""
        if receiver is NOTHING and _is_method(found):
            receiver = found.__self__
        owner = self._owner(adapter)
        if owner is None or receiver is NOTHING:
            return False
        file = _file_of(found)
        if file and self.locator.role(file) is Role.PROGRAM and not adapter.operation.overrides:
            return False
        return any(_is_a(receiver, kind) for kind in self._kinds(adapter, owner, frame))

    def _kinds(self, adapter: Adapter, owner: type, frame: FrameType) -> Iterator[Any]:
        """Yield the operation's class, and its replacements."""
        yield owner
        yield named_class(adapter.operation.target.rpartition(".")[0])
        for name, meant in self._names_of(frame.f_globals).items():
            if meant is owner:
                yield frame.f_globals.get(name)

    def _means(self, adapter: Adapter, found: Any, receiver: Any, frame: FrameType) -> bool:
        """Return whether a callable is what the operation's name denotes now, or denoted first."""
        if self._owner(adapter) is None and named_class(adapter.operation.target) is found:
            return True
        meant = self._names_of(frame.f_globals).items() if receiver is NOTHING else ()
        names = frame.f_globals
        return any(value is adapter.handler and names.get(name) is found for name, value in meant)

    def _is_mocked(self, adapter: Adapter, mock: Any) -> bool:
        """Return whether a mock's specification shows that it replaces an operation."""
        wrapped = vars(mock).get("_mock_wraps")
        parent = vars(mock).get("_mock_parent") or vars(mock).get("_mock_new_parent")
        spec = vars(parent).get("_spec_class") if parent is not None else None
        owner = self._owner(adapter)
        if owner is not None and isinstance(spec, type) and issubclass(spec, owner):
            return True
        return any(handler is adapter.handler for handler in _handlers(wrapped))

    def _names_of(self, names: dict[str, Any]) -> dict[str, Any]:
        """Return the names of a module that denoted operations, or their classes, when it was first seen.

        With the class, or the handler of the operation.
        """
        known = self._meant.known.get(id(names))
        if known is None:
            owners = self.callables.owners.values()
            found: dict[str, Any] = {}
            for name, value in list(names.items()):
                if type(value) is Wrapper and value._self_wrapper in self.sees_itself:
                    found[name] = value._self_wrapper
                elif any(value is owner for owner in owners):
                    found[name] = value
            known = self._meant.keep(names, id(names), found)
        return known

    def _owner(self, adapter: Adapter) -> type | None:
        """Return the operation's class, also of a module that the tests put in place without an import."""
        target = adapter.operation.target
        owner = self.callables.owners.get(target)
        if owner is None and target in self.callables.pending:
            found = named_class(target.rpartition(".")[0])
            return found if isinstance(found, type) else None
        return owner

    def _signature_of(self, adapter: Adapter) -> Signature | None:
        """Return the operation's own signature; None if it has none, or was not found yet."""
        original = self.callables.found.get(adapter.operation.target)
        if isinstance(original, property):
            original = original.fset if adapter.operation.described else original.fget
        if adapter not in self._signatures and original is not None:
            found = signature_of(getattr(original, "__func__", original))
            is_method = self._owner(adapter) is not None and not isinstance(original, staticmethod)
            if found is not None and is_method:
                found = found.replace(parameters=list(found.parameters.values())[1:])
            self._signatures[adapter] = found
        return self._signatures.get(adapter)


def _is_method(found: Any) -> bool:
    """Return whether a callable is a method, or a proxy of one."""
    return isinstance(found, MethodType) and issubclass(type(found), (MethodType, wrapt.ObjectProxy))


def _file_of(found: Any) -> str:
    """Return the file of a function, a method or a proxy of one.

    "" of what only claims to be one, as a mock does: it would note the question as a call of it.
    """
    kind = type(found)
    while issubclass(kind, (MethodType, wrapt.ObjectProxy)):
        found = found.__func__ if kind is MethodType else found.__wrapped__
        kind = type(found)
    return file_of(found.__code__) if kind is FunctionType else ""


def _is_of_objects(owner: type | None, adapter: Adapter) -> bool:
    """Return whether an operation is an instance method, rather than a class method or static method."""
    if owner is None:
        return False
    raw = inspect.getattr_static(owner, adapter.operation.last_name, None)
    wrapped = getattr(raw, "__wrapped__", raw)
    return not any(isinstance(found, classmethod | staticmethod) for found in (raw, wrapped))


def _handlers(found: Any) -> Iterator[Any]:
    """Yield the handlers around a callable, or around what it is bound to or wraps."""
    for _ in range(9):
        kind = type(found)
        if kind in WRAPPERS:
            yield found._self_wrapper
        if kind is MethodType:
            found = found.__func__
        elif issubclass(kind, WRAPPERS) or (kind is FunctionType and "__wrapped__" in vars(found)):
            found = found.__wrapped__
        else:
            return


def _is_decided_by_type(found: Any, receiver: Any) -> bool:
    """Return whether the types of callable and receiver suffice to leave such calls alone."""
    if type(found) is FunctionType:  # one that is always the same
        return receiver is NOTHING and "<locals>" not in found.__qualname__
    if receiver is NOTHING or isinstance(receiver, type | ModuleType):
        return False
    try:
        if receiver.__class__ is not type(receiver):  # it stands for something else
            return False
    except Exception:  # a proxy may fail to say what it stands for
        return False
    of_python = type(found) is MethodType and type(found.__func__) is FunctionType
    return (of_python or type(found) is BuiltinMethodType) and found.__self__ is receiver


def _is_a(value: Any, kind: Any) -> bool:
    """Return whether a value is an instance of a class, that class or a subclass, or claims to be."""
    if not isinstance(kind, type):
        return False
    try:
        return isinstance(value, kind) or (isinstance(value, type) and issubclass(value, kind))
    except Exception:  # a class of the user's may answer in any way
        return False


#: what a mock stands for, as noted on it: the operation, what it was read from, and where it was handed on,
#: which is None if that is no longer known
_MARK = "_mutabot_handed"


class PassedCallable(Wrapper):
    """A callable that was passed on; if it is a partial, its calls count."""

    def __new__(cls, wrapped: Any, handed: Any) -> Any:
        """Return a wrapper; for a weak method, which takes an object first, a bound function."""
        if type(handed) is partial:
            return super().__new__(cls, wrapped, handed)  # type: ignore[call-arg]
        return MethodType(wrapped, handed)

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        return PassedCallable(copy.deepcopy(self.__wrapped__, known), self._self_wrapper)


class PassedCallables:
    """Decide which callables are passed on as operations, and watches the calls of mocks.

    Args:
        call_targets: decides what stands for an operation.
        given: takes where functions of the robot were handed on; None if that is no longer known.
    """

    def __init__(self, call_targets: CallTargets, given: dict[Adapter, CallPlace | None]) -> None:
        self._call_targets = call_targets
        self._given = given
        wrapt.register_post_import_hook(self._watch, "unittest.mock")

    def __call__(self, site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        """Return what is passed on at a site: ``found``, or an equal callable."""
        if not callable(found) or isinstance(found, type) or type(found) is PassedCallable:
            return found
        place = self._call_targets.place(site, frame)
        function = unbound(found)
        if type(function) in WRAPPERS:
            adapters, handler = self._call_targets.adapters, function._self_wrapper
            own = next((candidate for candidate in adapters if candidate.handler is handler), None)
            if own is None:
                return found
            self._call_targets.stood[place[0]] = own.operation.target
            if type(found) is Wrapper:  # all names of a function mean this very object
                known = self._given.setdefault(own, place)
                if known == place or not site.is_given:
                    self._given[own] = place if known == place else None
                    return found
            plain = function.__wrapped__
            if function is not found:
                plain = MethodType(plain, found.__self__)
            return self._wrapped(own, place, receiver, found, plain)
        adapter = self._call_targets.candidate(site, found, receiver, frame)
        if adapter is None:
            return found
        if self._call_targets.noted is not None:
            self._call_targets.noted.note(site, adapter.operation, found, receiver)
        mock = mock_of(found)
        if mock is not None:
            known = vars(mock).get(_MARK, (adapter, _weakly(receiver), place))
            if known[2] == place or not site.is_given:
                vars(mock)[_MARK] = (*known[:2], place if known[2] == place else None)
                return found
        return self._wrapped(adapter, place, receiver, found, found)

    def _wrapped(
        self, adapter: Adapter, place: CallPlace, receiver: Any, looks: Any, found: Any
    ) -> PassedCallable:
        """Return a wrapper that looks like ``looks`` and calls ``found`` as an operation."""
        calls = partial(self._call, adapter, place, receiver, found)
        says_it_is_one = mock_of(looks) is looks and isinstance(looks, WRAPPERS)
        # such a mock was made after a wrapped function. wrapt would ask it how it binds, which it refuses to
        # say, and then no wrapper can be made on Python 3.13: so wrapt first sees another callable
        made: PassedCallable = PassedCallable(calls if says_it_is_one else looks, calls)
        if says_it_is_one:
            made.__wrapped__ = looks
        return made

    def _call(
        self,
        adapter: Adapter,
        place: CallPlace,
        receiver: Any,
        found: Any,
        wrapped: Any,
        instance: Any,
        *given: Any,
    ) -> Any:
        __tracebackhide__ = True
        args, kwargs = given
        function = unbound(found)
        is_others = type(function) is FunctionType and getattr(found, "__self__", None) is not instance
        # it was made a method, or is one, maybe of a copy of its object
        if instance is not None and (receiver is NOTHING or is_others):
            receiver, found = instance, MethodType(function, instance) if is_others else wrapped
        where = {"handed": place, "frame": _getframe(1), "stands_in": self._call_targets.stands_in(found)}
        return self._call_targets.call(adapter, where, found, receiver, *args, **kwargs)

    def _watch(self, mock: ModuleType) -> None:
        """Watch the calls of all mocks."""
        kind: Any = mock.CallableMixin
        original = kind.__call__

        def call(self: Any, /, *args: Any, **kwargs: Any) -> Any:
            __tracebackhide__ = True
            return seen(original, self, _getframe(1), args, kwargs)

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
        if mark is None and name not in self._call_targets.by_name:
            return original(mock, *args, **kwargs)
        caller = _caller(frame)
        if is_untracked() or (caller is not None and id(caller.f_code) in borders):  # the operation itself
            return original(mock, *args, **kwargs)
        if mark is not None:
            adapter, receiver, place = mark[0], mark[1](), mark[2]
        else:
            parent = own.get("_mock_new_parent")
            adapter, receiver, place = None, NOTHING if parent is None else parent, None
            if caller is not None and self._call_targets.locator.role(file_of(caller.f_code)) is not None:
                adapter = self._call_targets.named(name, mock, receiver, caller)
        is_property = is_mock(mock, "PropertyMock")
        if adapter is None or (is_property and bool(args) is not bool(adapter.operation.described)):
            return original(mock, *args, **kwargs)
        if place is None and mark is not None and self._call_targets.noted is not None:
            self._call_targets.noted.note_elsewhere(
                adapter.operation, self._call_targets.locator.locate(caller)
            )
        is_awaited = is_coroutine_function(mock)
        where = {"handed": place, "frame": caller, "is_awaited": is_awaited, "stands_in": True}
        return self._call_targets.call(adapter, where, partial(original, mock), receiver, *args, **kwargs)


def _weakly(receiver: Any) -> Callable[[], Any]:
    """Return a function that returns the object a mock was read from, without keeping it alive."""
    try:
        reference = weakref.ref(receiver)
    except TypeError:
        return lambda: receiver
    return lambda: NOTHING if (found := reference()) is None else found


def _caller(frame: FrameType | None) -> FrameType | None:
    """Return the frame that calls a mock, skipping frames of ``unittest.mock``."""
    while frame is not None and (
        frame.f_globals.get("__name__") == "unittest.mock" or "_checksig_" in frame.f_globals
    ):
        frame = frame.f_back
    return frame
