"""What ``module:qualified.name`` names in the running program."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from types import ModuleType
from typing import Any

from mutabot.model.class_name import class_name


class NotFoundError(LookupError):
    """A target names something that its module does not have.

    Attributes:
        name: the part that does not exist.
        known: names that exist in its place.
    """

    def __init__(self, message: str, name: str, known: tuple[str, ...]) -> None:
        super().__init__(message)
        self.name, self.known = name, known


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
        of = f"module {module.__name__}" if owner is module else f"{module.__name__}:{_called(owner)}"
        raise NotFoundError(f"{of} has no {name!r}", name, known) from None


def _called(owner: Any) -> str:
    return str(getattr(owner, "__qualname__", type(owner).__qualname__))  # a mock of a class has no name


def is_named(error: BaseException, names: Iterable[str]) -> bool:
    """Whether one of the names ``module:Name`` means the exception's class, re-exported names included."""
    kinds = type(error).__mro__
    return any(class_name(kind) in names for kind in kinds) or any(
        named_class(name) in kinds for name in names
    )


def named_class(name: str) -> Any:
    """What ``module:qualified.name`` is now; None if its module is not loaded or has no such name.

    A test may have put anything in its place, also nothing: ``sys.modules["robot"] = None``.
    """
    module, _, qualname = name.partition(":")
    if module not in sys.modules:
        return None
    try:
        owner, attribute, _ = resolve(sys.modules[module], qualname)
        return getattr(owner, attribute)
    except Exception:
        return None
