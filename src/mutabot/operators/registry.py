"""Finding operators on calls by name: the built-in ones by their files, and those that packages bring."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from mutabot.errors import ExtensionError, OperatorError, unknown_name_text
from mutabot.extensions import Part, brought

from .control import CONTROLS
from .operator import Operator
from .rule import in_order

_HERE = Path(__file__).parent


def built_in() -> list[str]:
    """Names of mutabot's own operators that make mutants, in the order of the documentation."""
    return [rule.name for rule in in_order(operator(name) for name in _files())]


def names() -> list[str]:
    """Names of all operators that make mutants, built-in ones first.

    Raises OperatorError or ExtensionError when two operators want the same name: it would not be clear whose
    mutants are whose.
    """
    found = built_in()
    own = {*found, *CONTROLS}
    for part in brought("operators").values():
        if part.name in own:
            text = f"operator {part.name!r} of package {part.owner!r} has the name of one of 'mutabot'"
            raise OperatorError(text, operator=part.name)
        found.append(part.name)
    return found


def load_all() -> list[Operator]:
    """All operators that make mutants. Raises OperatorError for one of a package that is of no use."""
    return [operator(name) for name in names()]


def preload(wanted: Iterable[str] | None = None) -> None:
    """Load these operators, or all built-in ones; who needs one that cannot be loaded is told then."""
    for name in _files() if wanted is None else wanted:
        with suppress(OperatorError):
            operator(name)


@cache
def operator(name: str) -> Operator:
    """The operator of this name.

    Raises OperatorError if there is none, or if one does not keep the contract.
    """
    if name in CONTROLS:
        return CONTROLS[name]()
    if name in _files():
        return _of_file(name, _files()[name])
    part = brought("operators").get(name)
    if part is not None:
        return _loaded(part)
    raise OperatorError(unknown_name_text("operator", name, names()), operator=name)


@cache
def _files() -> dict[str, str]:
    """Module by name of operator, as the folders beside this file tell: nothing is loaded for it."""
    return {
        module.replace("_", "-"): ".".join((__package__, *folder.relative_to(_HERE).parts, module))
        for folder in folders_in(_HERE)
        for module in modules_in(folder)
    }


def _of_file(name: str, module: str) -> Operator:
    kinds: list[type[Operator]] = classes_in(import_module(module), Operator)
    if len(kinds) != 1 or kinds[0].name != name:
        found = ", ".join(repr(kind.name) for kind in kinds) or "none"
        raise OperatorError(
            f"{module} must hold one operator, named {name!r} as the file is, but has {found}", operator=name
        )
    return _checked(kinds[0](), f"operator {name!r}")


def _checked(rule: Operator, where: str) -> Operator:
    """Raises OperatorError for one that asks for more than there is."""
    if rule.asks_neighbours:
        text = f"{where} asks for the calls before and after its own, which no engine can give it yet"
        raise OperatorError(text, operator=rule.name)
    return rule


def _loaded(part: Part) -> Operator:
    where = f"operator {part.name!r} of package {part.owner!r} ({part.reference})"
    try:
        made = part.load()()
    except ExtensionError as error:
        raise OperatorError(f"operator {error}", operator=part.name) from error
    except Exception as error:  # a package of others may fail in any way
        raise OperatorError(f"{where} cannot be loaded: {error!r}", operator=part.name) from error
    if not isinstance(made, Operator):
        raise OperatorError(
            f"{where} is {type(made).__name__}, not a subclass of mutabot.Operator", operator=part.name
        )
    if getattr(made, "name", None) != part.name:
        raise OperatorError(
            f"{where} calls itself {getattr(made, 'name', None)!r}; extension and class must agree",
            operator=part.name,
        )
    return _checked(made, where)


def modules_in(folder: Path) -> list[str]:
    """Names of the modules in a folder, bar those that begin with ``_``; none of them is loaded."""
    return sorted(file.stem for file in folder.glob("*.py") if not file.name.startswith("_"))


def folders_in(folder: Path) -> list[Path]:
    """The folders of packages below a folder; none of them is loaded."""
    return sorted(file.parent for file in folder.glob("*/**/__init__.py"))


def classes_in(module: ModuleType, base: type[Any]) -> list[type[Any]]:
    """The concrete subclasses of ``base`` that a module itself defines, in the order of its text."""
    return [
        kind
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, base)
        if kind.__module__ == module.__name__ and not getattr(kind, "__abstractmethods__", None)
    ]
