"""Modes that an argument decides: ``mode = { argument = "relative", true = "by", false = "to" }``.

A quantity has one mode. So an operation or text command whose mode depends on an argument becomes one
command for each value of that argument, each with quantities of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import product
from typing import Any

from mutabot.model import Case, Mode, Path, Pattern, Quantity
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath

_FORM = 'such as mode = { argument = "relative", true = "by", false = "to" }'


@dataclass(frozen=True, slots=True)
class ModeChoice:
    """What decides about a mode.

    Attributes:
        argument: path to the argument that does.
        modes: the mode for each of its values.
    """

    argument: str
    modes: tuple[tuple[str, Mode], ...]


@dataclass(frozen=True, slots=True)
class Undecided(Quantity):
    """A quantity whose mode an argument decides; ``mode`` is that of the first value."""

    choice: ModeChoice = ModeChoice("", ())

    @classmethod
    def of(cls, quantity: Quantity, choice: ModeChoice) -> Undecided:
        return cls(**_facts(quantity), choice=choice)

    def decided(self, mode: Mode) -> Quantity:
        """The quantity in this mode."""
        return Quantity(**{**_facts(self), "mode": mode})


def read_mode_choice(check: Check, raw: Any, place: KeyPath) -> tuple[Any, ModeChoice | None]:
    """A quantity's table with a plain mode, and what decides about it; None if nothing does.

    Mistakes are noted.
    """
    mode = raw.get("mode") if isinstance(raw, dict) else None
    if not isinstance(mode, dict):
        return raw, None
    where = (*place, "mode")
    argument = mode.get("argument")
    named = {key: value for key, value in mode.items() if key != "argument"}
    modes: list[tuple[str, Mode]] = []
    for key, value in named.items():
        if value in tuple(Mode):
            modes.append((key, Mode(value)))
        elif isinstance(value, str):
            check.unknown((*where, key), "mode", value, [one.value for one in Mode])
        else:
            check.error((*where, key), f'expected "by" or "to", got {shown(value)}')
    plain = {**raw, "mode": modes[0][1].value if modes else Mode.BY.value}
    if not isinstance(argument, str):
        check.error(where, f"needs the argument that decides, {_FORM}")
    elif len(named) < 2:
        check.error(where, f"needs a mode for each value of {argument}, {_FORM}")
    elif _is_path(check, argument, (*where, "argument")):
        return plain, ModeChoice(argument, tuple(modes))
    return plain, None


def cases_of(
    check: Check, quantities: Sequence[Quantity], place: KeyPath
) -> list[tuple[tuple[Case, ...], tuple[Quantity, ...]]]:
    """The quantities in each case that arguments decide; one without a condition if they decide nothing."""
    values: dict[str, tuple[str, ...]] = {}
    for quantity in quantities:
        if isinstance(quantity, Undecided):
            argument = quantity.choice.argument
            found = tuple(value for value, _ in quantity.choice.modes)
            if set(values.setdefault(argument, found)) != set(found):
                check.error(
                    (*place, quantity.name),
                    f"{argument} has the values {', '.join(found)} here, but {', '.join(values[argument])} "
                    "in the mode of another quantity",
                )
    combined = product(*([Case(argument, value) for value in found] for argument, found in values.items()))
    return [(cases, tuple(_decided(quantity, cases) for quantity in quantities)) for cases in combined]


def in_cases(
    check: Check,
    arguments: tuple[Quantity, ...],
    result: tuple[Quantity, ...],
    opposite: str | None,
    source: str,
    place: KeyPath,
) -> tuple[tuple[Quantity, ...], tuple[Pattern, ...]]:
    """The arguments of an operation, or its commands if an argument decides about their modes."""
    found = cases_of(check, arguments, (*place, "arguments"))
    if not found[0][0]:
        return found[0][1], ()
    patterns = [
        Pattern(
            text=name_of(cases),
            arguments=quantities,
            result=result,
            opposite=opposite,
            source=f"{source} · {name_of(cases)}",
            when=cases,
        )
        for cases, quantities in found
    ]
    return (), tuple(patterns)


def name_of(cases: Sequence[Case]) -> str:
    """The cases as ids and reports print them, as a notation."""
    text = ", ".join(f"{case.argument}={case.value}" for case in cases)
    return text.replace("{", "{{").replace("}", "}}")


def _decided(quantity: Quantity, cases: Sequence[Case]) -> Quantity:
    if not isinstance(quantity, Undecided):
        return quantity
    modes = dict(quantity.choice.modes)
    value = next((case.value for case in cases if case.argument == quantity.choice.argument), "")
    return quantity.decided(modes.get(value, Mode.BY))  # else it is a mistake that was noted


def _facts(quantity: Quantity) -> dict[str, Any]:
    return {one.name: getattr(quantity, one.name) for one in fields(Quantity)}


def _is_path(check: Check, text: str, place: KeyPath) -> bool:
    try:
        path = Path.parse(text, rooted=True)
    except ValueError as error:
        check.error(place, str(error))
        return False
    if path.root == "self" or any(step.bounds is not None for step in path.steps):
        check.error(place, f"{text!r} is not one argument of the call")
        return False
    return True
