"""Demands of the configuration: ``[[tool.mutabot.demand]]``, read and checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, Field

from mutabot.errors import unknown_name_text
from mutabot.model import Kind
from mutabot.model.mutant_pattern import means_numbers
from mutabot.model.quantity import MEASURED, measures_of
from mutabot.model.units import OF_ANY, UNITS, units_of
from mutabot.thresholds.demands import OFFSET, Demand, parse_amount

from .table import Table

if TYPE_CHECKING:
    from .mistakes import DocumentPlace


def _check_kind(kind: Kind | None) -> Kind | None:
    if kind is not None and kind not in MEASURED:
        raise ValueError(f"a {kind} has no magnitude; only what is measured has")
    return kind


class DemandTable(Table):
    """One ``[[tool.mutabot.demand]]``."""

    notice: str | float
    site: Annotated[str | None, Field(min_length=1)] = None
    quantity: Annotated[str | None, Field(min_length=1)] = None
    kind: Annotated[Kind | None, Field(strict=False), AfterValidator(_check_kind)] = None
    operator: str = OFFSET


def check_demands(place: DocumentPlace, tables: Sequence[Mapping[str, Any]]) -> tuple[Demand, ...]:
    """Return the demands in these tables; mistakes are noted."""
    found = (_demand(place / index, raw) for index, raw in enumerate(tables))
    return tuple(demand for demand in found if demand is not None)


def _demand(place: DocumentPlace, raw: Mapping[str, Any]) -> Demand | None:
    mistakes = len(place.errors)
    table = place.table(DemandTable, raw)
    if table is None:
        return None
    notice, unit = _amount(place / "notice", table.notice)
    if table.operator != OFFSET:
        _check_operator(place / "operator", table.operator)
    if table.site is not None and means_numbers(table.site):
        text = f"{table.site!r} is the number of a mutant, which may change; write file:line or an id"
        (place / "site").error(text)
    if len(place.errors) == mistakes and table.kind is not None:
        (place / "notice").attempt(_check_measure, table.operator, table.kind, unit)
    if len(place.errors) > mistakes:
        return None
    line = place.document.line(place.path)
    source = f"{place.document.file}:{line}" if line is not None else place.document.file
    return Demand(notice, unit, table.site, table.quantity, table.kind, table.operator, source)


def _amount(place: DocumentPlace, notice: str | float) -> tuple[float, str | None]:
    """Return the magnitude and its unit; (0, None) if they cannot be read, which is noted."""
    try:
        return parse_amount(notice if isinstance(notice, str) else f"{notice:g}")
    except KeyError as error:
        place.unknown("unit", str(error.args[0]), UNITS)
    except ValueError as error:
        place.error(str(error))
    return 0.0, None


def _check_operator(place: DocumentPlace, name: str) -> None:
    from mutabot.faults import brought_providers  # noqa: PLC0415  # few configurations name one
    from mutabot.operators import load_all  # noqa: PLC0415  # as above

    rules = chain(load_all(), (rule for provider in brought_providers() for rule in provider.rules()))
    known = [rule.name for rule in rules if rule.has_sizes]
    if name not in known:
        place.error(unknown_name_text("graded operator", name, [*known, OFFSET]))


def _check_measure(operator: str, kind: Kind, unit: str | None) -> None:
    """Raise ValueError for a unit that no fault of this kind has."""
    own = measures_of(kind)
    units = units_of(own if operator == OFFSET else (*own, *OF_ANY))
    if unit is None and units:
        raise ValueError(f"a {kind} has a unit; write it behind the number: {', '.join(units)}")
    if unit is not None and unit not in units:
        text = f"use {', '.join(units)}" if units else "it has no unit"
        raise ValueError(f"{unit!r} measures no {operator} of a {kind}; {text}")
