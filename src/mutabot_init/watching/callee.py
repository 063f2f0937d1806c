"""Describes called functions: the name in a vocabulary, the arguments and the documentation."""

from __future__ import annotations

import ast
import functools
import inspect
import os
import re
import sys
import sysconfig
import textwrap
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from mutabot.api.values import parse_signature, resolve
from mutabot_init.observations import ANY, Holder, WatchedCallable
from mutabot_init.watching.effects import only_computes
from mutabot_init.watching.returned import names_of_elements

#: what pybind11 writes for a default that is no literal, in front of each overload, and of arguments
_OBJECT, _OVERLOAD = re.compile(r"<[^<>]*>"), re.compile(r"^\s*\d+\. ", re.MULTILINE)
#: where installed libraries are
_LIBRARIES = tuple(os.path.realpath(sysconfig.get_path(name)) for name in ("stdlib", "purelib", "platlib"))
_UNNAMED, _NAMES = re.compile(r"\barg(\d+)\b"), re.compile(r"Parameter ``(\w+)``")


@dataclass(frozen=True)
class Callee:
    """A callable that the program uses.

    Attributes:
        target: as vocabularies name it.
        raw: the function itself, unbound; None if only a stand-in was seen.
        owner: its class, or None.
        file: where its text stands; empty for a native one.
        stands_in: whether a mock or a fake was called in its place.
        is_set: whether it is a property that is assigned.
    """

    target: str
    raw: Any
    owner: type | None
    file: str
    stands_in: bool = False
    is_set: bool = False

    @property
    def function(self) -> Any:
        """The function that is called in the end."""
        return self.raw.fset if self.is_set else _function(self.raw)

    @functools.cached_property
    def signature(self) -> inspect.Signature | None:
        """The parameters without ``self``; None if they are unknown."""
        return self._signature[0]

    @property
    def is_documented(self) -> bool:
        """Whether only a docstring documents the parameters, as pybind11's docstrings do."""
        return self._signature[1]

    @functools.cached_property
    def _signature(self) -> tuple[inspect.Signature | None, bool]:
        try:
            signature = inspect.signature(self.function)
        except (TypeError, ValueError):
            documented = self._documented()
            return documented, documented is not None
        parameters = list(signature.parameters.values())
        if self.owner is not None and not isinstance(self.raw, staticmethod):
            parameters = parameters[1:]
        return signature.replace(parameters=parameters), False

    def _documented(self) -> inspect.Signature | None:
        """Return the signature in a docstring; of several overloads, that with most arguments."""
        text = _OBJECT.sub("...", getattr(_function(self.raw), "__doc__", None) or "")
        name = self.target.rpartition(":")[2].rpartition(".")[2]
        found = []
        for part in _OVERLOAD.split(text):
            first = part.strip().partition("\n")[0].strip()
            if first.startswith(f"{name}("):
                names = dict(enumerate(_NAMES.findall(part)))
                named = _UNNAMED.sub(lambda match, names=names: names.get(int(match[1]), match[0]), first)
                with suppress(ValueError):
                    found.append(parse_signature(named.removeprefix(name).rstrip(":.")))
        telling = (signature for signature in found if not _takes_anything(signature))
        return max(telling, key=lambda signature: len(signature.parameters), default=None)


def class_name(kind: type) -> str:
    """Return ``module:Qualified.Name``, a class's name in vocabularies."""
    return f"{kind.__module__}:{kind.__qualname__}"


def _takes_anything(signature: inspect.Signature) -> bool:
    kinds = {parameter.kind for parameter in signature.parameters.values()}
    return {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD} <= kinds


def replaced_method(kind: type, name: str) -> Callee | None:
    """Return method ``name`` of the class that a mock or fake replaces, even if a patch hides the class."""
    owner = next((cls for cls in kind.__mro__ if name in vars(cls)), None)
    if owner is None or "<" in owner.__qualname__:
        return None
    raw = vars(owner)[name]
    return Callee(f"{class_name(owner)}.{name}", raw, owner, _file_of(raw), stands_in=True)


def method_of(value: Any, name: str) -> Callee | None:
    """Return the method or property ``name`` of an object, class or module; None if it has no name there."""
    if isinstance(value, ModuleType):
        return function_of(vars(value).get(name), f"{value.__name__}:{name}")
    if isinstance(value, super):
        parts: Any = value
        classes = type(parts.__self__).__mro__
        classes = classes[classes.index(parts.__thisclass__) + 1 :]
    elif isinstance(value, type):
        classes = value.__mro__
    else:
        attributes = getattr(value, "__dict__", {})
        if name in attributes:
            found = attributes[name]
            is_own = isinstance(found, MethodType) and found.__self__ is value
            # a method put in the place of another one, which has its name
            return function_of(found.__func__ if is_own and found.__name__ in attributes else found)
        classes = type(value).__mro__
    owner = next((cls for cls in classes if name in vars(cls)), None)
    if owner is None:
        return None
    return _nameable(f"{class_name(owner)}.{name}", vars(owner)[name], owner)


def any_method(name: str, seen: Callee | None = None) -> Callee:
    """Return a callee for method ``name`` of any object; its arguments are those of an observed one."""
    target = f"{ANY}.{name}"
    return (
        Callee(target, None, None, "", True) if seen is None else replace(seen, target=target, stands_in=True)
    )


def assigned_by(value: Any, name: str) -> Callee | None:
    """Return the property or ``__setitem__`` that an assignment to an object calls; None if there is none."""
    callee = method_of(type(value), name)
    if name == "__setitem__" or callee is None:
        return callee
    is_set = isinstance(callee.raw, property) and callee.raw.fset is not None
    return replace(callee, is_set=True) if is_set else None


def function_of(found: Any, spelt: str = "") -> Callee | None:
    """Return a function by the name it has where it is defined, or as the program writes it."""
    if isinstance(found, MethodType):
        return method_of(found.__self__, found.__name__)
    is_wrapper = "__wrapped__" in getattr(found, "__dict__", {})  # hasattr is true of all names of mock.call
    if not isinstance(found, FunctionType | BuiltinFunctionType) and not is_wrapper:
        return None
    holder = found.__self__ if isinstance(found, BuiltinFunctionType) else None
    is_bound = not isinstance(holder, ModuleType | None)
    if is_bound and not type(holder).__name__.startswith(("PyCapsule", "pybind11")):
        return None  # a method of a type written in C; those of pybind11 are bound to its own records
    names = [f"{found.__module__}:{getattr(found, '__qualname__', '')}", spelt]
    made = (_nameable(name, found, None) for name in names if name)
    return next((callee for callee in made if callee is not None), None)


def described(callee: Callee, *, of_tests: bool, own: bool) -> WatchedCallable:
    """Return a call with all that the callable's text and documentation say."""
    function, signature, owner = callee.function, callee.signature, callee.owner
    parameters = signature.parameters.values() if signature is not None else ()
    return WatchedCallable(
        callee.target,
        of_tests,
        own,
        doc=(inspect.getdoc(function) or "")[:3000] if function is not None else "",
        owner=owner.__name__ if owner is not None else "",
        owner_doc=(owner.__doc__ or "")[:1500] if owner is not None else "",
        is_property=isinstance(callee.raw, property | functools.cached_property),
        is_set=callee.is_set,
        is_managed=owner is not None and (hasattr(owner, "__exit__") or hasattr(owner, "__aexit__")),
        is_of_class=isinstance(callee.raw, classmethod | staticmethod),
        holder=_holder_of(owner, callee.file),
        only_computes=not callee.stands_in and only_computes(function, owner),
        signature=spell_signature(signature) if signature is not None else "",
        is_documented=callee.is_documented,
        annotations={
            parameter.name: _written(parameter.annotation)
            for parameter in parameters
            if parameter.name != "self"
        },
        returns=_written(signature.return_annotation) if signature is not None else "",
        returned=names_of_elements(function),
        raised=list(dict.fromkeys(_raised_by(function))),
        stands_in=callee.stands_in,
    )


def _holder_of(owner: type | None, file: str) -> Holder:
    """Return what the objects of a class are, whose function's text is in this file."""
    if owner is None:
        return Holder.ANYTHING
    parameters = getattr(owner, "__dataclass_params__", None)
    if issubclass(owner, Enum | BaseException | tuple) or (parameters is not None and parameters.frozen):
        return Holder.VALUE
    if issubclass(owner, str | list | dict | set) and file.startswith(_LIBRARIES):
        return Holder.CONTAINER
    is_data = parameters is not None or hasattr(owner, "__attrs_attrs__") or hasattr(owner, "model_fields")
    return Holder.DATA if is_data else Holder.ANYTHING


def _nameable(target: str, raw: Any, owner: type | None) -> Callee | None:
    """Return the callee if its name leads to it; else None."""
    module, _, qualname = target.partition(":")
    if module not in sys.modules or "<" in qualname or not qualname:
        return None
    try:
        _, _, found = resolve(sys.modules[module], qualname)
    except LookupError:
        return None
    if found is not raw:
        return None
    return Callee(target, raw, owner, _file_of(raw))


def _file_of(raw: Any) -> str:
    code = getattr(inspect.unwrap(_function(raw)), "__code__", None)
    return os.path.realpath(code.co_filename) if type(code) is CodeType else ""  # an AsyncMock has a mock


def _function(raw: Any) -> Any:
    if isinstance(raw, property):
        return raw.fget
    if isinstance(raw, functools.cached_property):
        return raw.func
    return raw.__func__ if isinstance(raw, classmethod | staticmethod) else raw


def _written(annotation: Any) -> str:
    """Return an annotation as written."""
    if annotation is inspect.Parameter.empty:
        return ""
    if isinstance(annotation, str):
        return annotation
    return annotation.__name__ if isinstance(annotation, type) else str(annotation).replace("typing.", "")


def _raised_by(function: Any) -> Iterator[str]:
    """Yield the exceptions that the function's text raises."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError, SystemError):  # as in ``effects``
        return
    names = getattr(function, "__globals__", {})
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and node.exc is not None:
            spelt = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            first, *rest = ast.unparse(spelt).split(".")
            raised = functools.reduce(lambda found, name: getattr(found, name, None), rest, names.get(first))
            if isinstance(raised, type) and issubclass(raised, BaseException):
                yield class_name(raised)


def spell_signature(signature: inspect.Signature) -> str:
    """Return the signature's text, without annotations. Defaults that are not literals are ``…``."""
    parameters = [
        parameter.replace(annotation=inspect.Parameter.empty, default=_spelt(parameter.default))
        for parameter in signature.parameters.values()
        if parameter.name not in ("self", "cls")
    ]
    return str(inspect.Signature(parameters))


class _UnknownDefault:
    """A default that is not a literal, printed as an ellipsis."""

    def __repr__(self) -> str:
        return "…"


def _spelt(default: Any) -> Any:
    if default is inspect.Parameter.empty:
        return default
    try:
        ast.literal_eval(repr(default))
    except Exception:  # a default may be any object
        return _UnknownDefault()
    return _UnknownDefault() if default is ... else default
