"""Demands of the configuration: ``[[tool.mutabot.demand]]``, read and checked."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

from pydantic import Field

from mutabot.errors import unknown_name_text
from mutabot.model import Kind
from mutabot.model.graded import OFFSET, Demand, parse_amount
from mutabot.model.quantity import DIMENSIONS, MEASURED, WHOLE
from mutabot.model.units import UNITS, Dimension, dimension_of

from .mistakes import ALSO_KNOWN_AS, Check
from .table import Table
from .toml_lines import KeyPath

#: what every quantity can be off by beside its own measure: it comes late, or is scaled
_ANY = (Dimension.TIME, Dimension.RATIO)
_NUMBERS = re.compile(r"\d+(-\d+)?(,\d+(-\d+)?)*")


class DemandTable(Table):
    """One ``[[tool.mutabot.demand]]``."""

    notice: str | float
    site: Annotated[str | None, Field(min_length=1)] = None
    quantity: Annotated[str | None, Field(min_length=1)] = None
    kind: str | None = None
    operator: str = OFFSET
    share: Annotated[float | None, Field(gt=0, lt=1)] = None


def check_demands(tables: Sequence[Mapping[str, Any]], check: Check, place: KeyPath) -> tuple[Demand, ...]:
    """The demands that these tables mean; what is wrong with them is noted."""
    places = [(*place, index) for index in range(len(tables))]
    read = [check.table(DemandTable, table, where) for table, where in zip(tables, places, strict=True)]
    pairs = zip(read, places, strict=True)
    found = (_demand(table, check, where) for table, where in pairs if table is not None)
    return tuple(one for one in found if one is not None)


def _demand(table: DemandTable, check: Check, place: KeyPath) -> Demand | None:
    mistakes = len(check.errors)
    kind = _kind(table, check, place)
    notice, unit = _amount(table, check, place)
    if table.operator != OFFSET:
        _check_operator(table.operator, check, place)
    if table.site is not None and _NUMBERS.fullmatch(table.site):
        text = f"{table.site!r} is the number of a mutant, which may change; write file:line or an id"
        check.error((*place, "site"), text)
    if len(check.errors) == mistakes:
        _check_measure(table.operator, kind, unit, check, place)
    if len(check.errors) > mistakes:
        return None
    line = check.document.line(place)
    source = f"{check.document.file}:{line}" if line is not None else check.document.file
    return Demand(notice, unit, table.site, table.quantity, kind, table.operator, table.share, source)


def _amount(table: DemandTable, check: Check, place: KeyPath) -> tuple[float, str | None]:
    """The magnitude and its unit; (0, None) if they cannot be read, which is noted."""
    where = (*place, "notice")
    text = table.notice if isinstance(table.notice, str) else f"{table.notice:g}"
    try:
        return parse_amount(text)
    except KeyError as error:
        name = str(error.args[0])
        known = ALSO_KNOWN_AS["unit"].get(name.casefold())
        if known in UNITS:
            check.error(where, f"unknown unit {name!r}; did you mean {known!r}?")
        else:
            check.unknown(where, "unit", name, UNITS)
    except ValueError as error:
        check.error(where, str(error))
    return 0.0, None


def _kind(table: DemandTable, check: Check, place: KeyPath) -> Kind | None:
    known = [kind.value for kind in Kind if kind in MEASURED]
    if table.kind is None:
        return None
    if table.kind not in known:
        check.unknown((*place, "kind"), "kind", table.kind, known)
        return None
    return Kind(table.kind)


def _check_operator(name: str, check: Check, place: KeyPath) -> None:
    from mutabot.operators import load_all  # noqa: PLC0415  # few configurations name one

    known = [rule.name for rule in load_all() if rule.has_sizes]
    if name not in known:
        check.error((*place, "operator"), unknown_name_text("graded operator", name, [*known, OFFSET]))


def _check_measure(operator: str, kind: Kind | None, unit: str | None, check: Check, place: KeyPath) -> None:
    """Note a unit that no fault of this kind has."""
    if kind is None:
        return
    own = (Dimension.ANGLE,) if kind in WHOLE else tuple(DIMENSIONS.get(kind, ()))
    allowed = own if operator == OFFSET else (*own, *_ANY)
    where = (*place, "notice")
    if unit is None and allowed:
        check.error(where, f"a {kind} has a unit; write it behind the number: {_listed(_units(allowed))}")
    elif unit is not None and dimension_of(unit) not in allowed:
        text = f"use {_listed(_units(allowed))}" if allowed else "it has no unit"
        check.error(where, f"{unit!r} measures no {operator} of a {kind}; {text}")


def _units(dimensions: Iterable[Dimension]) -> list[str]:
    wanted = set(dimensions)
    return [name for name in UNITS if dimension_of(name) in wanted]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names)
