"""Putting a handler around callables of the robot API, before or after they are imported.

A handler has wrapt's wrapper signature: ``handler(wrapped, instance, args, kwargs)``. Functions, methods,
class and static methods, async functions and properties can be wrapped. Where a module was already
imported, names that other modules, classes and default arguments took from it (``from x import f``) are
re-bound too; references kept in containers or closures are not found.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from types import FunctionType, ModuleType
from typing import Any

import wrapt

from .overrides import overriding, watch_subclasses

Handler = Callable[[Callable[..., Any], Any, tuple[Any, ...], dict[str, Any]], Any]
Undo = Callable[[], None]


class NotFoundError(LookupError):
    """A target names something that its module does not have.

    Attributes:
        name: the part that does not exist.
        known: names that exist in its place.
    """

    def __init__(self, message: str, name: str, known: tuple[str, ...]) -> None:
        super().__init__(message)
        self.name, self.known = name, known


class NotCallableError(TypeError):
    """A target names something that cannot be wrapped."""


@dataclass(slots=True)
class Interception:
    """Wrappers put in place, and how to take them away again.

    Attributes:
        pending: targets whose module has not been imported yet.
        found: wrapped original by target.
        on_error: told about targets that turn out wrong when their module is imported.
        owners: the class and the attribute's name of each target that is in a class.
        uncovered: overriding methods that cannot be intercepted, with the reason, by target.
    """

    on_error: Callable[[str, Exception], None]
    pending: set[str] = field(default_factory=set)
    found: dict[str, Any] = field(default_factory=dict)
    owners: dict[str, tuple[type, str]] = field(default_factory=dict)
    uncovered: dict[str, list[str]] = field(default_factory=dict)
    _targets: set[str] = field(default_factory=set)
    _covering: dict[str, Callable[[type], Handler]] = field(default_factory=dict)
    _undo: list[Undo] = field(default_factory=list)
    _wrappers: list[tuple[Any, Any]] = field(default_factory=list)
    _removed: bool = False

    def wrap(self, target: str, handler: Handler, overrides: Callable[[type], Handler] | None = None) -> None:
        """Wrap ``module:qualified.name`` now, or as soon as its module is imported.

        With ``overrides``, which makes their handlers, also the methods that override it, of classes that
        are there and of those that are still to be made.
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
            except (NotFoundError, NotCallableError) as error:
                self.on_error(target, error)

        wrapt.register_post_import_hook(imported, module_name)

    def look_for_subclasses(self) -> None:
        """Cover the classes whose making went unnoticed."""
        for target, overrides in self._covering.items():
            if target in self.owners:
                self.wrap_overriding(target, overrides)

    def wrap_overriding(self, target: str, overrides: Callable[[type], Handler]) -> None:
        """Wrap every method there is that overrides this target, which is in place, but those wrapped."""
        owner, name = self.owners[target]
        for kind in overriding(owner, name):
            self._wrap_own(target, kind, name, overrides)

    def _cover(self, target: str, overrides: Callable[[type], Handler]) -> None:
        if target not in self.owners:
            raise NotCallableError(f"{target} is no method, so nothing overrides it")
        owner, name = self.owners[target]
        self.wrap_overriding(target, overrides)
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
            why = f"{kind.__module__}:{kind.__qualname__}.{name} cannot be intercepted: {error}"
            if why not in self.uncovered.setdefault(target, []):
                self.uncovered[target].append(why)
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
            other = installed.get(id(place), f"{place.__module__}:{place.__qualname__}.{name}")
            if other in self._covering or (place is kind and other in self._targets):
                return False
        return True

    def remove(self) -> None:
        """Take all wrappers away, last one first. Hooks of modules not yet imported become idle."""
        self._removed = True
        while self._undo:
            self._undo.pop()()
        for original, wrapper in self._wrappers:
            for _ in _rebind(wrapper, original):  # names that were taken while the wrapper was in place
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
            raise NotCallableError(f"{target} cannot be intercepted: {error}") from error
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
            self._undo.extend(_rebind(original, wrapper))


def resolve(module: ModuleType, qualname: str) -> tuple[Any, str, Any]:
    """Owner, last name and raw attribute (descriptors unbound) of a qualified name in a module.

    Raises NotFoundError, naming the part that does not exist and what there is.
    """
    owner: Any = module
    *parents, name = qualname.split(".")
    for parent in parents:
        owner = _attribute(owner, parent, module)
    return owner, name, _attribute(owner, name, module)


def _attribute(owner: Any, name: str, module: ModuleType) -> Any:
    places = owner.__mro__ if isinstance(owner, type) else (owner,)
    for place in places:
        if name in vars(place):
            return vars(place)[name]
    try:
        return getattr(owner, name)  # a module may make its attributes on demand
    except AttributeError:
        known = tuple(key for key in dir(owner) if not key.startswith("_"))
        of = f"module {module.__name__}" if owner is module else f"{module.__name__}:{owner.__qualname__}"
        raise NotFoundError(f"{of} has no {name!r}", name, known) from None


def _wrapper(owner: Any, name: str, original: Any, handler: Handler) -> Any:
    if isinstance(original, property):
        return _wrapped_property(original, handler)
    if isinstance(original, functools.cached_property):
        cached = functools.cached_property(wrapt.FunctionWrapper(original.func, _as_getter(handler)))
        cached.__set_name__(owner, name)
        return cached
    if isinstance(original, type):
        raise NotCallableError(
            f"{original.__module__}:{original.__qualname__} is a class; name one of its methods"
        )
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


def _rebind(original: Any, wrapper: Any) -> Iterator[Undo]:
    """Put the wrapper wherever loaded modules, their classes or default arguments refer to the original."""
    if isinstance(original, property | classmethod | staticmethod | functools.cached_property):
        return
    for module in list(sys.modules.values()):
        if not isinstance(module, ModuleType) or module.__name__.startswith("mutabot"):
            continue
        for name, value in list(vars(module).items()):
            if value is original:
                setattr(module, name, wrapper)
                yield functools.partial(setattr, module, name, original)
            elif isinstance(value, FunctionType) and value.__module__ == module.__name__:
                yield from _rebind_defaults(value, original, wrapper)
            elif isinstance(value, type) and value.__module__ == module.__name__:
                yield from _rebind_class(value, original, wrapper)


def _rebind_class(owner: type, original: Any, wrapper: Any) -> Iterator[Undo]:
    for name, value in list(vars(owner).items()):
        if value is original:
            setattr(owner, name, wrapper)
            yield functools.partial(setattr, owner, name, original)
        elif isinstance(value, FunctionType):
            yield from _rebind_defaults(value, original, wrapper)


def _rebind_defaults(function: FunctionType, original: Any, wrapper: Any) -> Iterator[Undo]:
    keyword_only = function.__kwdefaults__ or {}
    for name in [name for name, value in keyword_only.items() if value is original]:
        keyword_only[name] = wrapper
        yield functools.partial(keyword_only.__setitem__, name, original)
    defaults = function.__defaults__
    if defaults and any(value is original for value in defaults):
        function.__defaults__ = tuple(wrapper if value is original else value for value in defaults)
        yield functools.partial(setattr, function, "__defaults__", defaults)


def is_named(error: BaseException, names: Iterable[str]) -> bool:
    """Whether one of the names ``module:Name`` means the exception's class, re-exported names included."""
    kinds = type(error).__mro__
    return any(f"{kind.__module__}:{kind.__qualname__}" in names for kind in kinds) or any(
        named_class(name) in kinds for name in names
    )


def named_class(name: str) -> Any:
    """What ``module:qualified.name`` is now; None if its module is not loaded or has no such name."""
    module, _, qualname = name.partition(":")
    if module not in sys.modules:
        return None
    try:
        owner, attribute, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, attribute)
    except (NotFoundError, AttributeError):
        return None
