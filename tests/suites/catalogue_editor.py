"""Mutants of the catalogue as edits of the source text, from what each operator says that it does."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from typing import Any

from .editor import PLANTED, UNITS, CallEditor, CannotWriteError, Edit, Facts, Source

CATALOGUE = '__import__("_planted_catalogue")'
_FACTORS = {**UNITS, "inch": 0.0254, "s": 1.0, "ms": 0.001, "m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001,
            "rad/s": 1.0, "deg/s": math.pi / 180}  # fmt: skip
_SLICE = re.compile(r"\[(\d+):(\d+)\]$")
_JOINTS = re.compile(r"j(\d+)\.\.j(\d+)$")
_MOTIONS = ("translation", "rotation", "quaternion", "rotation_vector", "euler")
#: what stands in for a change of nothing, in a text
_SAME = "(lambda one: one)"


def catalogue_edits(facts: Facts, source: Source, mutant: Mapping[str, Any]) -> list[Edit]:
    """The edits that make a mutant of the catalogue. Raises CannotWriteError where none is known."""
    return CatalogueEditor(facts, source, mutant).edits()


class CatalogueEditor(CallEditor):
    """Writes the edits of one mutant of the catalogue."""

    def edits(self) -> list[Edit]:
        """The edits."""
        name = self.mutant["operator"]
        self.variant = self.mutant["variant"].partition("+mutabot")[0]
        if name in ("cm-for-m", "mm-for-m", "inch-for-mm", "deg-for-rad", "ms-for-s"):
            return [self._other_unit()]
        method = getattr(self, "_" + name.replace("-", "_"), None)
        if method is None:
            raise CannotWriteError(f"operator {name}")
        found = method()
        return found if isinstance(found, list) else [found]

    # units, frames, orientations

    def _other_unit(self) -> Edit:
        how, _, other = self.variant.partition("-")
        factor = _FACTORS[other] / _FACTORS[self._quantity()["unit"]]
        return self._value(f"{CATALOGUE}.scaled, {factor if how == 'taken' else 1 / factor!r}")

    def _axis_swap(self) -> Edit:
        return self._together([self._name, self._second(self._written())], f"{CATALOGUE}.exchanged")

    def _swapped_channels(self) -> Edit:
        return self._together([self._name, self._second(self._read())], f"{CATALOGUE}.exchanged")

    def _joint_order(self) -> Edit:
        side = self._written() if self._is_written else self._read()
        return self._together([self._name, self._second(side)], f"{CATALOGUE}.exchanged")

    def _left_handed(self) -> Edit:
        side = self._written() if self._is_written else self._read()
        angles = [
            name
            for name, quantity in side.items()
            if quantity["kind"] in ("rotation", "orientation") and quantity.get("axis") in ("x", "z")
        ]
        if any(quantity["kind"] in ("quaternion", "rotation_vector", "euler") for quantity in side.values()):
            raise CannotWriteError("a pose with an orientation as a whole")
        return self._together([self._name, *angles], f"{CATALOGUE}.negated")

    def _base_for_tool(self) -> Edit:
        told = self.facts.hints.get("tool", {}).get(self.mutant["operation"])
        if told is None or self._quantity().get("frame") != "base":
            raise CannotWriteError("judge.toml does not say how to ask how the tool is turned")
        receiver = self.source.text(self.call.func.value) if isinstance(self.call.func, ast.Attribute) else ""
        pose = told.replace("SELF", receiver)
        moved = [name for name, quantity in self._written().items() if quantity["kind"] == "translation"]
        return self._together(moved, f"{CATALOGUE}.along_tool(lambda: {pose})")

    def _tcp_missing(self) -> Edit:
        return self._value(f"{CATALOGUE}.added, {self._quantity()['tcp']!r}")

    def _tcp_doubled(self) -> Edit:
        return self._value(f"{CATALOGUE}.added, {-self._quantity()['tcp']!r}")

    def _joint_turn(self) -> Edit:
        turn = 360.0 if self._quantity()["unit"] == "deg" else 2 * math.pi
        return self._value(f"{CATALOGUE}.added, {turn if self.variant == '+' else -turn!r}")

    def _euler_order(self) -> Edit:
        if (self._quantity()["order"], self._quantity()["unit"]) != ("xyz", "deg"):
            raise CannotWriteError("Euler angles in another order or unit")
        return self._value(f"{CATALOGUE}.turned_along")

    def _quaternion_order(self) -> Edit:
        return self._value(f"{CATALOGUE}.moved_scalar, {self._quantity()['order'] == 'wxyz'}")

    def _quaternion_sign(self) -> Edit:
        signs = [-1 if part == self.variant else 1 for part in self._quantity()["order"]]
        return self._value(f"{CATALOGUE}.with_signs, {signs}")

    # order and timing

    def _half_wait(self) -> Edit:
        return self._value(f"{CATALOGUE}.scaled, 0.5")

    def _no_wait(self) -> Edit:
        return self._value(f"{CATALOGUE}.scaled, 0.0")

    def _lost_command(self) -> Edit:
        left_out = f"{PLANTED}.skipped({self._callee()}, lambda self: {self._idle()})"
        return self._with_callee(f"{CATALOGUE}.by_chance(0.3, {self._callee()}, {left_out})")

    def _double_command(self) -> Edit:
        twice = f"{PLANTED}.twice({self._callee()})"
        return self._with_callee(f"{CATALOGUE}.by_chance(0.3, {self._callee()}, {twice})")

    def _late_grip(self) -> Edit:
        return self._with_callee(f"{CATALOGUE}.after_waiting({self._callee()}, lambda: {self._wait()})")

    def _late_reading(self) -> Edit:
        return self._with_callee(f"{CATALOGUE}.before_waiting({self._callee()}, lambda: {self._wait()})")

    def _wait(self) -> str:
        told = self.facts.hints.get("wait")
        if told is None:
            raise CannotWriteError("judge.toml does not say how time passes")
        return str(told).replace("SECONDS", "0.5")

    def _swap_next(self) -> list[Edit]:
        held = f"{CATALOGUE}.held({self._callee()}, lambda self: {self._idle()})"
        return [self._with_callee(held), *self._thens()]

    def _early_release(self) -> list[Edit]:
        back = self._taken_back()
        planted = f"{CATALOGUE}.taken_back({self._callee()}, lambda given, named: {back})"
        return [self._with_callee(planted), *self._thens()]

    def _taken_back(self) -> str:
        """The text of what undoes a gripper command."""
        callee = self._callee()
        for name, quantity in self._written().items():
            if quantity["kind"] == "opening":
                first, second = quantity.get("values") or quantity["range"]
                other = f"{PLANTED}.partial({PLANTED}.other, { {first: second, second: first}!r})"
                return f"lambda: {PLANTED}.with_argument({callee}, {name!r}, '', {other})(*given, **named)"
        if self.pattern is not None:
            text = self.pattern["opposite"]
            if "{" in text or self.operation["message"] not in self._parameters()[:1]:
                raise CannotWriteError("a text command with fields")
            return f"lambda: {callee}({text!r})"
        name = self.operation["opposite"].rpartition(":")[2].rpartition(".")[2]
        if not isinstance(self.call.func, ast.Attribute):
            raise CannotWriteError("the opposite of a plain function")
        return f"lambda: {self.source.text(self.call.func.value)}.{name}(*given, **named)"

    def _thens(self) -> list[Edit]:
        """After every other command of the program, what is due is done."""
        names = {
            operation["call"].rpartition(":")[2].rpartition(".")[2]
            for operation in self.facts.operations
            if operation.get(
                "command",
                bool(operation.get("arguments")) or "message" in operation or "result" not in operation,
            )
        }
        found = []
        for file in self.facts.settings["program"]:
            source = Source(self.facts.folder / file, file)
            is_own = file == self.source.name
            own = self.source.range(self.call.func)
            for node in source.nodes(ast.Call):
                name = (
                    node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                )
                if name in names and not (is_own and source.range(node.func) == own):
                    text = f"{CATALOGUE}.then({source.text(node.func)})"
                    found.append(Edit(file, *source.range(node.func), text))
        if any(isinstance(node, ast.Await) for file in self.facts.settings["program"]
               for node in Source(self.facts.folder / file, file).nodes(ast.Await)):  # fmt: skip
            raise CannotWriteError("commands that are awaited")
        return found

    def _previous_target(self) -> list[Edit]:
        if self.pattern is not None or len(self.facts.settings["program"]) != 1:
            raise CannotWriteError("the text command before it, or several files")
        paths = tuple(
            _split(name) for name, quantity in self._written().items() if quantity["kind"] in _MOTIONS
        )
        key = self.mutant["operation"]
        name = key.rpartition(".")[2].rpartition(":")[2]
        found = []
        for node in self.source.nodes(ast.Call):
            if isinstance(node.func, ast.Attribute) and node.func.attr == name:
                how = "again" if node is self.call else "noted"
                text = f"{CATALOGUE}.{how}({key!r}, {self.source.text(node.func)}, {paths!r})"
                found.append(self._replace(node.func, text))
        return found

    def _unreported_refusal(self) -> Edit:
        names = self.facts.refusals
        answer = f"lambda self: {self._idle()}"
        return self._with_callee(f"{CATALOGUE}.swallowing({self._callee()}, {names!r}, {answer})")

    # readings

    def _dropout(self) -> Edit:
        missing = self._quantity()["missing"]
        if missing == "none":
            return self._result("(lambda value: None)")
        if missing == "nan":
            return self._result(f"{CATALOGUE}.nothing")
        return self._with_callee(f"{CATALOGUE}.raising({self._callee()}, {missing!r})")

    def _old_reading(self) -> Edit:
        return self._result(self._partial(f"{CATALOGUE}.old, {self.mutant['id']!r}, {self.variant}"))

    def _stuck_reading(self) -> Edit:
        return self._result(self._partial(f"{CATALOGUE}.stuck, {self.mutant['id']!r}"))

    def _stuck_flag(self) -> Edit:
        return self._result(f"(lambda value: {self.variant == 'true'})")

    def _spike(self) -> Edit:
        limits = self._quantity().get("range")
        change = self._partial(f"{CATALOGUE}.spiked, {tuple(limits) if limits else None!r}")
        return self._result(self._partial(f"{CATALOGUE}.now_and_then, 0.1, {change}"))

    def _saturated_reading(self) -> Edit:
        limits = self._quantity().get("range")
        if limits is None:
            return self._result(self._partial(f"{CATALOGUE}.saturated, {self.mutant['id']!r}"))
        return self._result(self._partial(f"{CATALOGUE}.limited, {self._middle(limits)}"))

    def _wrong_object(self) -> Edit:
        return self._argument(self._next_of(self._quantity()["values"]))

    def _confused_label(self) -> Edit:
        change = self._next_of(self._quantity().get("values") or [False, True])
        return self._result(self._partial(f"{CATALOGUE}.now_and_then, 0.3, {change}"))

    @staticmethod
    def _next_of(values: list[Any]) -> str:
        pairs = {value: values[(index + 1) % len(values)] for index, value in enumerate(values)}
        return f"{PLANTED}.partial({PLANTED}.other, {pairs!r})"

    # actuation

    def _speed_override(self) -> Edit:
        return self._clamped(float(self.variant.removeprefix("x")))

    _force_override = _weak_grip = _speed_override

    def _wrong_payload(self) -> Edit:
        return self._value(f"{CATALOGUE}.scaled, {0.0 if self.variant == 'none' else 2.0}")

    def _partial_opening(self) -> Edit:
        low, high = self._quantity()["range"]
        return self._argument(self._partial(f"{CATALOGUE}.half_of_the_way, {low}, {high}"))

    def _silent_limit(self) -> Edit:
        return self._argument(
            self._partial(f"{CATALOGUE}.limited, {self._middle(self._quantity()['range'])}")
        )

    @staticmethod
    def _middle(limits: list[float]) -> str:
        low, high = limits
        return f"{low + 0.1 * (high - low)!r}, {high - 0.1 * (high - low)!r}"

    def _clamped(self, factor: float) -> Edit:
        limits = self._quantity().get("range")
        change = self._partial(f"{CATALOGUE}.scaled, {factor}")
        if limits is None:
            return self._argument(change)
        limit = self._partial(f"{CATALOGUE}.limited, {limits[0]}, {limits[1]}")
        return self._argument(f"(lambda value: {limit}({change}(value)))")

    # what they are made of

    @property
    def _name(self) -> str:
        return str(self.mutant["quantity"])

    @property
    def _is_written(self) -> bool:
        return self._name in self._written()

    def _written(self) -> dict[str, dict[str, Any]]:
        """The quantities that the call writes, each component by itself."""
        if self.pattern is not None:
            own = {key: value for key, value in self.pattern.items() if key not in ("text", "result")}
            fields = re.findall(r"\{(\w+)", self.pattern["text"])
            return self.pattern.get("arguments") or ({fields[0]: own} if fields and "kind" in own else {})
        return _expanded(self.operation.get("arguments", {}))

    def _read(self) -> dict[str, dict[str, Any]]:
        result = self.operation.get("result", {})
        return {"result": result} if "kind" in result else _expanded(result)

    def _second(self, side: Mapping[str, Any]) -> str:
        """The other quantity of a pair."""
        return next(name for name in side if name.lstrip(".") == self.variant)

    @staticmethod
    def _partial(call: str) -> str:
        return f"{PLANTED}.partial({call})"

    def _value(self, call: str) -> Edit:
        """One value changed, on whichever side it stands, where the robot takes the new one."""
        quantity = self._quantity()
        if "clip" in quantity:
            raise CannotWriteError("a value with clip")
        change = self._partial(call)
        limits = quantity.get("range")
        if limits is not None:
            change = self._partial(f"{CATALOGUE}.if_allowed, {limits[0]}, {limits[1]}, {change}")
        return self._argument(change) if self._is_written else self._result(change)

    def _together(self, names: list[str], change: str) -> Edit:
        """Several values changed together."""
        side = self._written() if self._is_written else self._read()
        limits = [side[name].get("range") for name in names]
        if any(limits):
            change = self._partial(f"{CATALOGUE}.all_if_allowed, {limits!r}, {change}")
        if not self._is_written:
            paths = tuple("" if name == "result" else name for name in names)
            return self._with_callee(f"{CATALOGUE}.rereading({self._callee()}, {paths!r}, {change})")
        split = tuple(map(_split, names))
        return self._with_callee(f"{CATALOGUE}.rewriting({self._callee()}, {split!r}, {change})")


def _split(name: str) -> tuple[str, str]:
    """The argument of a path, and the rest of it."""
    root = name.partition(".")[0].partition("[")[0]
    return root, name.removeprefix(root)


def _expanded(group: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The quantities of a table, those of a slice one by one."""
    found: dict[str, dict[str, Any]] = {}
    for name, quantity in group.items():
        part, axis = _SLICE.search(name), str(quantity.get("axis", ""))
        joints = _JOINTS.match(axis)
        if part is None or not (joints or len(axis) > 2):
            found[name] = dict(quantity)
            continue
        axes = (
            [f"j{number}" for number in range(int(joints[1]), int(joints[2]) + 1)] if joints else list(axis)
        )
        for index, name_of_axis in zip(range(int(part[1]), int(part[2])), axes, strict=True):
            found[f"{name[: part.start()]}[{index}]"] = {**quantity, "axis": name_of_axis}
    return found
