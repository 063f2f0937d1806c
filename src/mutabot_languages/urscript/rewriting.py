"""How a mutant of a URScript program reads."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import cached_property
from typing import ClassVar

from mutabot_languages.core.names import name_set
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit
from mutabot_languages.mutation.differences import TextChange
from mutabot_languages.mutation.rewriting import (
    NO_BLENDING,
    ORDERS,
    Rewriter,
    named_number,
    signed_number,
)

_MOTIONS = name_set("movej movel movep movec")
_POSES = name_set(
    "pose_trans pose_add pose_sub pose_inv interpolate_pose get_actual_tcp_pose get_target_tcp_pose"
)
_OUTPUT = re.compile(r"set_\w*digital_out")
_INPUT = re.compile(r"get_\w*digital_in")


class UrRewriter(Rewriter):
    """The rewriter of URScript."""

    relations: ClassVar = {**ORDERS, "==": ("!=",), "!=": ("==",)}
    logic: ClassVar = {"and": "or", "or": "and"}
    negation: ClassVar = "not ({})"
    nothing: ClassVar = "pass"
    ignores_case: ClassVar = False

    @cached_property
    def _first_label(self) -> int:
        """Where a program that PolyScope has written begins to be its user's."""
        nodes = self.program.parsed.tree.walk()
        return min((node.start for node in nodes if (node.kind, node.name) == ("empty", "label")), default=-1)

    @cached_property
    def _values(self) -> dict[str, ProgramNode]:
        """The last value that is assigned to each name."""
        assigned = (node.parts for node in self.all_nodes() if node.kind == "assign")
        return {target.name: value for target, value in assigned if target.kind == "name"}

    def is_generated(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Functions of URCaps, and what PolyScope writes before the program."""
        if any(outer.kind == "routine" and outer.name.startswith(("rq_", "$")) for outer in (*parents, node)):
            return True
        return node.start < self._first_label and node.kind != "routine"

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Motions, outputs, pauses and settings."""
        return node.kind == "call" and (
            node.name in _MOTIONS or bool(_OUTPUT.match(node.name)) or node.name in ("sleep", "set_tcp")
            or node.name.startswith(("rq_", "set_standard_analog", "set_tool_analog"))
        )  # fmt: skip

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """The differences that are about a call, an assignment of a pose, or a loop that waits."""
        if node.kind == "call":
            if self.is_of_robot(node) and self.is_statement(node, parents):
                yield TextChange("drop-statement", node, self.without(node))
            if node.name in _MOTIONS and node.parts:
                yield from self._motion(node)
            elif _OUTPUT.match(node.name) and len(node.parts) == 2:
                yield from self._output(node)
            elif _INPUT.match(node.name) and node.parts:
                yield from self._input(node)
            elif node.name == "sleep" and node.parts:
                yield from self.scaled("scale-wait", node, node.parts[0], (0.1, 10.0))
            elif node.name == "set_tcp" and node.parts and node.parts[0].kind == "pose":
                yield TextChange("other-tool", node, self.put(node.parts[0], "p[0, 0, 0, 0, 0, 0]"))
            elif node.name in ("pose_trans", "pose_add", "pose_sub") and len(node.parts) == 2:
                shift = node.parts[1]
                if node.name == "pose_trans":
                    yield TextChange("other-frame", node, self.put(node, self.written(shift)))
                yield from self.reversed(node, shift.parts if shift.kind == "pose" else ())
        elif node.kind == "assign" and node.parts[1].kind == "pose" and len(node.parts[1].parts) == 6:
            point = node.parts[1]
            yield from self.sized("shift-point", node, point, self._literal, self.sizes.shifts, "mm", 0.001)
        elif node.kind == "while" and self._only_waits(node):
            yield TextChange("forget-wait", node, self.put(node.parts[0], "False"))

    def _only_waits(self, node: ProgramNode) -> bool:
        body = node.bodies[0]
        reads = any(part.kind == "call" and _INPUT.match(part.name) for part in node.parts[0].walk())
        return reads and all(
            statement.kind == "call" and statement.name in ("sync", "sleep") for statement in body
        )

    def _motion(self, node: ProgramNode) -> Iterator[TextChange]:
        target = node.parts[0]
        if target.kind == "option":
            target = target.parts[0]
        yield from self.moved(node, target)
        if node.name in ("movej", "movel"):
            yield from self._swapped(node)
        for position, part in enumerate(node.parts[1:], start=1):
            if part.kind == "option" and part.name == "v":
                yield from self.scaled("scale-speed", node, part.parts[0], (0.1, 2.0))
            elif part.kind != "option" and position == 2 and node.name != "movec":
                yield from self.scaled("scale-speed", node, part, (0.1, 2.0))
            elif part.kind == "option" and part.name == "r" and part.parts[0].kind == "number":
                edits = self.put(part.parts[0], "0" if part.parts[0].value else "0.05")
                yield TextChange("change-blend", node, edits, reason=NO_BLENDING)

    def _swapped(self, node: ProgramNode) -> Iterator[TextChange]:
        """The other motion, without acceleration and speed, whose units are others."""
        other = {"movej": "movel", "movel": "movej"}[node.name]
        kept = [self.written(node.parts[0])]
        kept += [
            self.written(part) for part in node.parts[1:] if part.kind == "option" and part.name in ("r", "t")
        ]
        edits = (
            Edit(node.start, node.start + len(node.name), other),
            Edit(node.parts[0].start, node.parts[-1].end, ", ".join(kept)),
        )
        yield TextChange("swap-motion", node, edits)

    def _output(self, node: ProgramNode) -> Iterator[TextChange]:
        value = node.parts[1]
        if value.kind == "constant":
            text = "False" if value.value else "True"
        elif value.kind == "number":
            text = "0" if value.value else "1"
        else:
            text = f"not ({self.written(value)})"
        yield TextChange("invert-output", node, self.put(value, text))

    def _input(self, node: ProgramNode) -> Iterator[TextChange]:
        yield TextChange("invert-input", node, self.put(node, f"(not {self.written(node)})"))
        number = node.parts[0]
        if number.kind == "number":
            alike = (
                call.parts[0] for call, _ in self._nodes() if call.kind == "call" and call.name == node.name
            )
            for other in self.next_number(number, alike):
                yield TextChange("other-input", node, self.put(number, other))

    def is_pose(self, target: ProgramNode, depth: int = 0) -> bool:
        """Whether an expression is a pose, by its last assignment."""
        if target.kind == "pose" or (target.kind == "call" and target.name in _POSES):
            return True
        value = self._values.get(target.name) if target.kind == "name" else None
        return value is not None and depth < 5 and self.is_pose(value, depth + 1)

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """A number of a literal, or a pose_trans around the target."""
        if target.kind == "pose":
            return self._literal(target, axis, metres)
        return self._wrapped(target, axis, metres)

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """A pose_trans around the target: a number of a rotation vector is no rotation."""
        return self._wrapped(target, axis + 3, math.radians(degrees))

    def _wrapped(self, target: ProgramNode, place: int, amount: float) -> tuple[Edit, ...] | None:
        if not self.is_pose(target):
            return None
        amounts = ["0"] * 6
        amounts[place] = named_number(amount)
        return self.put(target, f"pose_trans({self.written(target)}, p[{', '.join(amounts)}])")

    def _literal(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        part = target.parts[axis]
        value = signed_number(part)
        if value is None:
            return self.put(
                part, f"{self.written(part)} {'+' if metres > 0 else '-'} {named_number(abs(metres))}"
            )
        return self.put(part, named_number(value + metres))
