"""What URScript's names mean: motions, poses, signals, time and mathematics, in m and rad."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from typing import Any, ClassVar

from mutabot_languages.core.frames import Frame
from mutabot_languages.core.machine import OF_NUMBERS, OF_VALUES, Dialect, Evaluation
from mutabot_languages.core.names import name_set
from mutabot_languages.core.scope import RoutineScope, Steps, Structure
from mutabot_languages.core.station import ProgramPlace, Station
from mutabot_languages.core.task import ProgramTask, end_program, of_values, pause
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import UnreachableError


class UrPose(list[float]):
    """A pose ``p[x, y, z, rx, ry, rz]``: m, and a rotation vector in rad."""

    def __deepcopy__(self, memo: dict[int, Any]) -> UrPose:
        return UrPose(self)


def frame_of(value: Any) -> Frame:
    """Return the frame of a pose. Raises TypeError for anything else."""
    if not isinstance(value, UrPose) or len(value) != 6:
        raise TypeError(f"expected a pose p[…], found {value!r}")
    return Frame.of_vector(value[:3], value[3:])


def pose_of(frame: Frame) -> UrPose:
    """Return the pose of a frame."""
    return UrPose([*frame.position, *frame.vector()])


#: what has no effect in the cell, and is noted
IGNORED = name_set(
    """set_payload set_target_payload set_gravity set_payload_mass set_payload_cog popup textmsg
    set_tool_voltage set_analog_outputdomain set_analog_inputrange set_standard_analog_input_domain
    set_tool_analog_input_domain set_tool_communication set_runstate_standard_digital_output_to_value
    modbus_set_runstate_dependent_choice set_runstate_configurable_digital_output_to_value
    set_runstate_tool_digital_output_to_value set_runstate_gp_boolean_output_to_value
    set_input_actions_to_default set_tool_digital_output_mode set_tool_output_mode
    set_standard_digital_input_action set_configurable_digital_input_action set_gp_boolean_input_action
    set_tool_digital_input_action set_safety_mode_transition_hardness step_count_reset set_payload_inertia
    enter_critical exit_critical set_conveyor_tick_count set_runstate_outputs
    set_standard_analog_output_domain set_euromap_runstate_dependent_choice set_baselight_off
    position_deviation_warning zero_ftsensor request_boolean_from_primary_client protective_stop_reset
    conveyor_pulse_decode set_digital_input_action write_to_log reset_revolution_counter
    set_analog_output_domain set_flag_action assert reset_world_model"""
)


class UrDialect(Dialect):
    """The dialect of URScript."""

    has_none: ClassVar = True
    constants: ClassVar = {
        "MATH_PI": math.pi, "pi": math.pi, "PI": math.pi, "NO": 0, "d_base": 0,
    }  # fmt: skip

    def __init__(self) -> None:
        super().__init__(FUNCTIONS, IGNORED)

    def binary(self, operator: str, left: Any, right: Any) -> Any:
        """Return the value of a binary operation."""
        if operator in OF_VALUES:
            return OF_VALUES[operator](left, right)
        if operator in "+-*/" and (isinstance(left, list) or isinstance(right, list)):
            return _elementwise(operator, left, right)
        if operator == "+" and (isinstance(left, str) or isinstance(right, str)):
            return text_of(left) + text_of(right)
        return arithmetic(operator, left, right)

    def literal(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of a list, a pose, or a method of something."""
        if node.kind == "method":
            raise task.unsupported(node, scope, f".{node.name}()")
        if node.kind == "option":
            raise task.error(node, scope, f"{node.name}= stands only in calls")
        values = yield from task.values(node.parts, scope)
        return UrPose(float(value) for value in values) if node.kind == "pose" else values

    def assigned(self, variable: Any, value: Any) -> Any:
        """Return what a variable gets; lists are copied."""
        if not isinstance(value, list):
            return value
        return type(value)(self.assigned(variable, element) for element in value)


def _elementwise(operator: str, left: Any, right: Any) -> Any:
    if isinstance(left, list) and isinstance(right, list):
        if len(left) != len(right) or operator in "*/":
            raise TypeError("lists of different lengths")
        made = [arithmetic(operator, first, second) for first, second in zip(left, right, strict=True)]
    elif isinstance(left, list):
        made = [arithmetic(operator, element, right) for element in left]
    else:
        made = [arithmetic(operator, left, element) for element in right]
    return UrPose(made) if isinstance(left, UrPose) or isinstance(right, UrPose) else made


def arithmetic(operator: str, left: Any, right: Any) -> Any:
    """Return the result of a binary operation of numbers. Raises TypeError for anything else."""
    is_compared = operator in ("<", ">", "<=", ">=")
    if not _are_numbers(left, right) or (bool in (type(left), type(right)) and not is_compared):
        raise TypeError("only numbers can be calculated with")
    if operator == "%":
        are_whole = isinstance(left, int) and isinstance(right, int)
        return left % right if are_whole else math.fmod(left, right)
    return OF_NUMBERS[operator](left, right)


def _are_numbers(*values: Any) -> bool:
    return all(isinstance(value, (int, float)) for value in values)


def text_of(value: Any) -> str:
    """Return a value as URScript prints it."""
    if isinstance(value, bool):
        return "True" if value else "False"
    if isinstance(value, UrPose):
        return f"p[{', '.join(f'{element:g}' for element in value)}]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _given(
    task: Evaluation, node: ProgramNode, scope: RoutineScope, names: str
) -> Generator[Any, Any, dict[str, Any]]:
    """Return the arguments of a call by their names; those that are not given are missing."""
    values, named = yield from task.arguments(node, scope)
    order = names.split()
    if len(values) > len(order) or set(named) - set(order):
        raise task.error(node, scope, f"{node.name} takes {', '.join(order)}")
    return {**dict(zip(order, values, strict=False)), **named}


def _move(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out movej, movel and movep: to a pose, or to joint angles."""
    given = yield from _given(task, node, scope, "pose a v t r")
    target = next((given.pop(name) for name in ("pose", "q") if name in given), None)
    yield from move_to(task, node, scope, target, given)


def move_to(
    task: Evaluation, node: ProgramNode, scope: RoutineScope, target: Any, given: Mapping[str, Any]
) -> Steps:
    """Carry out movej, movel or movep."""
    station = task.station
    if not isinstance(target, list) or len(target) < 6 or not _are_numbers(*target):
        raise task.error(node, scope, f"{node.name} to {target!r}: expected a pose or six joint angles")
    angles = None if isinstance(target, UrPose) else [math.degrees(deg) for deg in target]
    seconds = float(given.get("t") or 0.0)
    if node.name == "movej":
        speed = float(given.get("v", 1.05))
        _check(task, node, scope, speed)
        part = speed / _fastest_joint(station)
        if angles is None:
            motion = station.joint_move_to(frame_of(target), part)
        else:
            motion = station.joint_move(angles, part)
        if seconds > 0 and motion[0] == "move_joints":
            now = station.call(task.site(node, scope), task.station.cell.arm.commanded_joints)
            speed = math.radians(max(abs(a - b) for a, b in zip(*motion[1], now, strict=False))) / seconds
            motion = station.joint_move([*motion[1][0]], speed / _fastest_joint(station))
        yield from task.move(node, scope, motion)
        return
    speed = float(given.get("v", 0.25))
    _check(task, node, scope, speed)
    frame = frame_of(target) if angles is None else station.forward(angles)
    if seconds > 0:
        speed = max(1e-6, station.commanded(task.site(node, scope)).distance(frame) / seconds)
    yield from task.move(node, scope, station.line(frame, speed))


def _check(task: Evaluation, node: ProgramNode, scope: RoutineScope, speed: float) -> None:
    if not speed > 0:
        raise task.error(node, scope, f"{node.name} with the speed {speed:g}")


def _fastest_joint(station: Any) -> float:
    speeds = station.model.limits.speed
    return float(max(speeds) if isinstance(speeds, (tuple, list)) else speeds)


def _movec(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    given = yield from _given(task, node, scope, "via to a v r mode")
    via, end = frame_of(given["via"]), frame_of(given["to"])
    start = task.station.commanded(task.site(node, scope))
    for motion in task.station.arc(start, via, end, float(given.get("v", 0.25))):
        yield from task.move(node, scope, motion)


def _sync(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    yield from task.wait(node, scope, 0.01)


def _set_tcp(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    task.station.tool = frame_of(values[0])


def _inverse(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    given = yield from _given(task, node, scope, "x qnear maxPositionError maxOrientationError tcp")
    near = given.get("qnear")
    degrees = [math.degrees(deg) for deg in near] if near else None
    if degrees is not None and len(degrees) < task.station.joints:
        degrees = None
    found = task.station.inverse(frame_of(given["x"]), degrees)
    return [math.radians(deg) for deg in found]


def _forward(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    if values:
        return pose_of(task.station.forward([math.degrees(value) for value in values[0]]))
    return pose_of(task.station.commanded(task.site(node, scope)))


def _run(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out ``run thread()``, which starts a task and gives its number."""
    call = node.parts[0]
    routine = task.find_routine(call.name, scope)
    if routine is None:
        raise task.error(node, scope, f"there is no thread {call.name}")
    machine = task.machine
    number = getattr(machine, "threads", 0) + 1
    machine.threads = number  # type: ignore[attr-defined]
    name = f"{call.name} {number}"
    machine.start(name, ProgramTask(machine, name).call_routine(routine, call.parts, node, scope))
    return (name,)
    yield  # pragma: no cover


def _kill(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    thread = yield from _thread(task, node, scope)
    steps = task.machine.tasks.pop(thread, None)
    if steps is not None:
        steps.close()


def _thread(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    value = yield from task.value(node.parts[0], scope)
    if not isinstance(value, tuple):
        raise task.error(node, scope, f"{node.name} of {value!r}, which is no thread")
    return value[0]


def _join(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    thread = yield from _thread(task, node, scope)
    while thread in task.machine.tasks:
        yield from task.wait(node, scope, 0.01)


def _signal(use: Callable[..., Any], name: str) -> Callable[..., Steps]:
    """Return a function that does something with a signal ``name[n]``."""

    def call(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
        (number, *values), _ = yield from task.arguments(node, scope)
        return use(task.station, task.site(node, scope), f"{name}[{int(number)}]", *values)

    return call


def _last(station: Station, site: ProgramPlace, name: str) -> Any:
    return station.outputs.get(name, False)


def _pose_now(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> UrPose:
    is_actual = "actual" in node.name
    site = task.site(node, scope)
    return pose_of(task.station.actual(site) if is_actual else task.station.commanded(site))


def _joints_now(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> list[float]:
    site = task.site(node, scope)
    if "target" in node.name:
        return [math.radians(deg) for deg in task.station.call(site, task.station.cell.arm.commanded_joints)]
    return [math.radians(deg) for deg in task.station.angles(site)]


def _wrench(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
    wrench = task.station.call(task.site(node, scope), task.station.cell.force_sensor.wrench)
    forces = [wrench.fx, wrench.fy, wrench.fz, wrench.tx, wrench.ty, wrench.tz]
    return math.hypot(*forces[:3]) if node.name == "force" else forces


def _struct(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out ``struct(a=1)``: its components by name."""
    _, named = yield from task.arguments(node, scope)
    return Structure.of("struct", named)


def _pose_add(first: Any, second: Any, sign: int = 1) -> UrPose:
    a, b = frame_of(first), frame_of(second)
    x, y, z = (p + sign * q for p, q in zip(a.position, b.position, strict=True))
    turn = b if sign > 0 else b.inverse()
    return pose_of(Frame((x, y, z), (a * turn).rotation))


def _euler(roll: float, pitch: float, yaw: float) -> list[float]:
    degrees = [math.degrees(deg) for deg in (yaw, pitch, roll)]
    return list(Frame.of_euler((0, 0, 0), *degrees).vector())


def _rpy(values: Any) -> list[float]:
    yaw, pitch, roll = Frame.of_vector((0, 0, 0), values).euler()
    return [math.radians(deg) for deg in (roll, pitch, yaw)]


_PLAIN: dict[str, Callable[..., Any]] = {
    "pose_trans": lambda a, b: pose_of(frame_of(a) * frame_of(b)),
    "pose_inv": lambda a: pose_of(frame_of(a).inverse()),
    "pose_add": _pose_add,
    "pose_sub": lambda a, b: _pose_add(a, b, -1),
    "pose_dist": lambda a, b: frame_of(a).distance(frame_of(b)),
    "point_dist": lambda a, b: math.dist(a[:3], b[:3]),
    "interpolate_pose": lambda a, b, part: pose_of(frame_of(a).between(frame_of(b), part)),
    "wrench_trans": lambda a, b: b,
    "rpy2rotvec": lambda *given: _euler(*(given[0] if isinstance(given[0], list) else given)),
    "rotvec2rpy": lambda *given: _rpy(given[0] if isinstance(given[0], list) else given),
    "d2r": math.radians, "r2d": math.degrees, "sin": math.sin, "cos": math.cos, "tan": math.tan,
    "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2, "sqrt": math.sqrt,
    "pow": lambda a, b: a**b, "log": lambda base, value: math.log(value, base), "floor": math.floor,
    "ceil": math.ceil,
    "norm": lambda value: math.hypot(*value) if isinstance(value, list) else abs(value),
    "length": len, "size": len, "to_num": float, "to_str": text_of, "str_cat": lambda a,
    b: text_of(a) + text_of(b),
    "str_len": len, "str_empty": lambda text: not text, "str_at": lambda text, at: text[at],
    "str_sub": lambda text, at, count=None: text[at:] if count is None else text[at : at + count],
    "str_find": lambda text, part, start=0: text.find(part, start),
    "integer_to_binary_list": lambda value: [bool(int(value) >> bit & 1) for bit in range(32)],
    "binary_list_to_integer": lambda bits: sum(1 << at for at, bit in enumerate(bits) if bit),
    "normalize": lambda value: [component / math.hypot(*value) for component in value],
    "make_list": lambda count, value=0, capacity=0: [value] * int(count),
    "abs": abs, "max": max, "min": min, "round": round,
}  # fmt: skip
_SIGNALS = {
    "standard_digital": "standard_digital", "configurable_digital": "configurable_digital",
    "tool_digital": "tool_digital", "digital": "standard_digital", "standard_analog": "standard_analog",
    "analog": "standard_analog", "tool_analog": "tool_analog", "flag": "flag", "euromap": "euromap",
    "gp_boolean": "gp_boolean",
}  # fmt: skip


def _has_inverse(task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
    try:
        yield from _inverse(task, node, scope)
    except UnreachableError:
        return False
    return True


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "get_inverse_kin_has_solution": _has_inverse,
    "set_flag": _signal(Station.write, "flag"), "get_flag": _signal(_last, "flag"),
    "movej": _move, "movel": _move, "movep": _move, "movec": _movec, "sleep": pause, "sync": _sync,
    "set_tcp": _set_tcp, "get_inverse_kin": _inverse, "get_forward_kin": _forward, "run": _run, "kill": _kill,
    "join": _join, "halt": end_program, "struct": _struct, "get_actual_tcp_pose": _pose_now,
    "get_target_tcp_pose": _pose_now,
    "get_actual_tool_flange_pose": _pose_now, "get_actual_joint_positions": _joints_now,
    "get_target_joint_positions": _joints_now, "get_joint_positions": _joints_now, "force": _wrench,
    "get_tcp_force": _wrench, "get_steptime": lambda task, node, scope: 0.01,
    "stopj": lambda task, node, scope: None, "stopl": lambda task, node, scope: None,
    "is_steady": lambda task, node, scope: True,
    "get_tcp_offset": lambda task, node, scope: pose_of(task.station.tool),
    "is_within_safety_limits": of_values(lambda *given: True),
    **{name: of_values(function) for name, function in _PLAIN.items()},
    **{f"get_{name}_in": _signal(Station.read, f"{signal}_in") for name, signal in _SIGNALS.items()},
    **{f"set_{name}_out": _signal(Station.write, f"{signal}_out") for name, signal in _SIGNALS.items()},
    **{f"get_{name}_out": _signal(_last, f"{signal}_out") for name, signal in _SIGNALS.items()},
}  # fmt: skip
