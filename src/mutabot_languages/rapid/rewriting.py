"""How a mutant of a RAPID program reads."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import ClassVar

from mutabot_languages.core.names import name_set
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit
from mutabot_languages.mutation.differences import TextChange
from mutabot_languages.mutation.rewriting import Rewriter, named_number, signed_number
from mutabot_languages.mutation.wording import Wording

_MOTION = re.compile(r"move(?:j|l|c|absj)(?:do|ao|go|sync)?")
_SPEEDS = (
    5, 10, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800, 1000, 1500, 2000, 2500, 3000,
)  # fmt: skip
_OF_ROBOT = name_set(
    """set reset setdo setgo setao pulsedo invertdo waittime waitdi waitdo waitgi waitgo waitai waitao
    waituntil pdispset pdispoff"""
)
_WAITS = name_set("waitdi waitdo waitgi waitgo waitai waitao waituntil")
_OPPOSITE = {"set": "Reset", "reset": "Set"}


class RapidRewriter(Rewriter):
    """The rewriter of RAPID."""

    wording: ClassVar = Wording(
        ("=", "<>"), ("AND", "OR", "XOR"), ("TRUE", "FALSE"), "NOT ({})", "Abs({})", "WaitTime 1/0",
        arithmetic=("+", "-", "*", "/", "DIV", "MOD"),
        functions={
            "replace-bitwise": ("BitAnd", "BitOr", "BitXOr"), "replace-shift": ("BitLSh", "BitRSh"),
            "replace-assignment": ("Incr", "Decr"),
        },
    )  # fmt: skip
    known_types: ClassVar = {
        "testdi()": "truth", "dinput()": "number", "doutput()": "number",
        **dict.fromkeys(("offs()", "reltool()", "crobt()", "calcrobt()"), "robtarget"),
    }  # fmt: skip
    opposites: ClassVar = {
        "0": "1", "1": "0", "high": "low", "low": "high", "true": "FALSE", "false": "TRUE",
    }  # fmt: skip

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Return whether a statement is a motion, output, wait or displacement."""
        return node.kind == "call" and (node.name in _OF_ROBOT or bool(_MOTION.fullmatch(node.name)))

    def is_amount(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a literal of a point says where it is; False for tools, work objects etc."""
        lists = [outer for outer in parents if outer.kind == "list"]
        if len(lists) < 2:
            return not lists or node.kind != "constant"
        first, second = lists[:2]
        return len(first.parts) == 2 or (len(first.parts) == 4 and second in first.parts[:2])

    def is_plain_number(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number is plain; those of declarations count, but not those of structures."""
        is_number = parents[-1].kind == "declare" and parents[-1].value["type"] in ("num", "dnum")
        return is_number or super().is_plain_number(node, parents)

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """Yield the differences that are about an instruction, a function of a signal, or a declaration."""
        if node.kind == "call":
            if self.is_of_robot(node) and self.is_statement(node, parents):
                yield TextChange("drop-statement", node, self.without(node))
            yield from self._call(node)
        elif node.kind == "declare" and node.parts and node.value["type"] == "robtarget":
            yield from self._point(node, node.parts[0])
        elif node.kind == "binary" and node.name == "=":
            yield from self._compared(node)

    def _call(self, node: ProgramNode) -> Iterator[TextChange]:
        plain = node.plain
        if _MOTION.fullmatch(node.name):
            yield from self._motion(node, plain)
        elif node.name == "setdo" and len(plain) == 2:
            yield from self.opposite("invert-output", node, plain[1])
        elif node.name in _OPPOSITE and plain:
            edits = (Edit(node.start, node.start + len(node.name), _OPPOSITE[node.name]),)
            yield TextChange("invert-output", node, edits)
        elif node.name in ("waitdi", "waitdo") and len(plain) == 2:
            yield from self.opposite("invert-input", node, plain[1])
        elif node.name == "testdi":
            yield TextChange("invert-input", node, self.put(node, f"(NOT {self.written(node)})"))
        elif node.name == "waittime" and plain:
            yield from self.scaled("scale-wait", node, plain[-1], (0.1, 10.0))
        elif node.name in ("offs", "reltool"):
            yield from self.reversed(node, plain[1:])
            if node.name == "reltool" and not node.options:
                edits = (Edit(node.start, node.start + len(node.name), "Offs"),)
                yield TextChange("other-frame", node, edits)
        if node.name in _WAITS:
            yield TextChange("forget-wait", node, self.put(node, "WaitTime 0"))

    def _compared(self, node: ProgramNode) -> Iterator[TextChange]:
        """Yield a signal that is compared with 0 or 1: a name without a declaration, or DInput."""
        signal, value = node.parts
        is_name = signal.kind == "name" and signal.name not in self.types
        is_function = signal.kind == "call" and signal.name in ("dinput", "doutput")
        if is_name or is_function:
            yield from self.opposite("invert-input", node, value)

    def _motion(self, node: ProgramNode, plain: list[ProgramNode]) -> Iterator[TextChange]:
        is_joint = node.name.startswith("moveabsj")
        first = 1 if node.name.startswith("movec") else 0
        if len(plain) < first + 3:
            return
        target, speed, zone = plain[first : first + 3]
        if not is_joint:
            yield from self.moved(node, target)
            letter = node.name[4]
            if letter in "jl":
                edits = (Edit(node.start + 4, node.start + 5, "L" if letter == "j" else "J"),)
                yield TextChange("swap-motion", node, edits)
        yield from self._speed(node, speed)
        yield from self._zone(node, zone)
        if len(plain) > first + 3 and self.written(plain[first + 3]).lower() != "tool0":
            yield TextChange("other-tool", node, self.put(plain[first + 3], "tool0"))
        option = node.options.get("wobj")
        if option is not None and option.value is None:
            for frame in option.parts if self.written(option.parts[0]).lower() != "wobj0" else ():
                yield TextChange("other-frame", node, self.put(frame, "wobj0"))

    def _speed(self, node: ProgramNode, speed: ProgramNode) -> Iterator[TextChange]:
        found = re.fullmatch(r"v(\d+)", self.written(speed).lower())
        if found is None:
            return
        for factor in (0.1, 2.0):
            wanted = float(found[1]) * factor
            near = min(_SPEEDS, key=lambda known_speed: (abs(known_speed - wanted), known_speed))
            if near != int(found[1]):
                yield TextChange("scale-speed", node, self.put(speed, f"v{near}"), f"×{factor:g}")

    def _zone(self, node: ProgramNode, zone: ProgramNode) -> Iterator[TextChange]:
        written = self.written(zone).lower()
        if written == "fine" or re.fullmatch(r"z\d+", written):
            edits = self.put(zone, "z50" if written == "fine" else "fine")
            yield TextChange("change-blend", node, edits)

    def _point(self, node: ProgramNode, literal: ProgramNode) -> Iterator[TextChange]:
        if self._is_target(literal):
            yield from self.sized("shift-point", node, literal, self._literal)
            configuration = literal.parts[2].parts
            if configuration and (value := signed_number(configuration[0])) is not None:
                edits = self.put(configuration[0], named_number(value + 1))
                yield TextChange("wrong-configuration", node, edits)

    @staticmethod
    def _is_target(node: ProgramNode) -> bool:
        shape = [len(part.parts) if part.kind == "list" else 0 for part in node.parts]
        return node.kind == "list" and shape[:2] == [3, 4] and len(shape) >= 3

    def _is_pose(self, target: ProgramNode) -> bool:
        if target.kind == "list":
            return self._is_target(target)
        return self.kind_of(target) == "robtarget"

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """Return the edits of a number of a literal or of Offs, or an Offs around the target."""
        if not self._is_pose(target):
            return None
        if target.kind == "list":
            return self._literal(target, axis, metres)
        plain = target.plain
        if target.kind == "call" and target.name == "offs" and len(plain) == 4:
            value = signed_number(plain[1 + axis])
            if value is not None:
                return self.put(plain[1 + axis], named_number(value + metres * 1000))
        amounts = ["0"] * 3
        amounts[axis] = named_number(metres * 1000)
        return self.put(target, f"Offs({self.written(target)},{','.join(amounts)})")

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """Return a RelTool around the target: a number of a quaternion is no rotation."""
        if not self._is_pose(target):
            return None
        name = ("Rx", "Ry", "Rz")[axis]
        return self.put(target, f"RelTool({self.written(target)},0,0,0\\{name}:={named_number(degrees)})")

    def _literal(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        number = target.parts[0].parts[axis]
        value = signed_number(number)
        return None if value is None else self.put(number, named_number(value + metres * 1000))
