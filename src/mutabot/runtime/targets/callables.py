"""Targets that are Python callables, ``module:qualified.name``: wrapped before or after they are imported.

Functions, async functions, properties and methods of all kinds can be wrapped: of an object, of the class,
static, and those that ``functools`` makes. Where a module was already imported, names that other modules took
from it (``from x import f``) are re-bound too; other references to it are not found.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from itertools import repeat
from operator import is_
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

import wrapt

from mutabot.model.path import class_name
from mutabot.model.signature import parse_signature, signature_of, takes_anything
from mutabot.runtime.targets.target import Finding, Handler, NotFoundError, OnFinding, resolve
from mutabot.runtime.targets.wrapper import Method, Wrapper

if TYPE_CHECKING:
    from mutabot.model import Operation

_SET = "is a property: its arguments are those of assignments, which return nothing; describe one of the two"
_NOT_SET = "is a property that cannot be set; describe its result"
#: what stands in a class and can be called once it was read from there
_BOUND_ONLY = (classmethod, staticmethod, functools.partialmethod, functools.singledispatchmethod)


def look_at(operation: Operation, original: Any) -> Iterator[Finding]:
    """Yield findings about the described arguments of an operation.

    Args:
        operation: what the vocabulary says.
        original: the callable that its target names, as it is kept in its class or module.
    """
    callable = getattr(original, "__func__", original)
    described = operation.described
    if isinstance(original, property | functools.cached_property):
        callable = getattr(original, "fset", None)
        if callable is None or not described:
            for key in described.values():
                yield Finding(key, f"{operation.target} {_NOT_SET}")
            return
        if operation.result:
            yield Finding("result", f"{operation.target} {_SET}")
    signature = signature_of(callable)
    if operation.signature is not None:
        signature = parse_signature(operation.signature)
    elif signature is None or takes_anything(signature):
        unnamed = [root for root in described if signature is None or root not in signature.parameters]
        if unnamed:
            yield Finding("signature", _advice(operation, signature is None), is_remark=True)
        return
    if any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in signature.parameters.values()):
        return
    known = tuple(name for name in signature.parameters if name not in ("self", "cls"))
    for root, key in described.items():
        if root not in signature.parameters:
            yield Finding(key, f"{operation.target} has no argument {root!r}", root, known)


def _advice(operation: Operation, is_native: bool) -> str:
    if is_native:
        why = f"{operation.target} is native and has no signature"
    else:
        why = f"{operation.target} is wrapped in (*args, **kwargs), which hides its arguments"
    proposal = f'write signature = "({", ".join(operation.described)}, …)", with all names in their order'
    return f"{why}: only those that a call gives by keyword can be distinguished; {proposal}"


class NotCallableError(TypeError):
    """A target is nothing that can be wrapped."""


class Callables:
    """The wrappers of operations that are callables.

    Args:
        on_finding: called for a target that turns out wrong when it is found.

    Attributes:
        pending: targets whose module has not been imported yet.
        found: wrapped original by target.
        owners: the class and the attribute's name of each target that is in a class.
    """

    def __init__(self, on_finding: OnFinding) -> None:
        self._on_finding = on_finding
        self.pending: set[str] = set()
        self.found: dict[str, Any] = {}
        self.owners: dict[str, type] = {}

    def wrap(self, target: str, handler: Handler, *, is_set: bool = False) -> None:
        """Wrap a callable now, or as soon as its module is imported.

        Args:
            target: the callable.
            handler: what stands around it.
            is_set: whether of a property the assignments are meant, rather than the readings.
        """
        module_name, _, qualname = target.partition(":")
        self.pending.add(target)
        late = module_name in sys.modules

        def imported(module: ModuleType) -> None:
            self.pending.discard(target)
            try:
                self._install(target, module, qualname, handler, late=late, is_set=is_set)
            except NotFoundError as error:
                self._on_finding(target, Finding("call", str(error), error.name, error.known))
            except NotCallableError as error:
                self._on_finding(target, Finding("call", str(error)))
            except Exception as error:  # descriptors and metaclasses of the user's may do anything
                self._on_finding(target, Finding("call", f"{target} cannot be intercepted: {error!r}"))

        wrapt.register_post_import_hook(imported, module_name)

    def here(self) -> Iterable[str]:
        """Return the targets whose modules were imported."""
        return self.found.keys()

    def found_elsewhere(self, targets: Iterable[str]) -> None:
        """Forget targets that other processes have found, as their modules may not be importable here."""
        self.pending.difference_update(targets)

    def seek(self) -> Iterator[tuple[str, Finding]]:
        """Import the modules that are not imported yet, so that every target is checked."""
        for target in sorted(self.pending):
            module = target.partition(":")[0]
            try:
                import_module(module)
            except Exception as error:  # the user's module may fail in any way; say which and how
                yield target, not_imported(module, error)

    def check(self, operation: Operation) -> Iterator[Finding]:
        """Return what of the described arguments does not fit the callable."""
        original = self.found.get(operation.target)
        return look_at(operation, original) if original is not None else iter(())

    def _install(
        self, target: str, module: ModuleType, qualname: str, handler: Handler, *, late: bool, is_set: bool
    ) -> None:
        owner, name, original = resolve(module, qualname)
        wrapper = _wrapper(owner, name, original, handler, is_set=is_set)
        try:
            setattr(owner, name, wrapper)
        except (AttributeError, TypeError) as error:
            if not isinstance(owner, type):
                raise NotCallableError(f"{target} cannot be intercepted: {error}") from error
            self.found[target], self.owners[target] = original, owner
            text = f"{target} cannot be wrapped ({error}): only calls that are written as such are seen"
            self._on_finding(target, Finding("call", text, is_remark=True))
            return
        self.found[target] = original
        if isinstance(owner, type):
            self.owners[target] = owner
        if late:
            _rebind(original, wrapper)


def not_imported(module: str, error: Exception, key: str = "call") -> Finding:
    """Return the finding for a module that cannot be imported."""
    return Finding(key, f"module {module!r} cannot be imported: {error!r}", module)


def _wrapper(owner: Any, name: str, original: Any, handler: Handler, *, is_set: bool) -> Any:
    if isinstance(original, property):
        if is_set and original.fset is not None:
            return original.setter(wrapt.FunctionWrapper(original.fset, _of_property(handler)))
        if original.fget is None:
            raise NotCallableError("it is a property that cannot be read")
        return original.getter(wrapt.FunctionWrapper(original.fget, _of_property(handler)))
    if isinstance(original, functools.cached_property):
        cached = functools.cached_property(wrapt.FunctionWrapper(original.func, _of_property(handler)))
        cached.__set_name__(owner, name)
        return cached
    if isinstance(original, type):
        raise NotCallableError(f"{class_name(original)} is a class; name one of its methods")
    if not callable(original) and not isinstance(original, _BOUND_ONLY):
        raise NotCallableError(f"{name!r} is {type(original).__name__}, which cannot be called")
    if isinstance(owner, type):  # what Python binds, it goes on to bind
        if type(original) is FunctionType:
            return Method(original, handler)
        if type(original) is classmethod and type(original.__func__) is FunctionType:
            return classmethod(Method(original.__func__, handler))
        if type(original) is staticmethod and type(original.__func__) is FunctionType:
            return staticmethod(Wrapper(original.__func__, handler))
    return Wrapper(original, handler)


def _of_property(handler: Handler) -> Handler:
    """Return a handler for a property, which calls plain functions, while handlers expect bound methods."""

    def call(
        wrapped: Callable[..., Any], instance: Any, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> Any:
        __tracebackhide__ = True
        return handler(functools.partial(wrapped, args[0]), args[0], args[1:], {})

    return call


def _rebind(original: Any, wrapper: Any) -> None:
    """Put the wrapper wherever names of modules denote the original."""
    if isinstance(original, property | classmethod | staticmethod | functools.cached_property):
        return
    for module in list(sys.modules.values()):
        if not isinstance(module, ModuleType) or module.__name__.startswith("mutabot"):
            continue
        names = vars(module)
        # a process may have hundreds of thousands of names
        if any(map(is_, list(names.values()), repeat(original))):
            for name in [name for name, value in list(names.items()) if value is original]:
                setattr(module, name, wrapper)
