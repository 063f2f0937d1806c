"""Find operators on calls by name: the built-in ones, and those of packages."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from mutabot.errors import ExtensionError, OperatorError, unknown_name_text
from mutabot.extensions import brought

from .command import CONTROLS
from .operator import Operator

_KINDS = Path(__file__).parent / "kinds"
#: files in the order of the documentation, and of the numbers of mutants; others come last
_ORDER = ("motions", "commands", "readings", "graded")


def built_in() -> list[str]:
    """Return names of mutabot's own operators that make mutants, in the order of the documentation."""
    return [rule.name for module in _modules() for rule in _of_module(module)]


def names() -> list[str]:
    """Return names of all operators that make mutants, built-in ones first.

    Raises OperatorError or ExtensionError when two operators want the same name: it would not be clear whose
    mutants are whose.
    """
    found = built_in()
    own = {*found, *CONTROLS}
    for part in brought("operators").values():
        if part.name in own:
            text = f"operator {part.name!r} of package {part.owner!r} has the name of one of 'mutabot'"
            raise OperatorError(text)
        found.append(part.name)
    return found


def load_all() -> list[Operator]:
    """Return all operators that make mutants. Raises OperatorError for an invalid one of a package."""
    return [operator(name) for name in names()]


def preload(wanted: Iterable[str] | None = None) -> None:
    """Load these operators, or all. One that cannot be loaded raises only when it is needed."""
    for name in (*built_in(), *brought("operators")) if wanted is None else wanted:
        with suppress(OperatorError):
            operator(name)


@cache
def operator(name: str) -> Operator:
    """Return the operator of this name.

    Raises OperatorError if there is none, or if one does not keep the contract.
    """
    if name in CONTROLS:
        return CONTROLS[name]()
    for module, text in _modules().items():
        for rule in _of_module(module) if f'"{name}"' in text else ():
            if rule.name == name:
                return rule
    part = brought("operators").get(name)
    if part is not None:
        try:
            return part.make(Operator)  # type: ignore[type-abstract]
        except ExtensionError as error:
            raise OperatorError(f"operator {error}") from error
    raise OperatorError(unknown_name_text("operator", name, names()))


@cache
def _modules() -> dict[str, str]:
    """Return the text of each module in the folder of operators, by its name: nothing is loaded for it.

    An operator is in a module whose text has its name in quotes, so that workers load no other.
    """
    return {
        f"{__package__}.kinds.{module}": (_KINDS / f"{module}.py").read_text(encoding="utf-8")
        for module in sorted(modules_in(_KINDS), key=lambda name: (*_ORDER, name).index(name))
    }


@cache
def _of_module(module: str) -> list[Operator]:
    """Return the operators in a module."""
    return [kind() for kind in classes_in(import_module(module), Operator)]


def modules_in(folder: Path) -> list[str]:
    """Return the names of the modules in a folder, except those that begin with ``_``; none is loaded."""
    return sorted(file.stem for file in folder.glob("*.py") if not file.name.startswith("_"))


def classes_in(module: ModuleType, base: type[Any]) -> list[type[Any]]:
    """Return the concrete subclasses of ``base`` that a module itself defines, in the order of its text.

    None whose name begins with ``_``: that is what several of them have in common.
    """
    return [
        kind
        for name, kind in vars(module).items()
        if isinstance(kind, type) and issubclass(kind, base) and not name.startswith("_")
        if kind.__module__ == module.__name__ and not getattr(kind, "__abstractmethods__", None)
    ]
