"""How a mutant of a KRL program reads."""

from __future__ import annotations

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

from .parser import MOTIONS

_SWAPS = {"ptp": "LIN", "lin": "PTP", "sptp": "SLIN", "slin": "SPTP"}
_POSITIONS = name_set("frame pos e6pos e3pos")
_OF_ROBOT = name_set("pulse trigger") | {"wait sec", "wait for"} | MOTIONS
#: what inline forms write before a motion, and files of the maker
_FORMS = name_set("$bwdstart pdat_act fdat_act ldat_act basisteck")
_MAKERS = name_set("bas bas.src ir_stopm ir_stopm.src sps sps.sub h50 h70 a10 a20 msglib p00 userspot")
_COORDINATE = re.compile(r"[xyzabc]|[ae][1-6]")
_STALE = "the comment of its inline form is stale now"


class KrlRewriter(Rewriter):
    """The rewriter of KRL."""

    wording: ClassVar = Wording(
        ("==", "<>"), ("AND", "OR", "EXOR"), ("TRUE", "FALSE"), "NOT ({})", "ABS({})", "WAIT SEC 1/0",
        bits=("B_AND", "B_OR", "B_EXOR"),
    )  # fmt: skip
    known_types: ClassVar = {
        **dict.fromkeys(("$in", "$out", "$flag", "$cycflag"), "truth[]"),
        **dict.fromkeys(("$anin", "$anout", "$timer"), "number[]"),
        "$pos_act": "e6pos",
    }

    @cached_property
    def _folds(self) -> list[tuple[int, int, str]]:
        """Folds: where they begin and end, and what they are called."""
        found: list[tuple[int, int, str]] = []
        opened: list[tuple[int, str]] = []
        for line in re.finditer(
            r"^[ \t]*;+(FOLD|ENDFOLD)\b([^\r\n]*)", self.text, re.MULTILINE | re.IGNORECASE
        ):
            if line[1].lower() == "fold":
                opened.append((line.start(), line[2].strip().lower()))
            elif opened:
                start, name = opened.pop()
                found.append((start, line.end(), name))
        return found

    @cached_property
    def _signals(self) -> dict[str, str]:
        """What signals stand for, such as ``$in``, by name."""
        signals = (node for node in self.all_nodes() if node.kind == "signal")
        return {node.name: self._base_name(node.parts[0]) for node in signals}

    def note_type(self, node: ProgramNode) -> None:
        """Give a signal the type of what it stands for."""
        if node.kind == "signal":
            self.add_type(node.name, self.kind_of(node.parts[0]))
        super().note_type(node)

    def is_amount(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number is an amount; ``S`` and ``T`` are none, as they name a configuration."""
        pairs = [outer.name for outer in parents if outer.kind == "pair"]
        return all(_COORDINATE.fullmatch(name) for name in pairs[-1:])

    def _meant(self, node: ProgramNode) -> str:
        """Return the system variable that a node is of, or that its signal stands for."""
        name = self._base_name(node)
        return self._signals.get(name, name)

    def is_generated(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a node is of the INI fold, an inline form, or a file of the maker."""
        name = self.program.file.rpartition("/")[2].rpartition(".")[0].lower()
        if name in _MAKERS or (name.startswith("$") and node.kind != "declare"):
            return True
        if any(name.startswith("ini") and start <= node.start < end for start, end, name in self._folds):
            return True
        return any(_is_form(outer) for outer in (*parents, node))

    def is_of_robot(self, node: ProgramNode) -> bool:
        """Return whether a statement is a motion, output or wait, or sets tool, base or speed."""
        if node.kind == "call":
            return node.name in _OF_ROBOT
        return node.kind == "assign" and self._meant(node.parts[0]) in _SETTINGS

    @staticmethod
    def _base_name(node: ProgramNode) -> str:
        while node.kind in ("index", "field") and node.parts:
            node = node.parts[0]
        return node.name

    def is_plain_number(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> bool:
        """Return whether a number is plain; those of declarations count as well."""
        is_number = parents[-1].kind == "declare" and parents[-1].value["type"] in ("int", "real")
        return is_number or super().is_plain_number(node, parents)

    def of_node(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        """Yield the differences that are about an instruction, an assignment, a reading, or a declaration."""
        if node.kind in ("call", "assign") and self.is_of_robot(node) and self.is_statement(node, parents):
            yield TextChange("drop-statement", node, self.without(node))
        if node.kind == "call":
            yield from self._call(node)
        elif node.kind == "assign":
            yield from self._assigned(node)
        elif node.kind == "declare" and node.parts and node.value["type"] in _POSITIONS:
            yield from self._point(node, node.parts[0])
        elif node.kind == "declare" and node.parts and node.value["type"] == "fdat":
            yield from self._form_data(node, node.parts[0])
        elif node.kind in ("index", "name") and self._meant(node) == "$in" and parents[-1].kind != "index":
            yield from self._input(node, parents)
        elif node.kind == "binary" and node.name == ":":
            yield from self._reversed(node, node.parts[1], "xyz")

    def _call(self, node: ProgramNode) -> Iterator[TextChange]:
        if node.name in MOTIONS and node.parts:
            yield from self._motion(node)
        elif node.name == "wait sec":
            yield from self.scaled("scale-wait", node, node.parts[0], (0.1, 10.0))
        elif node.name == "wait for":
            yield TextChange("forget-wait", node, self.put(node, "WAIT SEC 0"))
        elif node.name == "pulse" and len(node.parts) == 3:
            yield from self.opposite("invert-output", node, node.parts[1])

    def _motion(self, node: ProgramNode) -> Iterator[TextChange]:
        target = node.parts[1] if node.name in ("circ", "scirc") and len(node.parts) > 1 else node.parts[0]
        if node.name.endswith("_rel"):
            yield from self._reversed(node, target)
        elif target.kind != "option":
            yield from self.moved(node, target)
        written = self.text[node.start : node.start + len(node.name)]
        if node.name in _SWAPS and not self._is_axes(target):
            edits = [Edit(node.start, node.start + len(written), _SWAPS[node.name])]
            chosen = (option for name, option in node.options.items() if name in _APPROXIMATIONS)
            edits += [Edit(option.start, option.end, _APPROXIMATIONS[option.name]) for option in chosen]
            note = _STALE if self._is_in_form(node) else ""
            yield TextChange("swap-motion", node, tuple(edits), note=note)
        for option in node.options.values():
            if option.name.startswith("c_"):
                yield TextChange("change-blend", node, self.put(option, ""))

    def _is_in_form(self, node: ProgramNode) -> bool:
        return any(start <= node.start < end for start, end, _ in self._folds)

    def _reversed(self, node: ProgramNode, shift: ProgramNode, names: str = "") -> Iterator[TextChange]:
        for pair in shift.parts if shift.kind == "aggregate" else ():
            value = signed_number(pair.parts[0]) if pair.kind == "pair" else None
            if value and pair.name in (names or pair.name):
                edits = self.put(pair.parts[0], named_number(-value))
                yield TextChange("reverse-offset", node, edits, pair.name)

    def _assigned(self, node: ProgramNode) -> Iterator[TextChange]:
        target, value = node.parts
        name = self._meant(target)
        if name == "$out":
            yield from self.opposite("invert-output", node, value)
        elif name == "$vel" and target.kind == "field" and target.name == "cp":
            yield from self.scaled("scale-speed", node, value, (0.1, 2.0))
        elif name in ("$base", "$tool") and target.kind == "name":
            operator = "other-frame" if name == "$base" else "other-tool"
            if self.written(value).lower() != "$nullframe":
                yield TextChange(operator, node, self.put(value, "$NULLFRAME"))
        elif target.kind == "field" and target.name in ("x", "y", "z"):
            yield from self._component(node, value)

    def _component(self, node: ProgramNode, value: ProgramNode) -> Iterator[TextChange]:
        """Yield the reversed offset of ``XP1.Z=XP1.Z+30``."""
        if value.kind == "binary" and value.name in "+-":
            between = self.text[value.parts[0].end : value.parts[1].start]
            at = value.parts[0].end + between.find(value.name)
            other = "-" if value.name == "+" else "+"
            yield TextChange("reverse-offset", node, (Edit(at, at + 1, other),))

    def _input(self, node: ProgramNode, parents: tuple[ProgramNode, ...]) -> Iterator[TextChange]:
        parent = parents[-1]
        if parent.kind == "assign" and parent.parts[0] is node:
            return
        if parent.kind == "binary" and parent.name in ("==", "<>"):
            other = parent.parts[1] if parent.parts[0] is node else parent.parts[0]
            yield from self.opposite("invert-input", parent, other)
        else:
            yield TextChange("invert-input", node, self.put(node, f"(NOT {self.written(node)})"))
        number = node.parts[1] if node.kind == "index" else node
        if number.kind == "number":
            alike = (
                candidate.parts[1]
                for candidate in self.program.parsed.tree.walk()
                if candidate.kind == node.kind == "index" and candidate.parts[0].name == node.parts[0].name
            )
            for text in self.next_number(number, alike):
                yield TextChange("other-input", node, self.put(number, text))

    def _form_data(self, node: ProgramNode, value: ProgramNode) -> Iterator[TextChange]:
        """Yield changes of tool and base of an inline form."""
        for pair in value.parts:
            number = signed_number(pair.parts[0]) if pair.parts else None
            if number is not None and pair.name in ("tool_no", "base_no"):
                operator = "other-tool" if pair.name == "tool_no" else "other-frame"
                edits = self.put(pair.parts[0], "0" if number else "1")
                yield TextChange(operator, node, edits, note=_STALE)

    def _point(self, node: ProgramNode, literal: ProgramNode) -> Iterator[TextChange]:
        yield from self.sized("shift-point", node, literal, self._literal)
        for pair in literal.parts if literal.kind == "aggregate" else ():
            value = signed_number(pair.parts[0])
            if pair.name == "s" and value is not None:
                edits = self.put(pair.parts[0], f"{int(value) ^ 1}")
                yield TextChange("wrong-configuration", node, edits)

    @staticmethod
    def _pair(literal: ProgramNode, name: str) -> ProgramNode | None:
        if literal.kind != "aggregate":
            return None
        pairs = (part for part in literal.parts if part.kind == "pair" and part.name == name)
        return next((pair.parts[0] for pair in pairs), None)

    def _literal(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        number = self._pair(target, "xyz"[axis])
        value = signed_number(number) if number is not None else None
        if number is None or value is None:
            return None
        return self.put(number, named_number(value + metres * 1000))

    def _is_axes(self, target: ProgramNode) -> bool:
        if target.kind == "aggregate":
            return any(part.name == "a1" for part in target.parts)
        return self.kind_of(target) in ("e6axis", "axis") or target.name.startswith("$axis")

    def _is_position(self, target: ProgramNode) -> bool:
        if target.kind == "aggregate":
            return not self._is_axes(target) and self._pair(target, "x") is not None
        if target.kind == "binary":
            return target.name == ":"
        return self.kind_of(target) in _POSITIONS

    def shifted(self, target: ProgramNode, axis: int, metres: float) -> tuple[Edit, ...] | None:
        """Return the edits of a component of a literal, or a geometric operator behind the target."""
        if target.kind == "aggregate":
            return self._literal(target, axis, metres)
        return self._joined(target, "xyz"[axis], metres * 1000)

    def turned(self, target: ProgramNode, axis: int, degrees: float) -> tuple[Edit, ...] | None:
        """Return a geometric operator behind the target: about z is A, about y B, about x C."""
        return self._joined(target, "cba"[axis], degrees)

    def _joined(self, target: ProgramNode, name: str, amount: float) -> tuple[Edit, ...] | None:
        if not self._is_position(target):
            return None
        amounts = dict.fromkeys("xyzabc", "0")
        amounts[name] = named_number(amount)
        shift = ",".join(f"{key.upper()} {value}" for key, value in amounts.items())
        return (Edit(target.end, target.end, f":{{{shift}}}"),)


_SETTINGS = name_set("$out $anout $base $tool $vel $vel_axis")
_APPROXIMATIONS = {"c_ptp": "C_DIS", "c_dis": "C_PTP"}


def _is_form(node: ProgramNode) -> bool:
    """Return whether a node is of what inline forms write before a motion."""
    if node.kind == "assign":
        return node.parts[0].name in _FORMS
    return node.kind == "call" and (node.name == "bas" or node.name.startswith("interrupt"))
