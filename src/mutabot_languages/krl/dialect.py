"""What KRL's names mean: system variables, signals, frames, and what ``BAS`` and the inline forms set."""

from __future__ import annotations

import copy
import math
from typing import Any, ClassVar

from mutabot_languages.core.frames import Frame
from mutabot_languages.core.machine import OF_NUMBERS, OF_VALUES, Dialect, Evaluation, Machine
from mutabot_languages.core.names import name_set
from mutabot_languages.core.scope import RoutineScope, Steps, Structure, Variable
from mutabot_languages.core.tree import ProgramNode

_CARTESIAN = ("x", "y", "z", "a", "b", "c")
_OF_BITS = {"b_and": int.__and__, "b_or": int.__or__, "b_exor": int.__xor__}
_NULL = dict.fromkeys(_CARTESIAN, 0.0)
#: system variables that can be set without an effect in the cell
INERT = name_set(
    """$bwdstart $advance $torqmon $torqmon_def $torqmon_com $torqmon_com_def $h_pos $ori_type $circ_type
    $pro_mode $ov_pro $ipo_mode $load $load_a1 $load_a2 $load_a3 $acc $acc_axis $acc_extax $vel_extax $jerk
    $gear_jerk $apo $red_vel $timer_stop $timer $timer_flag $cycflag $flag $act_tool $act_base $act_base_c
    $act_tool_c $ipo_mode_c $stopnoapro $loop_msg $loop_cont $pal_mode $coll_enable $coll_alarm $brake_sig
    $base_kin $msg_t $rev_num $data_integrity $no_kcp_msg $singul_dist $ori_jerk $ecodata $spl_tech
    $spl_ori_joint_auto $acc_ma $vel_ma $asys $distance_mode $seninit"""
)


class KrlDialect(Dialect):
    """The dialect of KRL."""

    first: ClassVar = 1

    def declare(self, task: Evaluation, node: ProgramNode, scope: RoutineScope, *, is_global: bool) -> Steps:
        """Make the variable of a declaration; in a data file it keeps its value."""
        type = node.value["type"]
        if not is_global and node.name in scope.names and not node.parts:
            scope.names[node.name].type = type  # of a parameter, which is there already
            return
        sized = [size for size in node.value["sizes"] if size.kind != "omitted"]
        sizes = [int(size) for size in (yield from task.values(sized, scope))]
        sizes += [1] * (len(node.value["sizes"]) - len(sizes))
        value = beginning(type, sizes)
        if node.parts and not sizes:
            value = yield from task.value(node.parts[0], scope)
            if isinstance(value, Structure):
                value.type = value.type or type
        elif node.parts:
            value = yield from task.value(node.parts[0], scope)
        names = scope.names if not is_global else scope.unit.names
        names[node.name] = Variable(value, type)

    def name(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
        """Return the value of a system variable, or a signal."""
        machine = machine_of(task)
        name = node.name
        if name in machine.signals:
            found = machine.signals[name]
            if found.startswith(("$in", "$anin")):
                return task.station.read(task.site(node, scope), found)
            return task.station.outputs.get(found, False)
        if name in ("$pos_act", "$pos_act_mes", "$pos_int"):
            at = machine.base.inverse() * task.station.actual(task.site(node, scope))
            return of_frame(at, "e6pos")
        if name in ("$axis_act", "$axis_act_meas", "$axis_int"):
            return of_axes(task.station.angles(task.site(node, scope)))
        if name in machine.system:
            return machine.system[name]
        if name in ("$nullframe", "$world", "$robroot"):
            return of_frame(Frame(), "frame")
        raise task.unsupported(node, scope)

    def index(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
        """Return an element of a system variable: ``$IN[1]``, ``$OUT[9]``, ``BASE_DATA[1]``."""
        return _element(task, node, scope)

    def assign(self, task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Any:
        """Set a system variable or an output."""
        return assign_system(task, target, value, scope)

    def binary(self, operator: str, left: Any, right: Any) -> Any:
        """Return the value of a binary operation."""
        if operator in OF_VALUES:
            return OF_VALUES[operator](left, right)
        if operator in _OF_BITS:
            return _OF_BITS[operator](int(left), int(right))
        return join(left, right) if operator == ":" else _calculated(operator, left, right)

    def unary(self, operator: str, value: Any) -> Any:
        """Return the value of a unary operation."""
        return ~int(value) if operator == "b_not" else super().unary(operator, value)

    def literal(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of an aggregate or of a name of an enumeration."""
        if node.kind == "enum":
            return f"#{node.name}"
        if node.kind != "aggregate":
            raise task.unsupported(node, scope, node.name or node.kind)
        made: dict[str, Any] = {}
        for pair in node.parts:
            made[pair.name] = yield from task.value(pair.parts[0], scope)
        return Structure.of(node.name, made)

    def assigned(self, variable: Variable, value: Any) -> Any:
        """Return what a variable gets: a copied structure; components that an aggregate leaves out stay."""
        if variable.type == "int" and isinstance(value, float):
            return math.floor(value + 0.5)
        if variable.type == "real" and isinstance(value, int) and not isinstance(value, bool):
            return float(value)
        return copy.deepcopy(value) if isinstance(value, (dict, list)) else value

    def is_reference(self, parameter: ProgramNode) -> bool:
        """Return whether a parameter is the caller's own variable: OUT, which is also the default."""
        return bool(parameter.value["mode"] == "out")


class KrlMachine(Machine):
    """A run of a KRL program.

    Attributes:
        base: the frame of ``$BASE``.
        signals: what signals stand for, such as ``$out[9]``.
        system: values of system variables that were set.
        pace: of straight motions, m/s, and of joint motions, a part of their speed.
        triggers: what the next motion does at its end.
    """

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.base = Frame()
        self.signals: dict[str, str] = {}
        self.system: dict[str, Any] = {
            "$vel": Structure.of("cp", {"cp": 0.25, "ori1": 200.0, "ori2": 200.0}), "$vel_axis": [100.0] * 12,
            "$mode_op": "#t1", "$t1": True, "$t2": False, "$aut": False, "$ext": False,
            "$pro_state1": "#p_active", "$rob_stopped": True, "$stopmess": False,
            "$base": Structure.of("frame", dict(_NULL)), "$tool": Structure.of("frame", dict(_NULL)),
            "$pi": math.pi, "$ov_pro": 100,
        }  # fmt: skip
        self.pace = [0.25, 1.0]
        self.triggers: list[tuple[ProgramNode, RoutineScope]] = []


def machine_of(task: Evaluation) -> KrlMachine:
    """Return the machine that runs a task."""
    assert isinstance(task.machine, KrlMachine)
    return task.machine


def beginning(type: str, sizes: list[int]) -> Any:
    """Return the value that a variable of a type begins with."""
    if sizes and type != "char":
        return [beginning(type, sizes[1:]) for _ in range(sizes[0])]
    plain: dict[str, Any] = {"int": 0, "real": 0.0, "bool": False, "char": ""}
    if type in plain:
        return plain[type]
    if type in ("frame", "pos", "e6pos", "e3pos"):
        return Structure.of(type, dict(_NULL))
    return Structure.of(type, {})


def frame_of(value: Any) -> Frame:
    """Return the frame of a position, mm and degrees. Raises TypeError."""
    if not isinstance(value, dict) or not set(value) & set(_CARTESIAN):
        raise TypeError(f"expected a position {{X …}}, found {value!r}")
    x, y, z, a, b, c = (float(value.get(name, 0.0)) for name in _CARTESIAN)
    return Frame.of_euler((x / 1000, y / 1000, z / 1000), a, b, c)


def of_frame(frame: Frame, type: str) -> Structure:
    """Return the position of a frame."""
    values = [*(number * 1000 for number in frame.position), *frame.euler()]
    return Structure.of(type, dict(zip(_CARTESIAN, values, strict=True)))


def of_axes(degrees: list[float]) -> Structure:
    """Return joint angles as an axis position; a seventh joint is E1."""
    names = [f"a{number}" for number in range(1, 7)] + ["e1"]
    return Structure.of("e6axis", dict(zip(names, degrees, strict=False)))


def join(left: Any, right: Any) -> Any:
    """Apply the geometric operator: the right one seen in the left one."""
    if isinstance(right, dict) and set(right) <= {"s", "t"}:
        return left
    return of_frame(frame_of(left) * frame_of(right), getattr(right, "type", "") or "frame")


def _calculated(operator: str, left: Any, right: Any) -> Any:
    if not all(isinstance(operand, (int, float)) for operand in (left, right)):
        raise TypeError("only numbers can be calculated with")
    value = OF_NUMBERS[operator](left, right)
    are_whole = all(isinstance(operand, int) for operand in (left, right))
    return int(value) if operator == "/" and are_whole else value


def _indexed(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Return the indexes of an element of a system variable, and its name."""
    indexes = [int(index) for index in (yield from task.values(node.parts[1:], scope))]
    return indexes, f"{node.parts[0].name}[{','.join(map(str, indexes))}]"


def _element(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    machine = machine_of(task)
    name = node.parts[0].name
    indexes, signal = yield from _indexed(task, node, scope)
    if name in ("$in", "$anin", "$digin", "$sen_pint"):
        return task.station.read(task.site(node, scope), signal)
    if name in ("$out", "$anout"):
        return task.station.outputs.get(signal, False)
    if name in ("$flag", "$cycflag", "$timer_flag"):
        return machine.system.get(signal, False)
    if name in ("base_data", "tool_data"):
        return machine.system.get(signal, of_frame(Frame(), "frame"))
    if name == "$timer":
        return machine.system.get(signal, 0.0)
    if signal in machine.system:
        return machine.system[signal]
    known = machine.system.get(name)
    if isinstance(known, list) and indexes and 1 <= indexes[0] <= len(known):
        return known[indexes[0] - 1]
    raise task.unsupported(node, scope, signal)


def assign_system(task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Any:
    """Set a system variable or an output; NotImplemented for a variable of the program."""
    base = target
    while base.kind in ("index", "field"):
        base = base.parts[0]
    name = base.name
    machine = machine_of(task)
    found = task.find(name, scope)
    if found is not None and isinstance(found.value, str) and target.kind == "index":
        found.value = value  # texts are kept whole
        return None
    if found is not None:
        return NotImplemented
    if name in machine.signals:
        return task.station.write(task.site(target, scope), machine.signals[name], value)
    if not name.startswith("$") and name not in ("base_data", "tool_data", "load_data"):
        return NotImplemented
    if target.kind == "index":
        return _set_element(task, target, value, scope)
    if target.kind == "field":
        return _set_component(task, target, value, scope)
    if name in ("$base", "$tool"):
        set_frame(machine, name, value)
        return None
    machine.system[name] = copy.deepcopy(value)
    if name not in INERT and name not in _KNOWN:
        raise task.unsupported(target, scope)
    return None


_KNOWN = name_set("$vel $vel_axis $base $tool $apo $ipo_mode $out $anout $flag $timer")


def set_frame(machine: KrlMachine, name: str, value: Any) -> None:
    """Set ``$BASE`` or ``$TOOL``."""
    machine.system[name] = copy.deepcopy(value)
    if name == "$base":
        machine.base = frame_of(value)
    else:
        machine.station.tool = frame_of(value)


def _set_element(task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Steps:
    machine = machine_of(task)
    name = target.parts[0].name
    indexes, signal = yield from _indexed(task, target, scope)
    if name in ("$out", "$anout"):
        task.station.write(task.site(target, scope), signal, value)
        return
    machine.system[signal] = copy.deepcopy(value)
    if name == "$vel_axis":
        machine.system["$vel_axis"][indexes[0] - 1] = float(value)
        machine.pace[1] = max(0.01, min(float(speed) for speed in machine.system["$vel_axis"][:6]) / 100)
    elif name not in INERT and name not in _KNOWN and name not in ("base_data", "tool_data", "load_data"):
        raise task.unsupported(target, scope, signal)


def _set_component(task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Steps | None:
    machine = machine_of(task)
    owner = target.parts[0]
    if owner.kind != "name":
        if owner.kind == "index" and owner.parts[0].kind == "name":
            return _set_indexed_component(task, target, value, scope)
        machine.station.note(f"{owner.name or owner.kind}.{target.name} has no effect here")
        return None
    name = owner.name
    if name == "$vel" and not value > 0:
        raise task.error(target, scope, f"$VEL.{target.name.upper()} cannot be {value:g}: a speed is above 0")
    record = machine.system.setdefault(name, Structure.of("", {}))
    record[target.name] = value
    if name in ("$base", "$tool"):
        set_frame(machine, name, record)
    elif name == "$vel" and target.name == "cp":
        machine.pace[0] = float(value)
    elif name not in INERT and name != "$vel":
        raise task.unsupported(target, scope, f"{name}.{target.name}")
    return None


def _set_indexed_component(task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Steps:
    _, signal = yield from _indexed(task, target.parts[0], scope)
    record = machine_of(task).system.setdefault(signal, of_frame(Frame(), "frame"))
    record[target.name] = value
