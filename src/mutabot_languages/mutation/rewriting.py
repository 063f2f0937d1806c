"""How operators rewrite a program, as far as that is the same in all languages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit

from .differences import ProgramFile, TextChange

#: the usual magnitudes of a shifted point, mm, and of a turned one, degrees
SHIFTS = (1.0, 5.0, 20.0, 50.0)
TURNS = (2.0, 10.0, 45.0)
AXES = ("x", "y", "z")
#: what stands for a comparison by order, in all languages
ORDERS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<")}
NO_BLENDING = "corners are not rounded here, so that it cannot be observed"
NO_CONFIGURATION = "the arm takes the nearest configuration here, so that it cannot be observed"


@dataclass(frozen=True, slots=True)
class Sizes:
    """Which magnitudes of faults with sizes are made: the usual ones, or one that is asked for."""

    shifts: Sequence[float] = SHIFTS
    turns: Sequence[float] = TURNS

    @classmethod
    def only(cls, size: float) -> Sizes:
        """This magnitude alone."""
        return cls((size,), (size,))


class Rewriter:
    """Makes the differences of a file.

    Class attributes:
        arithmetic, relations, logic: operators that stand for each other.
        negation: how a condition is negated, around ``{}``.
        nothing: what stands for a statement that is missing.
        opposites: values of signals, in small letters, and their contraries.
        ignores_case: whether operators may be written in capital letters.
    """

    arithmetic: ClassVar[tuple[str, ...]] = ("+", "-", "*", "/")
    relations: ClassVar[Mapping[str, tuple[str, ...]]]
    logic: ClassVar[Mapping[str, str]] = {"and": "OR", "or": "AND"}
    negation: ClassVar[str] = "NOT ({})"
    nothing: ClassVar[str] = ""
    opposites: ClassVar[Mapping[str, str]] = {"true": "FALSE", "false": "TRUE"}
    ignores_case: ClassVar[bool] = True

    def __init__(self, program: ProgramFile, sizes: Sizes | None = None) -> None:
        self.program, self.text = program, program.text
        self.sizes = sizes or Sizes()

    def differences(self) -> Iterator[TextChange]:
        """All of the file, in the order of its text as far as that is one."""
        for node, parents in self._nodes():
            if self.is_generated(node, parents):
                continue
            yield from self.of_node(node, parents)
            yield from self.conventional(node, parents)

    def all_nodes(self) -> Iterator[ProgramNode]:
        """The nodes of all files of the program, this one's last."""
        for file in (*self.program.others, self.program):
            yield from file.parsed.tree.walk()

    @cached_property
    def declared_types(self) -> dict[str, str]:
        """The types of all data that the program declares, by name."""
        return {node.name: node.value["type"] for node in self.all_nodes() if node.kind == "declare"}

    def _nodes(self) -> Iterator[tuple[ProgramNode, tuple[ProgramNode, ...]]]:
        waiting: list[tuple[ProgramNode, tuple[ProgramNode, ...]]] = [(self.program.parsed.tree, ())]
        while waiting:
            node, parents = waiting.pop()
            if parents:
                yield node, parents
            inner = (*parents, node)
            below = [*node.parts, *(statement for body in node.bodies for statement in body)]
            waiting.extend((part, inner) for part in sorted(below, key=lambda part: part.start, reverse=True))

    # what a language says

    def is_generated(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Whether a node stands in a part of the file that a tool has written."""
        return False

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """The differences of robot operators that are about a node."""
        raise NotImplementedError

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """The edits that shift a pose along an axis; None if nobody knows how."""
        raise NotImplementedError

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """The edits that turn a pose about an axis of its own; None if nobody knows how."""
        raise NotImplementedError

    # what they share

    def written(self, node: ProgramNode) -> str:
        """A node as it stands in the text."""
        return self.text[node.start : node.end]

    def put(self, node: ProgramNode, text: str) -> tuple[Edit, ...]:
        """The edit that puts a text in the place of a node."""
        return (Edit(node.start, node.end, text),)

    def next_number(self, number: ProgramNode, alike: Iterable[ProgramNode]) -> Iterator[str]:
        """Yield the next of the numbers that stand in places like this one, if there is another.

        Of what a program nowhere names, nothing says what it would be.
        """
        numbers = {int(node.value) for node in alike if node.kind == "number"}
        others = sorted(numbers - {int(number.value)}, key=lambda other: (other < number.value, other))
        yield from map(str, others[:1])

    def without(self, node: ProgramNode) -> tuple[Edit, ...]:
        """The edit that takes a statement out."""
        return (Edit(node.start, node.end, self.nothing),)

    def sized(
        self,
        operator: str,
        node: ProgramNode,
        subject: ProgramNode,
        change: Callable[[ProgramNode, int, float], tuple[Edit, ...] | None],
        sizes: Sequence[float],
        unit: str,
        factor: float,
    ) -> Iterator[TextChange]:
        """A fault with sizes, along each axis, both ways."""
        for axis, name in enumerate(AXES):
            for sign in ("+", "-"):
                for size in sizes:
                    edits = change(subject, axis, float(f"{sign}{size * factor:.9g}"))
                    if edits is not None:
                        yield TextChange(operator, node, edits, f"{name}{sign}", size, unit)

    def moved(self, node: ProgramNode, target: ProgramNode) -> Iterator[TextChange]:
        """The differences of a motion's target."""
        yield from self.sized("shift-target", node, target, self.shifted, self.sizes.shifts, "mm", 0.001)
        yield from self.sized("turn-target", node, target, self.turned, self.sizes.turns, "deg", 1.0)

    def reversed(self, node: ProgramNode, amounts: Sequence[ProgramNode]) -> Iterator[TextChange]:
        """Offsets along x, y and z that go the other way."""
        for axis, amount in zip(AXES, amounts, strict=False):
            value = signed_number(amount)
            if value:
                yield TextChange("reverse-offset", node, self.put(amount, named_number(-value)), axis)

    def opposite(self, operator: str, node: ProgramNode, value: ProgramNode) -> Iterator[TextChange]:
        """The other value of a signal, if it is written out."""
        text = self.opposites.get(self.written(value).lower())
        if text is not None:
            yield TextChange(operator, node, self.put(value, text))

    def scaled(
        self, operator: str, node: ProgramNode, number: ProgramNode, factors: Sequence[float]
    ) -> Iterator[TextChange]:
        """A number that is multiplied."""
        if number.kind != "number" or not number.value:
            return
        for factor in factors:
            text = f"{float(number.value) * factor:.6g}"
            yield TextChange(operator, node, self.put(number, text), f"×{factor:g}")

    def conventional(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """The differences of conventional operators that are about a node."""
        if node.kind == "binary":
            yield from self._operators(node)
        if node.kind in ("if", "while", "repeat"):
            for index, condition in enumerate(node.parts):
                text = self.negation.format(self.written(condition))
                yield TextChange("negate-condition", condition, self.put(condition, text), str(index or ""))
        if node.kind == "number" and self.is_plain_number(node, parents):
            yield from self._numbers(node)
        is_dropped = node.kind in ("assign", "return", "break", "continue", "goto", "call")
        if is_dropped and self.is_statement(node, parents) and not self.is_of_robot(node):
            yield TextChange("drop-any", node, self.without(node))

    def is_statement(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Whether a node stands by itself."""
        if parents[-1].kind == "if" and parents[-1].name == "compact":  # it has to have one
            return False
        return any(statement is node for body in parents[-1].bodies for statement in body)

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Whether the robot or its signals take part in a statement: an operator of its own drops these."""
        return False

    def is_plain_number(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Whether a number is one of a calculation, a comparison or an assignment."""
        return parents[-1].kind in ("binary", "assign", "for")

    def _operators(self, node: ProgramNode) -> Iterator[TextChange]:
        left, right = node.parts
        between = self.text[left.end : right.start]
        start = (between.lower() if self.ignores_case else between).find(node.name)
        if start < 0:
            return
        for operator, others in (
            ("replace-arithmetic", self.arithmetic if node.name in self.arithmetic else ()),
            ("replace-relation", self.relations.get(node.name, ())),
            ("replace-logic", (self.logic[node.name],) if node.name in self.logic else ()),
        ):
            for other in others:
                if other != node.name and not self._is_text(node):
                    edit = Edit(left.end + start, left.end + start + len(node.name), other)
                    yield TextChange(operator, node, (edit,), other)

    def _is_text(self, node: ProgramNode) -> bool:
        return any(part.kind == "text" for part in node.walk())

    def _numbers(self, node: ProgramNode) -> Iterator[TextChange]:
        texts = {"0": "0", "plus": f"{node.value + 1:g}"} if isinstance(node.value, (int, float)) else {}
        for variant, text in texts.items():
            if float(text) != float(node.value):
                yield TextChange("replace-number", node, self.put(node, text), variant)


def signed_number(node: ProgramNode) -> float | None:
    """The value of a number with or without a sign; None for anything else."""
    if node.kind == "number":
        return float(node.value)
    if node.kind == "unary" and node.name in "+-" and node.parts[0].kind == "number":
        return -float(node.parts[0].value) if node.name == "-" else float(node.parts[0].value)
    return None


def named_number(value: float) -> str:
    """A number as programs write it, without a tail of zeros."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
