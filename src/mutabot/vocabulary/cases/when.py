"""What an argument decides: the mode of a quantity, and whether a whole entry is meant.

``mode = { argument = "relative", true = "by", false = "to" }``: a quantity has one mode, so an operation or
text command whose mode depends on an argument becomes one command for each value of that argument, each with
quantities of its own.

``when = { argument = "type", value = "gripper" }``: one callable that does everything, such as
``client.write(node, value)``, is several operations in the words of a test engineer. Each has an entry of its
own. Together they are one operation with a pattern for each entry; calls that fit none are left alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

from mutabot.model import Case, Mode, Operation, Path, Pattern, Quantity
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


_WHEN = 'such as when = { argument = "type", value = "gripper" }'


def read_when(check: Check, raw: Any, place: KeyPath) -> tuple[Case, ...]:
    """The cases of ``when``: a table, or a list of tables that all have to fit. Mistakes are noted."""
    tables = raw if isinstance(raw, list) else [raw]
    if not tables:
        check.error(place, f"must not be empty; {_WHEN}")
    places = [(*place, index) for index in range(len(tables))] if isinstance(raw, list) else [place]
    found = [_read_case(check, table, where) for table, where in zip(tables, places, strict=True)]
    cases = tuple(case for case in found if case is not None)
    seen: set[str] = set()
    for case, where in zip(found, places, strict=True):
        if case is not None and case.argument in seen:
            check.error(where, f"{case.argument} has one value in a call, so it cannot stand here twice")
        seen |= {case.argument} if case is not None else set()
    return cases


def in_case(operation: Operation, cases: tuple[Case, ...]) -> Operation:
    """The operation as one that is meant of calls in these cases alone."""
    patterns = operation.patterns or (
        Pattern("", operation.arguments, operation.result, source=operation.source),
    )
    return replace(
        operation,
        arguments=(),
        result=(),
        current=None,
        opposite=None,
        idle=None,
        refused=(),
        patterns=tuple(_in_case(operation, pattern, cases) for pattern in patterns),
        is_partial=True,
    )


def together(first: Operation, second: Operation) -> Operation:
    """Two entries for calls of one callable in unlike cases. Raises ValueError if they do not go together."""
    known = {pattern.text: pattern for pattern in first.patterns}
    for pattern in second.patterns:
        other = known.get(pattern.text)
        if other is not None and replace(other, source="") != replace(pattern, source=""):
            raise ValueError(f"{_shown(pattern)} is described twice, differently")
    for key in ("message", "signature"):
        one, other_one = getattr(first, key), getattr(second, key)
        if None not in (one, other_one) and one != other_one:
            raise ValueError(f"{key} is {other_one!r} here, but {one!r} in another entry for the same call")
    new = (pattern for pattern in second.patterns if pattern.text not in known)
    return replace(
        first,
        patterns=(*first.patterns, *new),
        command=first.command or second.command,
        refusals=tuple(dict.fromkeys((*first.refusals, *second.refusals))),
        message=first.message or second.message,
        signature=first.signature or second.signature,
        overrides=first.overrides or second.overrides,
    )


def _in_case(operation: Operation, pattern: Pattern, cases: tuple[Case, ...]) -> Pattern:
    when = (*cases, *pattern.when)
    base = pattern.notation if operation.message is not None and operation.patterns else None
    name = name_of(when)
    is_reading = bool(pattern.result and not pattern.arguments)
    return replace(
        pattern,
        text=name if base is None else f"{base} [{name}]",
        base=base,
        when=when,
        source=f"{pattern.source} · {name}",
        opposite=pattern.opposite if base is not None else operation.opposite,
        idle=pattern.idle if pattern.idle is not None else operation.idle,
        command=operation.command and not (operation.patterns and is_reading),
        current=operation.current,
        refused=operation.refused,
    )


def _read_case(check: Check, raw: Any, place: KeyPath) -> Case | None:
    if not isinstance(raw, dict) or set(raw) != {"argument", "value"}:
        odd = next(_odd(raw), None) if isinstance(raw, dict) else None
        if odd is not None:
            check.unknown((*place, odd), "key", odd, ("argument", "value"))
        else:
            check.error(place, f"needs an argument and its value, {_WHEN}")
        return None
    argument, value = raw["argument"], raw["value"]
    if not isinstance(argument, str) or _fault(argument) is not None:
        text = _fault(argument) if isinstance(argument, str) else f"expected text, got {shown(argument)}"
        check.error((*place, "argument"), str(text))
        return None
    if not isinstance(value, str | bool | int | float):
        check.error((*place, "value"), f"expected a text, a number, true or false, got {shown(value)}")
        return None
    return Case(argument, _text(value), "when")


def _odd(raw: dict[str, Any]) -> Iterator[str]:
    return (key for key in raw if key not in ("argument", "value"))


def _fault(argument: str) -> str | None:
    try:
        path = Path.parse(argument, rooted=True)
    except ValueError as error:
        return str(error)
    if argument == "self":
        return 'self is the object itself; name what lies in it, such as "self.name"'
    if any(step.bounds is not None for step in path.steps):
        return f"{argument!r} is not one value"
    return None


def _text(value: str | bool | float) -> str:
    """The value as ``Case`` has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)


def _shown(pattern: Pattern) -> str:
    return ", ".join(f"{case.argument} = {case.value}" for case in pattern.when)
