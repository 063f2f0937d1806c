"""Text commands: entries of ``patterns`` turned into patterns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mutabot.errors import nearest_name
from mutabot.model import Path, Pattern, Quantity
from mutabot.model.notation import Field, Notation
from mutabot.settings.mistakes import Check
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.cases.when import cases_of, name_of

from .quantities import read_arguments, read_quantity, read_result
from .schema import PatternTable, QuantityTable, read_idle


def read_patterns(
    check: Check, raw: list[Any], place: KeyPath, source: str, common: tuple[Quantity, ...] = ()
) -> tuple[Pattern, ...]:
    """The patterns of an operation.

    Args:
        check: the document.
        raw, place: the entries, and where they stand.
        source: the operation's own.
        common: arguments that all of them have beside the text, unless they describe them otherwise.
    """
    patterns: list[Pattern] = []
    seen: dict[tuple[str, ...], str] = {}
    for index, item in enumerate(raw):
        where = (*place, index)
        pattern = _read_pattern(check, item, where, source)
        if pattern is None:
            continue
        form = _form(Notation.compile(pattern.text))
        if form in seen:
            check.error((*where, "text"), f"takes the same commands as {seen[form]!r}")
        seen.setdefault(form, pattern.text)
        own = {quantity.name for quantity in pattern.arguments} | pattern.fields
        beside = (one for one in common if one.name not in own)
        pattern = replace(pattern, arguments=(*pattern.arguments, *beside))
        patterns.extend(_in_cases(check, pattern, where))
    return tuple(patterns)


def _in_cases(check: Check, pattern: Pattern, place: KeyPath) -> Iterator[Pattern]:
    """The pattern, once for each value of the arguments that decide about modes."""
    for cases, quantities in cases_of(check, pattern.arguments, (*place, "arguments")):
        if not cases:
            yield pattern
            continue
        yield replace(
            pattern,
            text=f"{pattern.text} [{name_of(cases)}]",
            arguments=quantities,
            source=f"{pattern.source} [{name_of(cases)}]",
            when=cases,
            base=pattern.text,
        )


def _read_pattern(check: Check, raw: Any, place: KeyPath, source: str) -> Pattern | None:
    inline, own = {}, raw
    if isinstance(raw, dict):
        inline = {key: value for key, value in raw.items() if key in QuantityTable.model_fields}
        own = {key: value for key, value in raw.items() if key not in inline}
    table = check.table(PatternTable, own, place, also=QuantityTable.model_fields)
    notation = _notation(check, table.text, (*place, "text")) if table is not None else None
    if table is None or notation is None:
        return None
    if inline:
        arguments = _read_only_field(check, inline, place, notation, table)
    else:
        arguments = _read_fields(check, table.arguments, (*place, "arguments"), notation)
    if table.opposite is not None:
        _check_opposite(check, table.opposite, (*place, "opposite"), notation)
    return Pattern(
        text=table.text,
        arguments=arguments,
        result=read_result(check, table.result, (*place, "result")),
        opposite=table.opposite,
        source=f"{_with_line(check, source, place)} · {notation.short}",
        idle=read_idle(check, table.idle, (*place, "idle")),
    )


def _read_only_field(
    check: Check, inline: dict[str, Any], place: KeyPath, notation: Notation, table: PatternTable
) -> tuple[Quantity, ...]:
    fields = notation.fields
    names = " and ".join(f"{{{field.name}}}" for field in fields)
    if table.arguments:
        check.error(place, "describe the fields either here or under arguments, not both")
    elif not fields:
        check.error(
            place,
            f"{table.text!r} has no field that this quantity could describe; "
            "for an argument beside the text write arguments.NAME = { … }",
        )
    elif len(fields) > 1:
        text = (
            f"has the fields {names}: describe each, as arguments = {{ {fields[0].name} = {{ kind = … }} }}"
        )
        check.error((*place, "text"), text)
    else:
        return _read_field(check, inline, place, fields[0])
    return ()


def _read_fields(
    check: Check, raw: dict[str, Any], place: KeyPath, notation: Notation
) -> tuple[Quantity, ...]:
    fields = {field.name: field for field in notation.fields}
    free = [name for name in fields if name not in raw]
    quantities: list[Quantity] = []
    beside: dict[str, Any] = {}
    for name, item in raw.items():
        if name in fields:
            quantities.extend(_read_field(check, item, (*place, name), fields[name]))
        elif nearest_name(name, free) is not None:  # a field that is misspelt, rather than an argument
            check.unknown((*place, name), "field", name, fields)
        else:
            beside[name] = item
    return (*quantities, *read_arguments(check, beside, place))


def _read_field(check: Check, raw: Any, place: KeyPath, field: Field) -> tuple[Quantity, ...]:
    quantities = tuple(read_quantity(check, raw, place, Path(field.name), written=True))
    for quantity in quantities:
        fault = _field_fault(field, quantity)
        if fault is not None:
            check.error(place, fault)
    return quantities


def _field_fault(field: Field, quantity: Quantity) -> str | None:
    if quantity.is_whole:
        return f"{{{field.name}}} is one number, and {quantity.kind} has several"
    named = [value for value in quantity.values or () if isinstance(value, str)]
    if field.kind != "s":
        return f"{{{field.name}}} takes numbers, not {named[0]!r}; write {{{field.name}}}" if named else None
    if quantity.values is not None and len(named) == len(quantity.values):
        return None
    return f"{{{field.name}}} takes text; for numbers write {{{field.name}:g}} (or :d, :.2f …)"


def _check_opposite(check: Check, text: str, place: KeyPath, notation: Notation) -> None:
    opposite = _notation(check, text, place)
    if opposite is None:
        return
    names, wanted = ({field.name for field in each.fields} for each in (opposite, notation))
    if names != wanted:
        odd = sorted(names ^ wanted)[0]
        here, there = (text, notation.text) if odd in names else (notation.text, text)
        check.error(
            place, f"the opposite must have the same fields: {{{odd}}} is in {here!r}, not in {there!r}"
        )
    elif _form(opposite) == _form(notation):
        check.error(place, "a command cannot be its own opposite")


def _notation(check: Check, text: str, place: KeyPath) -> Notation | None:
    try:
        return Notation.compile(text)
    except ValueError as error:
        check.error(place, str(error))
        return None


def _form(notation: Notation) -> tuple[str, ...]:
    """What tells commands apart: literal text and types of fields, not the fields' names."""
    return tuple(part if isinstance(part, str) else f"{{:{part.kind}}}" for part in notation.parts)


def _with_line(check: Check, source: str, place: KeyPath) -> str:
    line = check.document.line(place)
    _, separator, call = source.partition(" · ")
    return f"{check.document.file}:{line}{separator}{call}" if line is not None else source
