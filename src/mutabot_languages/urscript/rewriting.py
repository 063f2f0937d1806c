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
from mutabot_languages.mutation.rewriting import Rewriter, named_number, signed_number
from mutabot_languages.mutation.wording import Wording

_MOTIONS = name_set("movej movel movep movec")
_POSES = name_set(
    "pose_trans pose_add pose_sub pose_inv interpolate_pose get_actual_tcp_pose get_target_tcp_pose"
)
_OUTPUT = re.compile(r"set_\w*digital_out")
_INPUT = re.compile(r"get_\w*digital_in")
_SIGNAL = re.compile(r"[gs]et_\w*(?:digital|analog|flag)\w*")


class UrRewriter(Rewriter):
    """The rewriter of URScript."""

    wording: ClassVar = Wording(
        ("==", "!="), ("and", "or", "xor"), ("True", "False"), "not ({})", "norm({})", "sleep(1/0)",
        arithmetic=("+", "-", "*", "/", "%"),
    )  # fmt: skip
    nothing: ClassVar = "pass"
    known_types: ClassVar = dict.fromkeys(
        (f"get_{kind}_digital_in()" for kind in ("standard", "configurable", "tool")), "truth"
    )

    def note_type(self, node: ProgramNode) -> None:
        """Give a variable the type of what it is assigned."""
        if node.kind == "assign" and node.parts[0].kind == "name":
            self.add_type(node.parts[0].name, self.kind_of(node.parts[1]))
        super().note_type(node)

    def kind_of(self, node: ProgramNode) -> str:
        """Return the type of an expression; a list of numbers is an array."""
        if node.kind == "pose" or (node.kind == "call" and node.name in _POSES):
            return "pose"
        if node.kind == "list" and node.parts and all(self.kind_of(part) == "number" for part in node.parts):
            return "number[]"
        return super().kind_of(node)

    def is_amount(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number is an amount; the first argument for a signal says which."""
        call = parents[-1]
        return not (_SIGNAL.fullmatch(call.name) and call.parts[0] is node)

    def has_value(self, name: str, node: ProgramNode) -> bool:
        """Return whether an assignment stands before a node."""
        return self._first_assigned.get(name, -1) < node.start

    @cached_property
    def _first_assigned(self) -> dict[str, int]:
        nodes = [node for node in self.program.parsed.tree.walk() if node.kind == "assign"]
        return {node.parts[0].name: node.end for node in reversed(nodes)}

    @cached_property
    def _first_label(self) -> int:
        """Where a program that PolyScope has written begins to be its user's."""
        nodes = self.program.parsed.tree.walk()
        return min((node.start for node in nodes if (node.kind, node.name) == ("empty", "label")), default=-1)

    def is_generated(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a node is a function of a URCap, or what PolyScope writes before the program."""
        if any(outer.kind == "routine" and outer.name.startswith(("rq_", "$")) for outer in (*parents, node)):
            return True
        return node.start < self._first_label and node.kind != "routine"

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Return whether a statement is a motion, output, pause or setting."""
        return node.kind == "call" and (
            node.name in _MOTIONS or bool(_OUTPUT.match(node.name)) or node.name in ("sleep", "set_tcp")
            or node.name.startswith(("rq_", "set_standard_analog", "set_tool_analog"))
        )  # fmt: skip

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """Yield the differences that are about a call, an assignment of a pose, or a loop that waits."""
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
            yield from self.sized("shift-point", node, point, self._literal)
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
        options = {name: option.parts[0] for name, option in node.options.items()}
        speeds = [options["v"]] if "v" in options else [] if node.name == "movec" else node.plain[2:3]
        for speed in speeds:
            yield from self.scaled("scale-speed", node, speed, (0.1, 2.0))
        if "r" in options and options["r"].kind == "number":
            edits = self.put(options["r"], "0" if options["r"].value else "0.05")
            yield TextChange("change-blend", node, edits)

    def _swapped(self, node: ProgramNode) -> Iterator[TextChange]:
        """Yield the other motion, without acceleration and speed, whose units are others."""
        other = {"movej": "movel", "movel": "movej"}[node.name]
        kept = [node.parts[0], *(option for name, option in node.options.items() if name in ("r", "t"))]
        edits = (
            Edit(node.start, node.start + len(node.name), other),
            Edit(node.parts[0].start, node.parts[-1].end, ", ".join(map(self.written, kept))),
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
                call.parts[0]
                for call in self.program.parsed.tree.walk()
                if call.kind == "call" and call.name == node.name
            )
            for other in self.next_number(number, alike):
                yield TextChange("other-input", node, self.put(number, other))

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """Return the edits of a number of a literal, or a pose_trans around the target."""
        if target.kind == "pose":
            return self._literal(target, axis, metres)
        return self._wrapped(target, axis, metres)

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """Return a pose_trans around the target: a number of a rotation vector is no rotation."""
        return self._wrapped(target, axis + 3, math.radians(degrees))

    def _wrapped(self, target: ProgramNode, place: int, amount: float) -> tuple[Edit, ...] | None:
        if self.kind_of(target) != "pose":
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
