"""What stands in the place of an operation, and is shown, copied and pickled as the operation is."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pkgutil import resolve_name
from types import FunctionType, MethodType, ModuleType
from typing import Any, cast

import wrapt


class _Alike:
    """The text and the copies of a wrapper: wrapt leaves copies to subclasses, and shows wrappers."""

    __slots__ = ()  # attributes are those of what is wrapped: no annotations either

    def __repr__(self) -> str:
        return repr(self.__wrapped__)  # type: ignore[attr-defined]

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        return self

    def __reduce_ex__(self, protocol: Any) -> Any:
        function: Any = self.__wrapped__  # type: ignore[attr-defined]
        owner = getattr(function, "__self__", None)
        if owner is None or isinstance(owner, ModuleType):
            return resolve_name, (f"{function.__module__}:{function.__qualname__}",)
        return getattr, (owner, function.__name__)


class BoundWrapper(_Alike, wrapt.BoundFunctionWrapper):  # type: ignore[type-arg]
    """A wrapped function as it is read from an object or a class."""

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        method: Any = self.__wrapped__
        if type(method) is not MethodType or isinstance(method.__self__, type):
            return self
        owner = copy.deepcopy(method.__self__, known)
        return self._self_parent.__get__(owner, type(owner))


class Method(_Alike, wrapt.BoundFunctionWrapper):  # type: ignore[type-arg]
    """A function of a class, whose calls a handler gets with the object as their instance.

    Python binds it as it binds the function: what is read from an object is a method, equal to the next one.
    """

    def __new__(cls, function: FunctionType, handler: Any) -> Any:
        return super().__new__(cls, function, handler)  # type: ignore[call-arg]

    def __init__(self, function: FunctionType, handler: Any) -> None:
        # unbound, for objects of any class: the caller gives the object first
        super().__init__(function, None, handler, None, "function", None, object)  # type: ignore[call-arg]

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        return self if instance is None else MethodType(self, instance)


class Wrapper(_Alike, wrapt.FunctionWrapper):  # type: ignore[type-arg]
    """A function, or what a class holds, whose calls a handler gets."""

    __bound_function_wrapper__ = BoundWrapper


#: the types of what stands around functions, here and in code of others
WRAPPERS = (wrapt.FunctionWrapper, wrapt.BoundFunctionWrapper, Wrapper, BoundWrapper, Method)


def unbound(found: Any) -> Any:
    """Return the function of a method; anything else is returned as it is."""
    return found.__func__ if type(found) is MethodType else found


def bound(wrapped: Callable[..., Any], instance: Any) -> Callable[..., Any]:
    """Return what a handler got as a method of the instance, if it was a function called with the object."""
    if instance is None or not isinstance(wrapped, wrapt.PartialCallableObjectProxy):
        return wrapped
    function = getattr(wrapped, "__wrapped__")  # noqa: B009  # its stubs do not name it
    bind = getattr(type(function), "__get__", None)
    return wrapped if bind is None else cast("Callable[..., Any]", bind(function, instance, type(instance)))
