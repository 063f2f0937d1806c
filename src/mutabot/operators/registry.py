"""Finding operators on calls by name: the built-in ones by their files, and those that plug-ins bring."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from mutabot.errors import OperatorError, unknown_name_text

from .control import CONTROLS
from .operator import Operator
from .rule import in_order

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

ENTRY_POINT = "mutabot.operators"
_HERE = Path(__file__).parent


def built_in() -> list[str]:
    """Names of mutabot's own operators that make mutants, in the order of the documentation."""
    return [rule.name for rule in in_order(operator(name) for name in _files())]


def names() -> list[str]:
    """Names of all operators that make mutants, built-in ones first.

    Raises OperatorError when two operators want the same name: it would not be clear whose mutants are whose.
    """
    found = built_in()
    owners: dict[str, str] = dict.fromkeys([*found, *CONTROLS], "mutabot")
    for entry in sorted(_plug_ins(), key=lambda entry: entry.name):
        owner = _owner(entry)
        if entry.name in owners:
            raise OperatorError(
                f"operator {entry.name!r} of plug-in {owner!r} has the name of one of {owners[entry.name]!r}",
                operator=entry.name,
            )
        owners[entry.name] = owner
        found.append(entry.name)
    return found


def load_all() -> list[Operator]:
    """All operators that make mutants. Raises OperatorError for a plug-in that is of no use."""
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
    for entry in _plug_ins():
        if entry.name == name:
            return _loaded(entry)
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


@cache
def _plug_ins() -> tuple[EntryPoint, ...]:
    from importlib import metadata  # noqa: PLC0415  # slow, and workers need it for plug-ins only

    return tuple(metadata.entry_points(group=ENTRY_POINT))


def _owner(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist is not None else entry.value


def _loaded(entry: EntryPoint) -> Operator:
    where = f"operator {entry.name!r} of plug-in {_owner(entry)!r} ({entry.value})"
    try:
        made = entry.load()()
    except Exception as error:  # a plug-in may fail in any way; the user needs to know which one it was
        raise OperatorError(f"{where} cannot be loaded: {error!r}", operator=entry.name) from error
    if not isinstance(made, Operator):
        raise OperatorError(
            f"{where} is {type(made).__name__}, not a subclass of mutabot.Operator", operator=entry.name
        )
    if getattr(made, "name", None) != entry.name:
        raise OperatorError(
            f"{where} calls itself {getattr(made, 'name', None)!r}; entry point and class must agree",
            operator=entry.name,
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
