"""Text commands: entries of ``patterns`` turned into patterns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mutabot.config.mistakes import DocumentPlace
from mutabot.errors import nearest_name
from mutabot.model import Path, Pattern, Quantity
from mutabot.model.notation import Field, Notation

from .names import CALLABLE, Sides
from .quantities import read_quantities, read_quantity
from .schema import PatternTable, QuantityTable, read_idle
from .when import in_each_mode, name_of


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
    for index, item in enumerate(raw):
        found = list(_read_pattern(place / index, item, source, common, sides))
        text = found[0].notation or "" if found else ""
        form = _form(Notation.compile(text)) if found else ()
        if form in seen:
            (place / index / "text").error(f"takes the same commands as {seen[form]!r}")
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
        name = f" [{name_of(cases)}]" if cases else ""
        yield Pattern(
            text=table.text + name,
            arguments=(*arguments, *(one for one in common if one.name not in names)),
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
    """The quantities of the fields, and of arguments beside the text."""
    inline = {key: value for key, value in raw.items() if key in QuantityTable.model_fields}
    arguments: dict[str, Any] = raw.get("arguments") or {}
    fields = {field.name: field for field in notation.fields}
    if inline:
        field = _only_field(place, notation, has_more=bool(arguments))
        return _read_field(place, inline, field) if field is not None else ()
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


def _only_field(place: DocumentPlace, notation: Notation, *, has_more: bool) -> Field | None:
    """The one field that keys of a quantity beside the text describe; None if that is a mistake."""
    fields = notation.fields
    if has_more:
        place.error("describe the fields either here or under arguments, not both")
    elif not fields:
        place.error(
            f"{notation.text!r} has no field that this quantity could describe; "
            "for an argument beside the text write arguments.NAME = { … }"
        )
    elif len(fields) > 1:
        names = " and ".join(f"{{{field.name}}}" for field in fields)
        (place / "text").error(
            f"has the fields {names}: describe each, as arguments = {{ {fields[0].name} = {{ kind = … }} }}"
        )
    else:
        return fields[0]
    return None


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
    """What tells commands apart: literal text and types of fields, not the fields' names."""
    return tuple(part if isinstance(part, str) else f"{{:{part.kind}}}" for part in notation.parts)
