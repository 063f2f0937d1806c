"""How operators rewrite a program, as far as that is the same in all languages."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit

from .differences import ProgramFile, TextChange
from .wording import Wording

#: the usual magnitudes of a shifted point, mm, and of a turned one, degrees
SHIFTS = (1.0, 5.0, 20.0, 50.0)
TURNS = (2.0, 10.0, 45.0)
AXES = ("x", "y", "z")
#: what functions of all languages return
_OF_NUMBERS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sqrt", "abs", "norm", "round", "trunc", "floor",
    "ceil", "pow", "min", "max", "d2r", "r2d", "to_num", "length", "clkread", "distance",
)  # fmt: skip
_PLAIN_TYPES = {
    "num": "number", "dnum": "number", "int": "number", "real": "number", "bool": "truth", "string": "text",
    "char": "text",
}  # fmt: skip
_OF_TRUTH = frozenset(("<", "<=", ">", ">=", "=", "==", "<>", "!=", "and", "or", "xor", "exor", "not"))
_COMPONENT = re.compile(r"[xyzabc]|[ae][1-6]|q[1-4]|rax_[1-6]|eax_[a-f]|cp")
#: the edits that change a pose along or about an axis by an amount; None if that is unknown
_PoseChange = Callable[[ProgramNode, int, float], tuple[Edit, ...] | None]


@dataclass(frozen=True, slots=True)
class Sizes:
    """Which magnitudes of faults with sizes are made: the usual ones, or one that is asked for."""

    shifts: Sequence[float] = SHIFTS
    turns: Sequence[float] = TURNS

    @classmethod
    def only(cls, size: float) -> Sizes:
        """Return this magnitude alone."""
        return cls((size,), (size,))


class Rewriter:
    """Makes the differences of a file.

    Class attributes:
        wording: how the language writes what conventional operators put into a program.
        nothing: what stands for a statement that is missing.
        opposites: values of signals, in small letters, and their contraries.
        known_types: of names that the language brings, as ``types`` has them.

    Attributes:
        types: by name, ``number``, ``truth``, ``text``, or the type that the program declares; with ``()`` of
            what a function returns, with ``[]`` of an array of these; empty if there are several.
    """

    wording: ClassVar[Wording]
    nothing: ClassVar[str] = ""
    opposites: ClassVar[Mapping[str, str]] = {"true": "FALSE", "false": "TRUE"}
    known_types: ClassVar[Mapping[str, str]] = {}

    def __init__(self, program: ProgramFile, sizes: Sizes | None = None) -> None:
        self.program, self.text = program, program.text
        self.sizes = sizes or Sizes()
        self.types = {**{f"{name}()": "number" for name in _OF_NUMBERS}, **self.known_types}
        for node in self.all_nodes():
            self.note_type(node)

    def note_type(self, node: ProgramNode) -> None:
        """Note the type of what a node declares."""
        if node.kind in ("declare", "parameter", "routine") and isinstance(node.value, dict):
            type: str = node.value["type"]
            suffix = "[]" if node.value.get("sizes") else ""
            if type:
                name = f"{node.name}()" if node.kind == "routine" else node.name
                self.add_type(name, _PLAIN_TYPES.get(type, type) + suffix)
        elif node.kind == "for":
            self.add_type(node.name, "number")

    def add_type(self, name: str, type: str) -> None:
        """Add the type of a name; of two, none is known."""
        self.types[name] = type if self.types.get(name, type) == type else ""

    def kind_of(self, node: ProgramNode) -> str:
        """Return the type of an expression, as ``types`` has it; empty if the program does not say."""
        kind, name = node.kind, node.name
        if kind in ("number", "text"):
            return kind
        if kind == "constant":
            return "truth" if isinstance(node.value, bool) else ""
        if kind == "group":
            return self.kind_of(node.parts[0])
        if kind in ("unary", "binary"):
            if name in _OF_TRUTH:
                return "truth"
            kinds = {self.kind_of(part) for part in node.parts}
            return kinds.pop() if len(kinds) == 1 else ""
        if kind == "index":
            of = self.kind_of(node.parts[0])
            return "number" if of == "pose" else of.removesuffix("[]")
        if kind == "field":
            return "number" if _COMPONENT.fullmatch(name) else ""
        return self.types.get(f"{name}()" if kind == "call" else name, "") if kind in ("name", "call") else ""

    def has_value(self, name: str, node: ProgramNode) -> bool:
        """Return whether a variable that a routine names has a value at a node."""
        return True

    def is_amount(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number says how much, how far or where, rather than which."""
        return True

    def differences(self) -> Iterator[TextChange]:
        """Yield the differences of robot operators in the file."""
        for node, parents in self.nodes():
            yield from self.of_node(node, parents)

    def all_nodes(self) -> Iterator[ProgramNode]:
        """Yield the nodes of all files of the program, this one's last."""
        for file in (*self.program.others, self.program):
            yield from file.parsed.tree.walk()

    def nodes(self) -> Iterator[tuple[ProgramNode, tuple[ProgramNode, ...]]]:
        """Yield the nodes that no tool has written, and those around each, in the order of the text."""
        waiting: list[tuple[ProgramNode, tuple[ProgramNode, ...]]] = [(self.program.parsed.tree, ())]
        while waiting:
            node, parents = waiting.pop()
            if parents and not self.is_generated(node, parents):
                yield node, parents
            inner = (*parents, node)
            below = [*node.parts, *(statement for body in node.bodies for statement in body)]
            waiting.extend((part, inner) for part in sorted(below, key=lambda part: part.start, reverse=True))

    # what a language says

    def is_generated(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a node stands in a part of the file that a tool has written."""
        return False

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """Return the differences of robot operators that are about a node."""
        raise NotImplementedError

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """Return the edits that shift a pose along an axis; None if that is unknown."""
        raise NotImplementedError

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """Return the edits that turn a pose about an axis of its own; None if that is unknown."""
        raise NotImplementedError

    # what they share

    def written(self, node: ProgramNode) -> str:
        """Return a node as it stands in the text."""
        return self.text[node.start : node.end]

    def put(self, node: ProgramNode, text: str) -> tuple[Edit, ...]:
        """Return the edit that puts a text in the place of a node."""
        return (Edit(node.start, node.end, text),)

    def next_number(self, number: ProgramNode, alike: Iterable[ProgramNode]) -> Iterator[str]:
        """Yield the next of the numbers that stand in places like this one, if there is another.

        Of what a program nowhere names, nothing says what it would be.
        """
        numbers = {int(node.value) for node in alike if node.kind == "number"}
        others = sorted(numbers - {int(number.value)}, key=lambda other: (other < number.value, other))
        yield from map(str, others[:1])

    def without(self, node: ProgramNode) -> tuple[Edit, ...]:
        """Return the edit that takes a statement out."""
        return (Edit(node.start, node.end, self.nothing),)

    def sized(
        self, operator: str, node: ProgramNode, subject: ProgramNode, change: _PoseChange
    ) -> Iterator[TextChange]:
        """Yield a fault with sizes, along or about each axis, both ways."""
        is_turn = operator == "turn-target"
        sizes, unit = (self.sizes.turns, "deg") if is_turn else (self.sizes.shifts, "mm")
        for axis, name in enumerate(AXES):
            for sign in ("+", "-"):
                for size in sizes:
                    edits = change(subject, axis, float(f"{sign}{size * (1 if is_turn else 0.001):.9g}"))
                    if edits is not None:
                        yield TextChange(operator, node, edits, f"{name}{sign}", size, unit)

    def moved(self, node: ProgramNode, target: ProgramNode) -> Iterator[TextChange]:
        """Yield the differences of a motion's target."""
        yield from self.sized("shift-target", node, target, self.shifted)
        yield from self.sized("turn-target", node, target, self.turned)

    def reversed(self, node: ProgramNode, amounts: Sequence[ProgramNode]) -> Iterator[TextChange]:
        """Yield offsets along x, y and z with the other sign."""
        for axis, amount in zip(AXES, amounts, strict=False):
            value = signed_number(amount)
            if value:
                yield TextChange("reverse-offset", node, self.put(amount, named_number(-value)), axis)

    def opposite(self, operator: str, node: ProgramNode, value: ProgramNode) -> Iterator[TextChange]:
        """Yield the other value of a signal, if it is written out."""
        text = self.opposites.get(self.written(value).lower())
        if text is not None:
            yield TextChange(operator, node, self.put(value, text))

    def scaled(
        self, operator: str, node: ProgramNode, number: ProgramNode, factors: Sequence[float]
    ) -> Iterator[TextChange]:
        """Yield a number that is multiplied."""
        if number.kind != "number" or not number.value:
            return
        for factor in factors:
            text = f"{float(number.value) * factor:.6g}"
            yield TextChange(operator, node, self.put(number, text), f"×{factor:g}")

    def is_statement(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a node stands by itself."""
        if parents[-1].kind == "if" and parents[-1].name == "compact":  # it has to have one
            return False
        return any(statement is node for body in parents[-1].bodies for statement in body)

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Return whether the robot or its signals take part in a statement: another operator drops these."""
        return False

    def is_plain_number(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number is one of a calculation, a comparison or an assignment."""
        return parents[-1].kind in ("binary", "assign", "for")


def signed_number(node: ProgramNode) -> float | None:
    """Return the value of a number with or without a sign; None for anything else."""
    if node.kind == "number":
        return float(node.value)
    if node.kind == "unary" and node.name in "+-" and node.parts[0].kind == "number":
        return -float(node.parts[0].value) if node.name == "-" else float(node.parts[0].value)
    return None


def named_number(value: float) -> str:
    """Return a number as programs write it, without a tail of zeros."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
