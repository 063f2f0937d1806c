"""Graded faults as edits of the source text, from the documented meaning of each operator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .editor import CallEditor, Edit

#: the operators that it writes
OPERATORS = frozenset({"offset", "scale", "sensor-noise", "drift", "quantise", "deadband", "lag", "early"})
GRADED = '__import__("_planted_graded")'
#: in the SI's units, or fractions
SIZES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "um": 1e-6, "rad": 1.0, "deg": 0.017453292519943295, "s": 1.0,
         "ms": 0.001, "fraction": 1.0, "percent": 0.01, "N": 1.0, "m/s": 1.0, "mm/s": 0.001}  # fmt: skip


class CannotSayError(Exception):
    """Why there is no edit."""


def edit(editor: CallEditor, mutant: Mapping[str, Any]) -> Edit:
    """The edit of one graded mutant. Raises CannotSayError where there is none."""
    if mutant["operator"] == "lag":
        return _later(editor, mutant)
    quantity = editor._quantity()
    direction = mutant["direction"] or ""
    component = direction.rstrip("+-")
    if component and not component.startswith("["):
        raise CannotSayError("an orientation as a whole")
    size = _size(mutant, quantity)
    size = -size if direction.endswith("-") and mutant["operator"] != "early" else size
    low, high = quantity.get("range") or (float("-inf"), float("inf"))
    index = int(component.strip("[]")) if component else None
    whole = quantity["kind"] == "count"
    limits = f"{_number(low)}, {_number(high)}, {whole}"
    what = f"{GRADED}.partial({GRADED}.numbers, {index}, {limits}"
    change = f"{what}, {_change(editor, mutant, size, quantity)})"
    group = editor.operation.get("result", {})
    is_read = mutant["quantity"] == "result" or any(
        mutant["quantity"].partition("[")[0] == path.partition("[")[0] for path in group
    )
    if is_read:
        return editor._result(change)
    name = mutant["quantity"]
    given = {keyword.arg for keyword in editor.call.keywords}
    if name.isidentifier() and editor.pattern is None and name in editor._parameters():
        place = editor._parameters().index(name)
        if name not in given and place >= len(
            editor.call.args
        ):  # its default, which a person would write out
            return editor._with_callee(f"{GRADED}.with_default({editor._callee()}, {name!r}, {change})")
    return editor._argument(change)


def _size(mutant: Mapping[str, Any], quantity: Mapping[str, Any]) -> float:
    unit = mutant["unit"]
    if mutant["operator"] == "drift":
        unit = unit.removesuffix("/s") or None
    if unit is None:
        return float(mutant["magnitude"])
    if unit not in SIZES:
        raise CannotSayError(f"unit {unit}")
    own = quantity.get("unit")
    per = 1.0 if mutant["operator"] == "scale" or own is None else SIZES[own]
    return float(mutant["magnitude"] * SIZES[unit] / per)


def _number(value: float) -> str:
    return f'float("{value}")'


def _change(editor: CallEditor, mutant: Mapping[str, Any], size: float, quantity: Mapping[str, Any]) -> str:
    match mutant["operator"]:
        case "offset":
            return f"lambda value: value + {size!r}"
        case "scale":
            return f"lambda value: value * (1.0 + {size!r})"
        case "sensor-noise":
            return f"{GRADED}.partial({GRADED}.noisy, {size!r})"
        case "quantise":
            return f"{GRADED}.partial({GRADED}.in_steps, {size!r})"
        case "early":
            return f"{GRADED}.partial({GRADED}.shorter, {size!r})"
        case "deadband":
            relative = quantity.get("mode") == "by"
            return f"{GRADED}.partial({GRADED}.with_deadband, {size!r}, {mutant['ladder']!r}, {relative})"
        case "drift":
            return f"lambda value: value + {size!r} * {_hint(editor, 'time')}"
    raise CannotSayError(f"operator {mutant['operator']}")


def _hint(editor: CallEditor, name: str) -> str:
    """An expression of the project that tells the time, or lets it pass."""
    told = editor.facts.hints.get(name)
    if told is None:
        raise CannotSayError(f"judge.toml says no {name}")
    return f"({told})"


def _later(editor: CallEditor, mutant: Mapping[str, Any]) -> Edit:
    if editor.is_async:
        raise CannotSayError("an async call")
    seconds = mutant["magnitude"] * SIZES[mutant["unit"]]
    told = editor.operation
    is_command = told.get("command", bool(told.get("arguments")) or not told.get("result"))
    when = "before" if is_command else "after"
    wait = f"lambda SECONDS: {_hint(editor, 'wait')}"
    return editor._with_callee(f"{GRADED}.{when}({wait}, {seconds!r}, {editor._callee()})")
