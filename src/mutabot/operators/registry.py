"""Finding operators by name: the built-in ones, and those that plug-ins bring."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from mutabot.errors import OperatorError, unknown_name_text

from .operator import Operator

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

ENTRY_POINT = "mutabot.operators"

#: name -> (module, class); the order is that of the documentation
BUILT_IN: dict[str, tuple[str, str]] = {
    "reverse": ("robot.reverse", "Reverse"),
    "by-to": ("robot.by_to", "ByTo"),
    "skip": ("robot.skip", "Skip"),
    "repeat": ("robot.repeat", "Repeat"),
    "opposite": ("robot.opposite", "Opposite"),
    "negate": ("robot.negate", "Negate"),
    "noise": ("robot.noise", "Noise"),
    "misread": ("robot.misread", "Misread"),
}
CONTROLS: dict[str, tuple[str, str]] = {
    "identity": ("control", "Identity"),
    "fatal": ("control", "Fatal"),
}


def names() -> list[str]:
    """Names of all operators that make mutants, built-in ones first.

    Raises OperatorError when two operators want the same name: it would not be clear whose mutants are whose.
    """
    owners: dict[str, str] = dict.fromkeys([*BUILT_IN, *CONTROLS], "mutabot")
    found = [*BUILT_IN]
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


def preload(wanted: Iterable[str]) -> None:
    """Load these operators as far as they can be; who needs one that cannot is told then."""
    for name in wanted:
        with suppress(OperatorError):
            operator(name)


@cache
def operator(name: str) -> Operator:
    """The operator of this name.

    Raises OperatorError if there is none, or if a plug-in does not keep the contract.
    """
    place = BUILT_IN.get(name) or CONTROLS.get(name)
    if place is not None:
        module, kind = place
        built_in: Operator = getattr(import_module(f"{__package__}.{module}"), kind)()
        return built_in
    for entry in _plug_ins():
        if entry.name == name:
            return _loaded(entry)
    raise OperatorError(unknown_name_text("operator", name, names()), operator=name)


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
    return made
