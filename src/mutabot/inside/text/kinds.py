"""Kinds of values: what an operator needs to know to keep to the right type."""

from __future__ import annotations

import enum
import numbers
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

from mutabot.model.class_name import class_name

_PLAIN: dict[type, str] = {
    bool: "truth",
    int: "integer",
    float: "number",
    complex: "number",
    str: "text",
    bytes: "text",
    set: "set",
    frozenset: "set",
    type(None): "none",
}
#: what stands for something else rather than for a value
_NO_VARIABLE = (ModuleType, FunctionType, BuiltinFunctionType, MethodType, type, type(None))
_ARRAYS = {"b": "truth", "i": "integer", "u": "integer", "f": "number", "c": "number"}


def kind_of(value: Any) -> str:
    """``number``, ``integer``, ``truth``, ``text``, ``set``, ``none``, or ``module:Type``.

    Looks at the type alone: what objects answer when they are asked may have effects.
    """
    kind = type(value)
    plain = _PLAIN.get(kind)
    if plain is not None:
        return plain
    if hasattr(kind, "dtype"):  # scalars and arrays of numpy
        return _ARRAYS.get(getattr(value.dtype, "kind", ""), "other")
    if issubclass(kind, enum.Flag):
        return "flag"
    if issubclass(kind, numbers.Integral):
        return "integer"
    if issubclass(kind, numbers.Number):
        return "number"
    return class_name(kind)


def is_variable(value: Any) -> bool:
    """Whether a name with this value is a variable, not a module, function or class."""
    return not issubclass(type(value), _NO_VARIABLE)
