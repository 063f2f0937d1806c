"""Finding operators by name: the built-in ones, and those that plug-ins bring."""

from __future__ import annotations

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
    "reverse": ("reverse", "Reverse"),
    "by-to": ("by_to", "ByTo"),
    "skip": ("skip", "Skip"),
    "repeat": ("repeat", "Repeat"),
    "opposite": ("opposite", "Opposite"),
    "negate": ("negate", "Negate"),
    "noise": ("noise", "Noise"),
    "misread": ("misread", "Misread"),
}
CONTROLS: dict[str, tuple[str, str]] = {
    "identity": ("control", "Identity"),
    "fatal": ("control", "Fatal"),
}


def names() -> list[str]:
    """Names of all operators that make mutants, built-in ones first."""
    return [*BUILT_IN, *sorted(entry.name for entry in _plug_ins() if entry.name not in BUILT_IN)]


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


def _loaded(entry: EntryPoint) -> Operator:
    owner = entry.dist.name if entry.dist is not None else "?"
    where = f"operator {entry.name!r} of plug-in {owner!r} ({entry.value})"
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
