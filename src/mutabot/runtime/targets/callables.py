"""Targets that are Python callables, ``module:qualified.name``: wrapped before or after they are imported.

Functions, methods, class and static methods, async functions and properties can be wrapped. Where a
module was already imported, names that other modules, classes and default arguments took from it (``from
x import f``) are re-bound too; references kept in containers or closures are not found.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from importlib import import_module
from types import FunctionType, ModuleType
from typing import Any

import wrapt

from mutabot.model import Operation
from mutabot.model.path import class_name
from mutabot.model.signature import (
    described_in,
    parse_signature,
    signature_of,
    spell_signature,
    takes_anything,
)
from mutabot.runtime.targets.target import Finding, Handler, NotFoundError, Targets, Tell, resolve

_ONLY_READ = "only its reading is seen; describe the method that its setter calls"
#: how deep decorators are looked into for the function that they wrap
_DEPTH = 5


def look_at(operation: Operation, original: Any) -> Iterator[Finding]:
    """What is to be said about the described arguments of an operation.

    Args:
        operation: what the vocabulary says.
        original: the callable that its target names, as it is kept in its class or module.
    """
    callable = getattr(original, "__func__", original)
    described = operation.described
    if isinstance(original, property | functools.cached_property):
        for key in described.values():
            yield Finding(key, f"{operation.target} is a property: {_ONLY_READ}")
        return
    signature = signature_of(callable)
    if operation.signature is not None:
        signature = parse_signature(operation.signature)
    elif signature is None or takes_anything(signature):
        unnamed = [root for root in described if signature is None or root not in signature.parameters]
        if unnamed:
            yield Finding("signature", _advice(operation, callable, signature is None), is_remark=True)
        return
    if any(one.kind is inspect.Parameter.VAR_KEYWORD for one in signature.parameters.values()):
        return
    known = tuple(name for name in signature.parameters if name not in ("self", "cls"))
    for root, key in described.items():
        if root not in signature.parameters:
            yield Finding(key, f"{operation.target} has no argument {root!r}", root, known)


def _advice(operation: Operation, callable: Any, is_native: bool) -> str:
    name = operation.name.rpartition(".")[2]
    if is_native:
        why = f"{operation.target} is native and does not tell its arguments"
        found = described_in(getattr(callable, "__doc__", None), name)
    else:
        why = f"{operation.target} is wrapped in (*args, **kwargs), which does not tell its arguments"
        found = _wrapped_in(callable, name, _DEPTH)
    proposal = spell_signature(found) if found is not None else f"({', '.join(operation.described)}, …)"
    order = "" if found is not None else ", with all names in their order"
    return (
        f"{why}: only those that a call gives by keyword can be told apart; "
        f'write signature = "{proposal}"{order}'
    )


def _wrapped_in(function: Any, name: str, depth: int) -> inspect.Signature | None:
    """The signature of the function of this name that a decorator keeps in its closure."""
    for cell in getattr(function, "__closure__", None) or ():
        try:
            content = cell.cell_contents
        except ValueError:  # not filled yet
            continue
        if not inspect.isfunction(content):
            continue
        found = signature_of(content) if content.__name__ == name else None
        if found is None and depth:
            found = _wrapped_in(content, name, depth - 1)
        if found is not None and not takes_anything(found):
            return found
    return None


Undo = Callable[[], None]
_MAKING = "__init_subclass__"


class NotCallableError(TypeError):
    """A target names something that cannot be wrapped."""


class Callables(Targets):
    """Wrappers put in place, and how to take them away again.

    Attributes:
        pending: targets whose module has not been imported yet.
        found: wrapped original by target.
        owners: the class and the attribute's name of each target that is in a class.
    """

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self.pending: set[str] = set()
        self.found: dict[str, Any] = {}
        self.owners: dict[str, tuple[type, str]] = {}
        self._targets: set[str] = set()
        self._covering: dict[str, Callable[[type], Handler]] = {}
        self._uncovered: dict[str, list[str]] = {}
        self._undo: list[Undo] = []
        self._wrappers: list[tuple[Any, Any]] = []
        self._removed = False
        self._before = set(sys.modules)

    def wrap(self, target: str, handler: Handler, overrides: Callable[[type], Handler] | None = None) -> None:
        """Wrap a callable now, or as soon as its module is imported.

        With ``overrides`` also the methods that override it, of classes that are there and of those that are
        still to be made.
        """
        module_name, _, qualname = target.partition(":")
        self.pending.add(target)
        self._targets.add(target)
        if overrides is not None:
            self._covering[target] = overrides
        late = module_name in sys.modules

        def imported(module: ModuleType) -> None:
            if self._removed:
                return
            self.pending.discard(target)
            try:
                self._install(target, module, qualname, handler, late=late)
                if overrides is not None:
                    self._cover(target, overrides)
            except NotFoundError as error:
                self._tell(target, Finding("call", str(error), error.name, error.known))
            except NotCallableError as error:
                self._tell(target, Finding("call", str(error)))
            except Exception as error:  # descriptors and metaclasses of the user's may do anything
                self._tell(target, Finding("call", f"{target} cannot be intercepted: {error!r}"))

        wrapt.register_post_import_hook(imported, module_name)

    def look_again(self) -> None:
        """Cover the classes whose making went unnoticed."""
        for target, overrides in self._covering.items():
            if target in self.owners:
                self._wrap_overriding(target, overrides)

    def here(self) -> Iterable[str]:
        """The targets whose modules were imported."""
        return self.found.keys()

    def found_elsewhere(self, targets: Iterable[str]) -> None:
        """Their modules may not even be importable here."""
        self.pending.difference_update(targets)

    def uncovered(self, target: str) -> list[str]:
        """Overriding methods that cannot be wrapped, with the reason."""
        return self._uncovered.get(target, [])

    def seek(self) -> Iterator[tuple[str, Finding]]:
        """Import what nobody imported, so that every target is looked at."""
        for target in sorted(self.pending):
            module = target.partition(":")[0]
            try:
                import_module(module)
            except Exception as error:  # the user's module may fail in any way; say which and how
                yield target, not_imported(module, error)

    def check(self, operation: Operation) -> Iterator[Finding]:
        """What of the described arguments does not fit the callable."""
        original = self.found.get(operation.target)
        return look_at(operation, original) if original is not None else iter(())

    def _wrap_overriding(self, target: str, overrides: Callable[[type], Handler]) -> None:
        owner, name = self.owners[target]
        for kind in overriding(owner, name):
            self._wrap_own(target, kind, name, overrides)

    def _cover(self, target: str, overrides: Callable[[type], Handler]) -> None:
        if target not in self.owners:
            raise NotCallableError(f"{target} is no method, so nothing overrides it")
        owner, name = self.owners[target]
        self._wrap_overriding(target, overrides)
        self._undo.append(watch_subclasses(owner, lambda kind: self._wrap_own(target, kind, name, overrides)))

    def _wrap_own(self, target: str, kind: type, name: str, overrides: Callable[[type], Handler]) -> None:
        original = vars(kind).get(name)
        is_wrapped = any(original is wrapper for _, wrapper in self._wrappers)
        if original is None or is_wrapped or not self._is_nearest(target, kind):
            return
        try:
            wrapper = _wrapper(kind, name, original, overrides(kind))
            setattr(kind, name, wrapper)
        except (NotCallableError, AttributeError, TypeError) as error:
            why = f"{class_name(kind)}.{name} cannot be intercepted: {error}"
            if why not in self._uncovered.setdefault(target, []):
                self._uncovered[target].append(why)
            return
        self._undo.append(functools.partial(setattr, kind, name, original))
        self._wrappers.append((original, wrapper))

    def _is_nearest(self, target: str, kind: type) -> bool:
        """Whether no other target covers the class that is nearer to it, nor names its method itself."""
        owner, name = self.owners[target]
        installed = {id(place): other for other, (place, same) in self.owners.items() if same == name}
        for place in kind.__mro__:
            if place is owner:
                break
            other = installed.get(id(place), f"{class_name(place)}.{name}")
            if other in self._covering or (place is kind and other in self._targets):
                return False
        return True

    def remove(self) -> None:
        """Take all wrappers away, last one first. Hooks of modules not yet imported become idle."""
        self._removed = True
        while self._undo:
            with suppress(AttributeError, TypeError):  # a test has taken it away itself, or made it read-only
                self._undo.pop()()
        loaded = [module for name, module in list(sys.modules.items()) if name not in self._before]
        for original, wrapper in self._wrappers:
            for _ in _rebind(loaded, wrapper, original):  # names that were taken while it was in place
                pass

    def _install(
        self, target: str, module: ModuleType, qualname: str, handler: Handler, *, late: bool
    ) -> None:
        owner, name, original = resolve(module, qualname)
        wrapper = _wrapper(owner, name, original, handler)
        own = name in vars(owner)
        try:
            setattr(owner, name, wrapper)
        except (AttributeError, TypeError) as error:
            if not isinstance(owner, type):
                raise NotCallableError(f"{target} cannot be intercepted: {error}") from error
            self.found[target], self.owners[target] = original, (owner, name)
            text = f"{target} cannot be wrapped ({error}): only calls that are written as such are seen"
            self._tell(target, Finding("call", text, is_remark=True))
            return
        self._undo.append(
            functools.partial(setattr, owner, name, original)
            if own
            else functools.partial(delattr, owner, name)
        )
        self.found[target] = original
        if isinstance(owner, type):
            self.owners[target] = (owner, name)
        self._wrappers.append((original, wrapper))
        if late:
            self._undo.extend(_rebind(list(sys.modules.values()), original, wrapper))


def not_imported(module: str, error: Exception, key: str = "call") -> Finding:
    """What is said of a module that cannot be imported."""
    return Finding(key, f"module {module!r} cannot be imported: {error!r}", module)


def _wrapper(owner: Any, name: str, original: Any, handler: Handler) -> Any:
    if isinstance(original, property):
        return _wrapped_property(original, handler)
    if isinstance(original, functools.cached_property):
        cached = functools.cached_property(wrapt.FunctionWrapper(original.func, _as_getter(handler)))
        cached.__set_name__(owner, name)
        return cached
    if isinstance(original, type):
        raise NotCallableError(f"{class_name(original)} is a class; name one of its methods")
    if not callable(original) and not isinstance(original, classmethod | staticmethod):
        raise NotCallableError(f"{name!r} is {type(original).__name__}, which cannot be called")
    return wrapt.FunctionWrapper(original, handler)


def _wrapped_property(original: property, handler: Handler) -> property:
    if original.fget is None:
        raise NotCallableError("it is a property that cannot be read")
    getter = wrapt.FunctionWrapper(original.fget, _as_getter(handler))
    return property(getter, original.fset, original.fdel, original.__doc__)


def _as_getter(handler: Handler) -> Handler:
    """A property's getter is called as a plain function of the instance; handlers expect a bound method."""

    def get(wrapped: Callable[..., Any], instance: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
        return handler(functools.partial(wrapped, *args), args[0], (), {})

    return get


def _rebind(modules: Iterable[Any], original: Any, wrapper: Any) -> Iterator[Undo]:
    """Put the wrapper wherever the modules, their classes or default arguments refer to the original."""
    if isinstance(original, property | classmethod | staticmethod | functools.cached_property):
        return
    for module in modules:
        if not isinstance(module, ModuleType) or module.__name__.startswith("mutabot"):
            continue
        for name, value in list(vars(module).items()):
            if value is original:
                setattr(module, name, wrapper)
                yield functools.partial(setattr, module, name, original)
            elif isinstance(value, FunctionType):
                if value.__module__ == module.__name__ and _has_defaults(value):
                    yield from _rebind_defaults(value, original, wrapper)
            elif isinstance(value, type) and value.__module__ == module.__name__:
                yield from _rebind_class(value, original, wrapper)


def _rebind_class(owner: type, original: Any, wrapper: Any) -> Iterator[Undo]:
    for name, value in list(vars(owner).items()):
        if value is original:
            setattr(owner, name, wrapper)
            yield functools.partial(setattr, owner, name, original)
        elif isinstance(value, FunctionType) and _has_defaults(value):
            yield from _rebind_defaults(value, original, wrapper)


def _has_defaults(function: FunctionType) -> bool:
    return bool(function.__defaults__ or function.__kwdefaults__)


def _rebind_defaults(function: FunctionType, original: Any, wrapper: Any) -> Iterator[Undo]:
    keyword_only = function.__kwdefaults__ or {}
    for name in [name for name, value in keyword_only.items() if value is original]:
        keyword_only[name] = wrapper
        yield functools.partial(keyword_only.__setitem__, name, original)
    defaults = function.__defaults__
    if defaults and any(value is original for value in defaults):
        function.__defaults__ = tuple(wrapper if value is original else value for value in defaults)
        yield functools.partial(setattr, function, "__defaults__", defaults)


def overriding(owner: type, name: str) -> Iterator[type]:
    """The classes below ``owner`` that define ``name`` themselves."""
    waiting: list[type] = list(reversed(type.__subclasses__(owner)))
    seen: set[int] = set()
    while waiting:
        kind = waiting.pop()
        if id(kind) in seen:
            continue
        seen.add(id(kind))
        waiting.extend(reversed(type.__subclasses__(kind)))
        if vars(kind).get(name) is not None:
            yield kind


def watch_subclasses(owner: type, notice: Callable[[type], None]) -> Callable[[], None]:
    """Be told of every class that is made below ``owner`` from now on; returns how to end that.

    A class whose ``__init_subclass__`` does not call that of its bases is not told.
    """
    own = vars(owner).get(_MAKING)
    base: Any = owner

    def init_subclass(cls: Any, /, **options: Any) -> None:
        if own is not None:
            own.__get__(None, cls)(**options)
        else:
            super(base, cls).__init_subclass__(**options)
        notice(cls)

    setattr(owner, _MAKING, classmethod(init_subclass))

    def end() -> None:
        if own is not None:
            setattr(owner, _MAKING, own)
        else:
            delattr(owner, _MAKING)

    return end


#: what this file is, to ``interception``
KIND = Callables
