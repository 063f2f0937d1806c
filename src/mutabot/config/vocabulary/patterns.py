"""Read descriptions of calls that stand for several commands: texts, ``when``, and modes by an argument.

Entries of ``patterns`` distinguish text commands.

``when = { argument = "type", value = "gripper" }``: one callable that does everything, such as
``client.write(node, value)``, is several operations in the words of a test engineer. Each has an entry of its
own. Together they are one operation with a pattern for each entry; calls that fit none are left alone.

``mode = { argument = "relative", true = "by", false = "to" }``: a quantity has one mode, so an operation or
text command whose mode depends on an argument becomes one command for each value of that argument.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from mutabot.config.mistakes import DocumentPlace, shown
from mutabot.errors import nearest_name
from mutabot.model import Case, Mode, Operation, Path, Pattern, Quantity
from mutabot.model.notation import Field, Notation

from .quantities import read_quantities, read_quantity
from .schema import CALLABLE, CaseTable, PatternTable, QuantityTable, Sides, read_idle


def read_patterns(
    place: DocumentPlace,
    raw: list[Any],
    source: str,
    common: tuple[Quantity, ...] = (),
    sides: Sides = CALLABLE,
) -> tuple[Pattern, ...]:
    """Read the patterns of an operation.

    Args:
        place: where the entries stand.
        raw: the entries.
        source: the operation's own.
        common: arguments that all of them have beside the text, unless they describe them otherwise.
        sides: where the operation's quantities stand.
    """
    patterns: list[Pattern] = []
    seen: dict[tuple[str, ...], str] = {}
    for at, item in place.each(raw):
        found = list(_read_pattern(at, item, source, common, sides))
        text = found[0].notation or "" if found else ""
        form = _form(Notation.compile(text)) if found else ()
        if form in seen:
            (at / "text").error(f"takes the same commands as {seen[form]!r}")
        elif found:
            seen[form] = text
        patterns += found
    return tuple(patterns)


def _read_pattern(
    place: DocumentPlace, raw: Any, source: str, common: tuple[Quantity, ...], sides: Sides
) -> Iterator[Pattern]:
    """Read one entry, once for each value of the arguments that decide about modes."""
    own = raw
    if isinstance(raw, dict):
        own = {key: value for key, value in raw.items() if key not in QuantityTable.model_fields}
    table = place.table(PatternTable, own, also=QuantityTable.model_fields)
    notation = (place / "text").attempt(Notation.compile, table.text) if table is not None else None
    if table is None or notation is None:
        return
    if table.opposite is not None:
        (place / "opposite").attempt(_check_opposite, table.opposite, notation)
    line = place.document.line(place.path)
    where = f"{place.document.file}:{line} · {source.partition(' · ')[2]}" if line is not None else source
    result = read_quantities(place / "result", table.result, sides)
    idle = read_idle(place / "idle", table.idle)
    beside = raw if "kind" in raw else {"arguments": table.arguments}
    for cases, at, decided in in_each_mode(place, beside):
        arguments = _arguments(at, decided, notation, sides)
        names = {quantity.name for quantity in arguments} | {field.name for field in notation.fields}
        name = f" [{name_of_cases(cases)}]" if cases else ""
        yield Pattern(
            text=table.text + name,
            arguments=(*arguments, *(quantity for quantity in common if quantity.name not in names)),
            result=result,
            opposite=table.opposite,
            source=f"{where} · {notation.short}{name}",
            idle=idle,
            when=cases,
            base=table.text if cases else None,
        )


def _arguments(
    place: DocumentPlace, raw: dict[str, Any], notation: Notation, sides: Sides
) -> tuple[Quantity, ...]:
    """Return the quantities of the fields, and of arguments beside the text."""
    inline = {key: value for key, value in raw.items() if key in QuantityTable.model_fields}
    arguments: dict[str, Any] = raw.get("arguments") or {}
    fields = {field.name: field for field in notation.fields}
    if inline and len(fields) == 1 and not arguments:
        return _read_field(place, inline, notation.fields[0])
    if inline:
        names = " and ".join(f"{{{name}}}" for name in fields) or "no field"
        place.error(f"{notation.text!r} has {names}: describe each, arguments.NAME = {{ kind = … }}")
        return ()
    free = [name for name in fields if name not in arguments]
    quantities: list[Quantity] = []
    beside: dict[str, Any] = {}
    for name, item in arguments.items():
        at = place / "arguments" / name
        if name in fields:
            quantities.extend(_read_field(at, item, fields[name]))
        elif nearest_name(name, free) is not None:  # a field that is misspelt, rather than an argument
            at.unknown("field", name, fields)
        else:
            beside[name] = item
    return (*quantities, *read_quantities(place / "arguments", beside, sides, is_written=True))


def _read_field(place: DocumentPlace, raw: Any, field: Field) -> tuple[Quantity, ...]:
    quantities = tuple(read_quantity(place, raw, Path(field.name), is_written=True))
    for quantity in quantities:
        place.attempt(_check_field, field, quantity)
    return quantities


def _check_field(field: Field, quantity: Quantity) -> None:
    """Raise ValueError for a quantity that a field of this type cannot hold."""
    name, values = field.name, quantity.values or ()
    texts = [value for value in values if isinstance(value, str)]
    if quantity.is_whole:
        raise ValueError(f"{{{name}}} is one number, and {quantity.kind} has several")
    if field.kind != "s" and texts:
        raise ValueError(f"{{{name}}} takes numbers, not {texts[0]!r}; write {{{name}}}")
    if field.kind == "s" and (not values or len(texts) != len(values)):
        raise ValueError(f"{{{name}}} takes text; for numbers write {{{name}:g}} (or :d, :.2f …)")


def _check_opposite(text: str, notation: Notation) -> None:
    """Raise ValueError for a text that is not the notation of an opposite."""
    opposite = Notation.compile(text)
    names, wanted = ({field.name for field in each.fields} for each in (opposite, notation))
    if names != wanted:
        odd = sorted(names ^ wanted)[0]
        here, there = (text, notation.text) if odd in names else (notation.text, text)
        raise ValueError(
            f"the opposite must have the same fields: {{{odd}}} is in {here!r}, not in {there!r}"
        )
    if _form(opposite) == _form(notation):
        raise ValueError("a command cannot be its own opposite")


def _form(notation: Notation) -> tuple[str, ...]:
    """Return what distinguishes commands: literal text and types of fields, not the fields' names."""
    return tuple(part if isinstance(part, str) else f"{{:{part.kind}}}" for part in notation.parts)


_MODE = 'such as mode = { argument = "relative", true = "by", false = "to" }'
_WHEN = 'such as when = { argument = "type", value = "gripper" }'


def in_each_mode(place: DocumentPlace, raw: Any) -> list[tuple[tuple[Case, ...], DocumentPlace, Any]]:
    """Return a table of quantities, once for each case of the arguments that decide about modes.

    There is one case without a condition if nothing decides. Mistakes are noted at the place of the first.
    """
    values: dict[str, tuple[str, ...]] = {}
    for at, mode in _choices(place, raw):
        argument, found = _read_choice(at / "mode", mode)
        if argument and set(values.setdefault(argument, found)) != set(found):
            at.error(
                f"{argument} has the values {', '.join(found)} here, but {', '.join(values[argument])} "
                "in the mode of another quantity"
            )
    combined = product(*([Case(argument, value) for value in found] for argument, found in values.items()))
    silent = replace(place, errors=[])  # the mistakes of the other cases are the same
    return [
        (cases, silent if number else place, _in_case(raw, cases)) for number, cases in enumerate(combined)
    ]


def _choices(place: DocumentPlace, raw: Any) -> Iterator[tuple[DocumentPlace, dict[str, Any]]]:
    """Yield the quantities in a table whose mode is a table."""
    if not isinstance(raw, dict):
        return
    if isinstance(raw.get("kind"), str):
        if isinstance(raw.get("mode"), dict):
            yield place, raw["mode"]
        return
    for key, item in raw.items():
        yield from _choices(place / key, item)


def _read_choice(place: DocumentPlace, mode: dict[str, Any]) -> tuple[str, tuple[str, ...]]:
    """Return the argument that decides, and its values; ("", ()) if there is a mistake, which is noted."""
    argument = mode.get("argument")
    named = {key: value for key, value in mode.items() if key != "argument"}
    for key, value in named.items():
        if not isinstance(value, str):
            (place / key).error(f'expected "by" or "to", got {shown(value)}')
        elif value not in tuple(Mode):
            (place / key).unknown("mode", value, [mode.value for mode in Mode])
    if not isinstance(argument, str):
        place.error(f"needs the argument that decides, {_MODE}")
    elif len(named) < 2:
        place.error(f"needs a mode for each value of {argument}, {_MODE}")
    elif (place / "argument").attempt(_path_of_choice, argument) is not None:
        return argument, tuple(named)
    return "", ()


def _path_of_choice(text: str) -> Path:
    path = Path.parse(text, rooted=True)
    if path.root == "self" or any(step.bounds is not None for step in path.steps):
        raise ValueError(f"{text!r} is not one argument of the call")
    return path


def _in_case(raw: Any, cases: Sequence[Case]) -> Any:
    """Return the table with the modes that these cases decide; ``by`` where the choice is a mistake."""
    if not isinstance(raw, dict):
        return raw
    if not isinstance(raw.get("kind"), str):
        return {key: _in_case(item, cases) for key, item in raw.items()}
    mode = raw.get("mode")
    if not isinstance(mode, dict):
        return raw
    value = next((case.value for case in cases if case.argument == mode.get("argument")), "")
    return {**raw, "mode": found if (found := mode.get(value)) in tuple(Mode) else Mode.BY.value}


def name_of_cases(cases: Sequence[Case]) -> str:
    """Return the cases as ids and reports print them, as a notation."""
    text = ", ".join(f"{case.argument}={case.value}" for case in cases)
    return text.replace("{", "{{").replace("}", "}}")


def read_when(place: DocumentPlace, raw: Any) -> tuple[Case, ...]:
    """Read ``when``: a table, or a list of tables that all have to fit. Mistakes are noted."""
    if raw == []:
        place.error(f"must not be empty; {_WHEN}")
    cases: dict[str, Case] = {}
    for at, item in place.each(raw):
        table = at.table(CaseTable, item)
        if table is not None and table.argument in cases:
            at.error(f"{table.argument} has one value in a call, so it cannot be named twice")
        elif table is not None:
            cases[table.argument] = Case(table.argument, _text(table.value), "when")
    return tuple(cases.values())


def _text(value: str | bool | float) -> str:
    """Return the value as ``Case`` has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value)


def in_cases(operation: Operation, cases: tuple[Case, ...]) -> Operation:
    """Return the operation restricted to calls in these cases."""
    whole = Pattern("", operation.arguments, operation.result, source=operation.source)
    return replace(
        operation,
        arguments=(),
        result=(),
        current=None,
        opposite=None,
        idle=None,
        refused=(),
        patterns=tuple(_pattern(operation, pattern, cases) for pattern in operation.patterns or (whole,)),
        is_partial=True,
    )


def _pattern(operation: Operation, pattern: Pattern, cases: tuple[Case, ...]) -> Pattern:
    when = (*cases, *pattern.when)
    base = pattern.notation if operation.message is not None and operation.patterns else None
    name = name_of_cases(when)
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


def together(first: Operation, second: Operation) -> Operation:
    """Merge two entries for different cases of one callable. Raises ValueError if they conflict."""
    known = {pattern.text: pattern for pattern in first.patterns}
    for pattern in second.patterns:
        known_pattern = known.get(pattern.text)
        if known_pattern is not None and replace(known_pattern, source="") != replace(pattern, source=""):
            cases = ", ".join(f"{case.argument} = {case.value}" for case in pattern.when)
            raise ValueError(f"{cases} is described twice, differently")
    for key in ("message", "signature"):
        value, other_one = getattr(first, key), getattr(second, key)
        if None not in (value, other_one) and value != other_one:
            raise ValueError(f"{key} is {other_one!r} here, but {value!r} in another entry for the same call")
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
