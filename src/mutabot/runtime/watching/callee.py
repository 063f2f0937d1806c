"""Who is called: the name by which a vocabulary would call it, and what it says about itself."""

from __future__ import annotations

import ast
import functools
import inspect
import os
import sys
import textwrap
import typing
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

from mutabot.model import ANY
from mutabot.model.path import class_name
from mutabot.runtime.targets.target import NotFoundError, resolve
from mutabot.runtime.watching.described import of_type


@dataclass(frozen=True)
class Callee:
    """A callable that the program uses.

    Attributes:
        target: as vocabularies name it.
        raw: the function itself, unbound.
        owner: its class, or None.
        file: where its text stands; empty for a native one.
    """

    target: str
    raw: Any
    owner: type | None
    file: str

    @property
    def signature(self) -> inspect.Signature | None:
        """Its arguments without ``self``; None if nothing tells them."""
        try:
            signature = inspect.signature(_function(self.raw))
        except (TypeError, ValueError):
            return None
        parameters = list(signature.parameters.values())
        if self.owner is not None and not isinstance(self.raw, staticmethod):
            parameters = parameters[1:]
        return signature.replace(parameters=parameters)


def method_of(value: Any, name: str) -> Callee | None:
    """The method or property ``name`` of an object, class or module; None if it has no name of its own."""
    if isinstance(value, ModuleType):
        found = vars(value).get(name)
        return function_of(found, f"{value.__name__}:{name}")
    if isinstance(value, super):
        parts: Any = value
        classes = type(parts.__self__).__mro__
        classes = classes[classes.index(parts.__thisclass__) + 1 :]
    elif isinstance(value, type):
        classes = value.__mro__
    else:
        if name in getattr(value, "__dict__", ()):
            return function_of(getattr(value, name))
        classes = type(value).__mro__
    owner = next((one for one in classes if name in vars(one)), None)
    if owner is None:
        return None
    return _nameable(f"{class_name(owner)}.{name}", vars(owner)[name], owner)


def any_method(name: str, seen: Callee | None = None) -> Callee:
    """The method ``name`` of whatever has it; its arguments are those of one that was seen."""
    target = f"{ANY}.{name}"
    return Callee(target, None, None, "") if seen is None else replace(seen, target=target)


def function_of(found: Any, spelt: str = "") -> Callee | None:
    """A function by the name it has where it is defined, or as it is spelt."""
    if isinstance(found, MethodType):
        return method_of(found.__self__, found.__name__)
    if not isinstance(found, FunctionType | BuiltinFunctionType) and not hasattr(found, "__wrapped__"):
        return None
    if isinstance(found, BuiltinFunctionType) and not isinstance(found.__self__, ModuleType | None):
        return None  # a method of a type written in C
    names = [f"{found.__module__}:{getattr(found, '__qualname__', '')}", spelt]
    made = (_nameable(name, found, None) for name in names if name)
    return next((callee for callee in made if callee is not None), None)


def facts(callee: Callee) -> dict[str, Any]:
    """All that the callable says about itself, for JSON."""
    function, signature = _function(callee.raw), callee.signature
    owner = callee.owner
    parameters = signature.parameters.values() if signature is not None else ()
    return {
        "target": callee.target,
        "file": callee.file,
        "line": getattr(getattr(function, "__code__", None), "co_firstlineno", 0),
        "owner": owner.__name__ if owner is not None else "",
        "doc": (inspect.getdoc(function) or "")[:1500] if function is not None else "",
        "owner_doc": (owner.__doc__ or "")[:1500] if owner is not None else "",
        "is_property": _is_property(callee.raw),
        "has_signature": signature is not None,
        "annotations": {one.name: _written(one.annotation) for one in parameters},
        "signature": _bare(signature),
        "returns": _written(signature.return_annotation) if signature is not None else "",
        "refusals": list(dict.fromkeys(_raised_by(function))),
        "problem": _problem(callee),
        "readings": list(_readings(owner)) if owner is not None else [],
    }


def _nameable(target: str, raw: Any, owner: type | None) -> Callee | None:
    """The callee, if its name leads to it."""
    module, _, qualname = target.partition(":")
    if module not in sys.modules or "<" in qualname or not qualname:
        return None
    try:
        _, _, found = resolve(sys.modules[module], qualname)
    except NotFoundError:
        return None
    if found is not raw:
        return None
    code = getattr(inspect.unwrap(_function(raw)), "__code__", None)
    file = os.path.realpath(code.co_filename) if code is not None else ""
    return Callee(target, raw, owner, file)


def _function(raw: Any) -> Any:
    if isinstance(raw, property):
        return raw.fget
    if isinstance(raw, functools.cached_property):
        return raw.func
    return raw.__func__ if isinstance(raw, classmethod | staticmethod) else raw


def _is_property(raw: Any) -> bool:
    return isinstance(raw, property | functools.cached_property)


def _bare(signature: inspect.Signature | None) -> str:
    """A signature without annotations; defaults that no vocabulary could hold are dots."""
    parameters = []
    for one in signature.parameters.values() if signature is not None else ():
        is_plain = one.default is one.empty or type(one.default) in (int, float, str, bool, type(None))
        default = one.default if is_plain else ...
        parameters.append(one.replace(annotation=one.empty, default=default))
    return str(inspect.Signature(parameters)).replace("Ellipsis", "…")


def _written(annotation: Any) -> str:
    """An annotation as it is written."""
    if annotation is inspect.Parameter.empty:
        return ""
    if isinstance(annotation, str):
        return annotation
    return annotation.__name__ if isinstance(annotation, type) else str(annotation).replace("typing.", "")


def _problem(callee: Callee) -> str:
    """Why its calls cannot be intercepted; empty if they can."""
    if callee.target.startswith(ANY):
        return ""
    module, _, qualname = callee.target.partition(":")
    owner, name, raw = resolve(sys.modules[module], qualname)
    try:
        setattr(owner, name, raw)  # what it is already: nothing changes
    except (AttributeError, TypeError):
        return "a method of a type written in C cannot be replaced: wrap it in a function of your own"
    return ""


def _raised_by(function: Any) -> Iterator[str]:
    """Exceptions that its text raises."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError):
        return
    names = getattr(function, "__globals__", {})
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and node.exc is not None:
            raised = _named(node.exc.func if isinstance(node.exc, ast.Call) else node.exc, names)
            if isinstance(raised, type) and issubclass(raised, BaseException):
                yield class_name(raised)


def _named(node: ast.expr, names: dict[str, Any]) -> Any:
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.Attribute):
        return getattr(_named(node.value, names), node.attr, None)
    return None


def _readings(owner: type) -> Iterator[dict[str, Any]]:
    """Methods and properties of a class that take nothing and promise an answer."""
    for name, raw in vars(owner).items():
        function: Callable[..., Any] | None = _function(raw)
        if name.startswith("_") or not isinstance(function, FunctionType):
            continue
        callee = Callee(f"{class_name(owner)}.{name}", raw, owner, "")
        signature = callee.signature
        if signature is None or signature.parameters:
            continue
        try:
            promised = typing.get_type_hints(function).get("return")
        except Exception:  # a name in an annotation that does not exist while the program runs
            continue
        if promised not in (None, type(None)):
            leaves = [asdict(leaf) for leaf in of_type(promised)]
            yield {
                "target": callee.target,
                "line": function.__code__.co_firstlineno,
                "doc": (inspect.getdoc(function) or "")[:300],
                "returns": _written(signature.return_annotation),
                "is_property": _is_property(raw),
                "parts": leaves,
            }
