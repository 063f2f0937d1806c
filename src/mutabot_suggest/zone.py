"""A zone of moments, the condition that a moment lies outside it, and a name of that."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .bands import digits_of
from .tick_recorder import PEAKS

#: what says how far a gripper is open: it has two states, and its zones are those of things let go or held
GATE = re.compile(r"opening|aperture", re.I)
#: a coordinate of a position; and what stands between those of two things whose distance says who slips
COORDINATE = re.compile(r"(\w+)_position\(\)\.[xyz]$")
FROM = " - "

#: numbers by expression, moment by moment
Columns = Mapping[str, Sequence[float]]


@dataclass(frozen=True, slots=True)
class Bound:
    """One bound of a zone.

    Attributes:
        text: the reading.
        sign: 1 for values above it, -1 for values below.
        scale: the margin that counts as clear of the original.
        middle: the value from which the distance is bounded, in either direction; None where the reading is.
    """

    text: str
    sign: int
    scale: float
    middle: float | None = None

    def of(self, value: float) -> float:
        """Return what is bounded of a reading's value: itself, or its distance from the middle."""
        return value if self.middle is None else abs(value - self.middle)

    @property
    def expression(self) -> str:
        """What is bounded, as it stands in the condition: ``abs(a - b - 0.9)``."""
        if self.middle is None:
            return self.text
        offset = f" {'-' if self.middle > 0 else '+'} {_number(abs(self.middle))}" if self.middle else ""
        return f"abs({self.text}{offset})"


@dataclass(frozen=True, slots=True)
class Zone:
    """The moments at which all readings are beyond their bounds."""

    sides: tuple[Bound, ...]
    bounds: tuple[float, ...]
    distance: float

    @property
    def is_slip(self) -> bool:
        """Whether it is that of a thing that moves in the fingers."""
        return FROM in self.sides[0].text

    @property
    def is_release(self) -> bool:
        """Whether it is that of a thing let go."""
        return not self.is_slip and any(GATE.search(side.text) for side in self.sides)

    def has(self, columns: Columns) -> bool:
        """Return whether any moment lies in the zone."""
        rows = zip(*(columns[side.text] for side in self.sides), strict=True)
        return any(
            all(
                side.sign * side.of(value) >= side.sign * bound
                for side, value, bound in zip(self.sides, row, self.bounds, strict=True)
            )
            for row in rows
        )

    @property
    def condition(self) -> str:
        """The condition that a moment lies outside the zone: ``a < 0.6 or b > 0.2``."""
        return " or ".join(
            f"{side.expression} {'<' if side.sign > 0 else '>'} {_number(bound)}"
            for side, bound in zip(self.sides, self.bounds, strict=True)
        )

    @property
    def name(self) -> str:
        """A description of the condition for people."""
        first, bound = self.sides[0], self.bounds[0]
        limit = f"{'below' if first.sign > 0 else 'above'} {_number(bound)}"
        if self.is_slip:
            match = COORDINATE.search(first.text.partition(FROM)[0])
            return f"{match[1] if match else 'nothing'} stays in its place between the fingers"
        if self.is_release:
            return f"{_thing(first.text)} is {limit} when the gripper opens"
        if PEAKS.search(first.text):
            limit += " N" if first.text.endswith("force") else " m/s"
        return f"{_thing(first.text)} stays {limit}"


def _number(value: float) -> str:
    text = repr(value)
    return text.removesuffix(".0") if digits_of(value) else text


def _thing(text: str) -> str:
    """Return a short name of a reading: ``tool x`` for ``cell.truth.tool_position().x``."""
    call, _, part = text.rpartition(").")
    name = (call or text).partition("(")[0].rpartition(".")[2]
    name = name.removesuffix("_position").removesuffix("_pose")
    if (name, part) == ("wrench", "force"):
        return "force on the tool"
    return f"{name} {part}".replace("_", " ").strip() if call else name.replace("_", " ")
