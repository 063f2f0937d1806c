"""What stands in the place of an operation, and is copied and pickled as the operation is."""

from __future__ import annotations

import copy
from pkgutil import resolve_name
from types import MethodType, ModuleType
from typing import Any

import wrapt


class _Copied:
    """The copies of a wrapper: wrapt leaves them to subclasses."""

    __slots__ = ()  # attributes are those of what is wrapped: no annotations either

    def __copy__(self) -> Any:
        return self

    def __reduce_ex__(self, protocol: Any) -> Any:
        function: Any = self.__wrapped__  # type: ignore[attr-defined]
        owner = getattr(function, "__self__", None)
        if owner is None or isinstance(owner, ModuleType):
            return resolve_name, (f"{function.__module__}:{function.__qualname__}",)
        return getattr, (owner, function.__name__)


class BoundWrapper(_Copied, wrapt.BoundFunctionWrapper):  # type: ignore[type-arg]
    """A wrapped function as it is read from an object or a class."""

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        method: Any = self.__wrapped__
        if type(method) is not MethodType or isinstance(method.__self__, type):
            return self
        owner = copy.deepcopy(method.__self__, known)
        return self._self_parent.__get__(owner, type(owner))


class Wrapper(_Copied, wrapt.FunctionWrapper):  # type: ignore[type-arg]
    """A function, or what a class holds, whose calls a handler gets."""

    __bound_function_wrapper__ = BoundWrapper

    def __deepcopy__(self, known: dict[int, Any]) -> Any:
        return self


#: the types of what stands around functions, here and in code of others
WRAPPERS = (wrapt.FunctionWrapper, wrapt.BoundFunctionWrapper, Wrapper, BoundWrapper)
