"""The instructions and functions of RAPID: motions, signals, waits, frames, mathematics and texts."""

from __future__ import annotations

import copy
import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

from mutabot_languages.core.frames import IDENTITY, Frame, cross
from mutabot_languages.core.names import name_set
from mutabot_languages.core.scope import ProgramRaised, RoutineScope, Steps, Structure, Variable
from mutabot_languages.core.station import matrix_frame
from mutabot_languages.core.task import OF_DEGREES, ProgramTask, end_program, of_values, pause
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import UnreachableError

from .interrupts import INTERRUPTS, trigger_watch
from .types import STRUCTURES, frame_of, put_frame, shaped

#: what has no effect in the cell, and is noted
IGNORED = name_set(
    """stop confl confj singarea accset velset pathaccllim pathacclim gripload tpwrite errwrite tperase tpshow
    skipwarn syncmoveon syncmoveoff waitsynctask syncmoveundo actunit deactunit actevent evtset motionsup
    speedrefresh worldacclim pathresol softact softdeact corrclear load unload save startload waitload
    cancelload erasemodule logtext spystart spystop setsysdata resetretrycount resetpppdata bookerrno
    motionprocessmodeset circpathmode tuneservo tunereset eoffson eoffsoff eoffsset opennocompress
    setallhdpos breakpoint break uimsgbox uimsgwrite saferuncheck wzdisable wzenable jointlimitset
    sysstopaction manloadidproc paridposvalid tpreadnum accsetmax cyclestartedreset enabletaskauto
    gripsetload cpoff cpon speedlim speedlimit robotwarning wait_sync reconnect process_stop errlog
    writestrbin tplogmessage systemstopaction"""
)
_TIMEOUT = "err_wait_maxtime"


def structures(task: ProgramTask) -> Any:
    """Return the structures of the program."""
    return getattr(task.dialect, "structures", STRUCTURES)


def _base(task: ProgramTask, named: dict[str, Any]) -> Frame:
    """Return the displaced frame, on the robot's base, of a work object among arguments."""
    frame = IDENTITY
    if named.get("wobj") is not None:
        wobj = _target(task, named["wobj"], "wobjdata")
        frame = frame_of(wobj["uframe"]) * frame_of(wobj["oframe"])
    shift = getattr(task.machine, "displacement", None)
    return frame if shift is None else frame * shift


def _target(task: ProgramTask, value: Any, type: str) -> Any:
    found = shaped(value, type, structures(task))
    if not isinstance(found, Structure) or found.type != type:
        raise TypeError(f"expected {type}, found {getattr(found, 'type', '') or repr(value)}")
    return found


def _move(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out MoveJ, MoveL, MoveC, MoveAbsJ, and those that set an output or call a routine at the end."""
    values, named = yield from _given(task, node, scope)
    name = node.name
    is_circle, is_joint = name.startswith(("movec", "triggc")), name.startswith("moveabsj")
    via = values.pop(0) if is_circle else None
    points = [values.pop(2)] if name.startswith("trigg") and len(values) > 2 else []
    points += [named.pop(f"t{number}") for number in range(2, 9) if f"t{number}" in named]
    if len(values) < 4 and not (is_joint and len(values) >= 3):
        raise task.error(node, scope, f"{name} takes a target, a speed, a zone and a tool")
    target, speed = values[0], _target(task, values[1], "speeddata")
    tool = _target(task, values[3], "tooldata") if len(values) > 3 else None
    station = task.station
    if tool is not None:
        station.tool = frame_of(tool["tframe"])
    base = _base(task, named)
    pace = float(named.get("v") or speed["v_tcp"]) / 1000
    if pace <= 0:
        raise task.error(node, scope, f"{name} with the speed {pace * 1000:g} mm/s")
    part = pace / float(station.model.tool_limits.speed)
    if is_joint:
        joints = [float(angle) for angle in _target(task, target, "jointtarget")["robax"].values()]
        joints += _seventh(task, _target(task, target, "jointtarget"))
        yield from task.move(node, scope, station.joint_move(joints, part))
    else:
        frame = base * frame_of(_target(task, target, "robtarget"))
        if named.get("t"):
            start = station.commanded(task.site(node, scope))
            pace = max(1e-4, start.distance(frame) / float(named["t"]))
            part = pace / float(station.model.tool_limits.speed)
        look = trigger_watch(task, points, frame) if points else None
        if is_circle:
            middle = base * frame_of(_target(task, via, "robtarget"))
            start = station.commanded(task.site(node, scope))
            for motion in station.arc(start, middle, frame, pace):
                yield from task.move(node, scope, motion, look)
        elif name.startswith(("movej", "triggj")):
            yield from task.move(node, scope, station.joint_move_to(frame, part), look)
        else:
            yield from task.move(node, scope, station.line(frame, pace), look)
        if look is not None:
            look(True)
    yield from _at_end(task, node, scope, name, values)


def _seventh(task: ProgramTask, target: Any) -> list[float]:
    """Return the angle of the seventh joint, which is the first external axis; empty for arms without one."""
    value = float(target["extax"]["eax_a"])
    return [value] if task.station.joints > 6 and abs(value) < 1e8 else []


def _at_end(task: ProgramTask, node: ProgramNode, scope: RoutineScope, name: str, values: list[Any]) -> Steps:
    if name.endswith(("do", "ao", "go")) and len(values) > 5:
        signals = node.plain
        signal = signals[-2].name
        task.station.write(task.site(node, scope), signal, values[-1])
    elif name.endswith("sync") and values and isinstance(values[-1], str):
        yield from _call_by_name(task, node, scope, values[-1].lower(), [])


def _given(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    """Return the arguments of a motion; signals are not read."""
    values, named = list[Any](), dict[str, Any]()
    plain = node.plain
    skipped = plain[-2:-1] if node.name.endswith(("do", "ao", "go")) and len(plain) > 5 else []
    for part in node.parts:
        if part.kind == "option":
            if part.value == "conditional" and part.parts[0].name not in scope.given:
                continue
            named[part.name] = (yield from task.value(part.parts[0], scope)) if part.parts else True
        elif part in skipped:
            values.append(None)
        else:
            values.append((yield from task.value(part, scope)))
    return values, named


# signals


def _signal(task: ProgramTask, node: ProgramNode, scope: RoutineScope, part: ProgramNode) -> str:
    """Return the name of the signal that a name, an alias or a parameter stands for."""
    found = task.find(part.name, scope) if part.kind == "name" else None
    if found is not None and isinstance(found.value, str):
        return found.value
    return part.name


def _set(value: int) -> Callable[..., Any]:
    def write(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
        task.station.write(task.site(node, scope), _signal(task, node, scope, node.parts[0]), value)

    return write


def _set_to(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out SetDO, SetGO, SetAO, with a delay."""
    parts = node.plain
    value = yield from task.value(parts[1], scope)
    for option in node.parts:
        if option.kind == "option" and option.name == "sdelay" and option.parts:
            yield from task.wait(node, scope, float((yield from task.value(option.parts[0], scope))))
    task.station.write(task.site(node, scope), _signal(task, node, scope, parts[0]), value)


def _pulse(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    parts, named = node.plain, node.options
    seconds = 0.2
    if "plength" in named:
        seconds = float((yield from task.value(named["plength"].parts[0], scope)))
    signal = _signal(task, node, scope, parts[0])
    task.station.write(task.site(node, scope), signal, 1)
    yield from task.wait(node, scope, seconds)
    task.station.write(task.site(node, scope), signal, 0)


def _invert(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    signal = _signal(task, node, scope, node.parts[0])
    before = task.station.outputs.get(signal.lower(), 0)
    task.station.write(task.site(node, scope), signal, 0 if before else 1)


def _read(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    return task.station.read(task.site(node, scope), _signal(task, node, scope, node.parts[0]))


def _test(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> bool:
    return bool(_read(task, node, scope))


def _number_in(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    value = _read(task, node, scope)
    return int(value) if isinstance(value, bool) else value


def _output(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    return int(task.station.outputs.get(_signal(task, node, scope, node.parts[0]).lower(), 0))


# waits


def _options(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    named = node.options
    seconds = 0.0
    if "maxtime" in named:
        seconds = float((yield from task.value(named["maxtime"].parts[0], scope)))
    return seconds, named.get("timeflag")


def _wait_signal(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    parts = node.plain
    wanted = yield from task.value(parts[1], scope)
    signal = _signal(task, node, scope, parts[0])
    site = task.site(node, scope)

    def holds() -> Steps:
        is_output = node.name.startswith(("waitdo", "waitgo", "waitao"))
        value = task.station.outputs.get(signal.lower(), 0) if is_output else task.station.read(site, signal)
        return float(value) == float(wanted)
        yield  # pragma: no cover  (makes it a generator)

    yield from _wait_for(task, node, scope, holds)


def _wait_until(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    condition = next(part for part in node.parts if part.kind != "option")
    yield from _wait_for(task, node, scope, lambda: task.value(condition, scope))


def _wait_for(task: ProgramTask, node: ProgramNode, scope: RoutineScope, holds: Callable[[], Steps]) -> Steps:
    seconds, flag = yield from _options(task, node, scope)
    is_over = not (yield from task.until(node, scope, holds, seconds))
    if flag is not None and flag.parts:
        yield from task.store(flag.parts[0], is_over, scope)
    elif is_over:
        raise ProgramRaised(_TIMEOUT, f"{node.name} waited in vain")


# frames


def _offs(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    target = _target(task, values[0], "robtarget")
    made = copy.deepcopy(target)
    for name, amount in zip("xyz", values[1:], strict=True):
        made["trans"][name] += amount
    return made


def _rel_tool(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, named = yield from task.arguments(node, scope)
    target = _target(task, values[0], "robtarget")
    shift = Frame(tuple(value / 1000 for value in values[1:4]))
    turn = IDENTITY
    for name, axis in (("rx", (1, 0, 0)), ("ry", (0, 1, 0)), ("rz", (0, 0, 1))):
        angle = math.radians(float(named.get(name) or 0.0))
        turn = turn * Frame.of_vector((0, 0, 0), [component * angle for component in axis])
    return put_frame(target, frame_of(target) * shift * turn)


def _here(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out CRobT and CPos: where the tool is, in a work object."""
    _, named = yield from task.arguments(node, scope)
    station = task.station
    if named.get("tool"):
        station.tool = frame_of(_target(task, named["tool"], "tooldata")["tframe"])
    base = _base(task, named)
    at = base.inverse() * station.actual(task.site(node, scope))
    made = put_frame(_target(task, _NOWHERE, "robtarget"), at)
    return made["trans"] if node.name == "cpos" else made


_FREE = [9e9] * 6
_NOWHERE = [[0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], _FREE]


def _joints(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    angles = task.station.angles(task.site(node, scope))
    return _joint_target(task, angles)


def _joint_target(task: ProgramTask, angles: list[float]) -> Any:
    extra = [angles[6] if len(angles) > 6 else 9e9, *_FREE[1:]]
    return _target(task, [angles[:6], extra], "jointtarget")


def _calc_joints(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, named = yield from task.arguments(node, scope)
    task.station.tool = frame_of(_target(task, values[1], "tooldata")["tframe"])
    base = _base(task, named)
    frame = base * frame_of(_target(task, values[0], "robtarget"))
    number: Any = 0
    try:
        angles = task.station.inverse(frame)
    except UnreachableError as error:
        number = "err_roblimit" if error.is_limit else "err_outside_reach"
        if "errornumber" not in named:
            raise ProgramRaised(number, str(error)) from error
        angles = task.station.angles(task.site(node, scope))
    if "errornumber" in named:
        yield from task.store(node.options["errornumber"].parts[0], number, scope)
    return _joint_target(task, angles)


def _calc_target(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, named = yield from task.arguments(node, scope)
    joints = _target(task, values[0], "jointtarget")
    if len(values) > 1:
        task.station.tool = frame_of(_target(task, values[1], "tooldata")["tframe"])
    base = _base(task, named)
    at = task.station.forward([*joints["robax"].values(), *_seventh(task, joints)])
    return put_frame(_target(task, _NOWHERE, "robtarget"), base.inverse() * at)


def _displace(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out PDispSet, and PDispOff without arguments."""
    values, _ = yield from task.arguments(node, scope)
    shift = frame_of(_target(task, values[0], "pose")) if values else None
    task.machine.displacement = shift  # type: ignore[attr-defined]


def _orient(frame: Frame) -> Structure:
    return Structure.of("orient", dict(zip(("q1", "q2", "q3", "q4"), frame.rotation, strict=True)))


def _orient_zyx(z: float, y: float, x: float) -> Structure:
    return _orient(Frame.of_euler((0, 0, 0), z, y, x))


def _euler(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, named = yield from task.arguments(node, scope)
    rotation = list(_target(task, values[0], "orient").values())
    z, y, x = Frame.of_quaternion((0, 0, 0), rotation).euler()
    return {"x": x, "y": y, "z": z}[next(iter(named), "x")]


def _pose_record(task: ProgramTask, frame: Frame) -> Structure:
    return put_frame(_target(task, [[0, 0, 0], [1, 0, 0, 0]], "pose"), frame)


def _of_poses(function: Callable[..., Frame]) -> Callable[..., Steps]:
    """Return the function for PoseMult or PoseInv."""

    def call(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
        values, _ = yield from task.arguments(node, scope)
        return _pose_record(task, function(*(frame_of(_target(task, value, "pose")) for value in values)))

    return call


def _pose_vect(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    frame = frame_of(_target(task, values[0], "pose"))
    vector = _target(task, values[1], "pos")
    at = (frame * Frame(tuple(number / 1000 for number in vector.values()))).position
    return Structure.of("pos", dict(zip("xyz", (number * 1000 for number in at), strict=True)))


def _def_frame(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out DefFrame of three points: the first is the origin, the second on x,
    the third in the plane of x and y."""
    values, _ = yield from task.arguments(node, scope)
    places = [frame_of(_target(task, value, "robtarget")).position for value in values[:3]]
    origin, on_x, in_plane = places
    x = _unit(tuple(p - q for p, q in zip(on_x, origin, strict=True)))
    towards = tuple(p - q for p, q in zip(in_plane, origin, strict=True))
    z = _unit(cross(x, towards))
    y = cross(z, x)
    return _pose_record(task, matrix_frame(origin, [*zip(x, y, z, strict=True)]))


def _unit(vector: Any) -> Any:
    length = math.hypot(*vector)
    if length < 1e-9:
        raise ValueError("points that fall together make no frame")
    return tuple(component / length for component in vector)


# program flow


def _late(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out ``%"name"%``, which calls a routine by its name."""
    name = yield from task.value(node.parts[0], scope)
    return (yield from _call_by_name(task, node, scope, str(name).lower(), node.parts[1:]))


def _call_by_var(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    return (yield from _call_by_name(task, node, scope, f"{values[0]}{int(values[1])}".lower(), []))


def _call_by_name(
    task: ProgramTask, node: ProgramNode, scope: RoutineScope, name: str, arguments: Sequence[ProgramNode]
) -> Steps:
    routine = task.find_routine(name.rpartition(":")[2], scope)
    if routine is None:
        raise ProgramRaised("err_refunkprc", f"there is no routine {name}")
    return (yield from task.call_routine(routine, arguments, node, scope))


def _present(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> bool:
    return node.parts[0].name in scope.given


def _change(change: Callable[[float, float], float]) -> Callable[..., Steps]:
    """Return the function for Incr, Decr, Add or Clear."""

    def call(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
        now = yield from task.value(node.parts[0], scope)
        by = (yield from task.value(node.parts[1], scope)) if len(node.parts) > 1 else 1
        yield from task.store(node.parts[0], change(now, by), scope)

    return call


def _clock(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Any:
    """Carry out ClkReset, ClkStart, ClkStop or ClkRead of a clock."""
    variable: Variable | None = task.find(node.parts[0].name, scope)
    if variable is None:
        raise task.error(node, scope, f"there is no clock {node.parts[0].name}")
    passed, since = variable.value if isinstance(variable.value, tuple) else (0.0, None)
    now = task.station.time
    if node.name == "clkread":
        return passed + (now - since if since is not None else 0.0)
    if node.name == "clkreset":
        passed, since = 0.0, None
    elif node.name == "clkstart":
        since = now if since is None else since
    elif since is not None:
        passed, since = passed + now - since, None
    variable.value = (passed, since)
    return None


def _dim(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    found = values[0]
    for _ in range(int(values[1]) - 1):
        found = found[0]
    return len(found)


def _round(value: float, dec: int = 0, **_: Any) -> float:
    return float(math.floor(value * 10**dec + 0.5) / 10**dec)


def _trunc(value: float, dec: int = 0, **_: Any) -> float:
    return float(math.trunc(value * 10**dec) / 10**dec)


def number_text(value: float, decimals: int, **_: Any) -> str:
    """Return the text that NumToStr gives."""
    return f"{value:.{int(decimals)}f}"


def value_text(value: Any, **_: Any) -> str:
    """Return a value as RAPID writes it, as ValToStr does."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, (dict, list)):
        inner = value.values() if isinstance(value, dict) else value
        return f"[{','.join(value_text(element) for element in inner)}]"
    return f"{value:g}" if isinstance(value, (int, float)) else f'"{value}"'


def _distance(first: Any, second: Any) -> float:
    a, b = (list(value.values()) if isinstance(value, dict) else value for value in (first, second))
    return math.dist(a, b)


def _str_to_val(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out StrToVal of numbers and truth values; its value is whether the text could be read."""
    text = yield from task.value(node.parts[0], scope)
    known = {"true": True, "false": False}
    try:
        value: Any = known.get(text.strip().lower())
        value = float(text) if value is None else value
    except ValueError:
        return False
    yield from task.store(node.parts[1], value, scope)
    return True


def _bits(change: Callable[[int, int], int]) -> Callable[..., Any]:
    return of_values(lambda first, second: change(int(first), int(second)))


_MOVES = (
    "movej movel movec moveabsj movejdo moveldo movecdo movejao movelao movecao movejgo movelgo movecgo "
    "movejsync movelsync movecsync triggj triggl triggc"
)

FUNCTIONS: dict[str, Callable[..., Any]] = {
    **INTERRUPTS,
    **dict.fromkeys(_MOVES.split(), _move),
    "set": _set(1), "reset": _set(0), "setdo": _set_to, "setgo": _set_to, "setao": _set_to, "pulsedo": _pulse,
    "invertdo": _invert, "testdi": _test, "dinput": _number_in, "ginput": _number_in,
    "ginputdnum": _number_in, "ainput": _number_in,
    "doutput": _output, "goutput": _output, "aoutput": _output,
    "waittime": pause, "waitrob": lambda task, node, scope: None, "waituntil": _wait_until,
    **dict.fromkeys(["waitdi", "waitdo", "waitgi", "waitgo", "waitai", "waitao"], _wait_signal),
    "offs": _offs, "reltool": _rel_tool, "crobt": _here, "cpos": _here, "cjointt": _joints,
    "calcjointt": _calc_joints, "calcrobt": _calc_target, "pdispset": _displace, "pdispoff": _displace,
    "orientzyx": of_values(_orient_zyx), "eulerzyx": _euler, "posemult": _of_poses(operator.mul),
    "poseinv": _of_poses(Frame.inverse),
    "posevect": _pose_vect, "defframe": _def_frame,
    "%": _late, "callbyvar": _call_by_var, "present": _present, "exitcycle": end_program,
    "incr": _change(lambda now, by: now + 1), "decr": _change(lambda now, by: now - 1),
    "add": _change(lambda now, by: now + by), "clear": _change(lambda now, by: 0),
    **dict.fromkeys(["clkreset", "clkstart", "clkstop", "clkread"], _clock), "dim": _dim,
    "abs": of_values(abs), "absnum": of_values(abs), "sqrt": of_values(math.sqrt),
    "pow": of_values(lambda a, b: a**b),
    "exp": of_values(math.exp), "round": of_values(_round), "trunc": of_values(_trunc),
    **{name: of_values(function) for name, function in OF_DEGREES.items()},
    "atan": of_values(lambda value: math.degrees(math.atan(value))),
    "max": of_values(max), "min": of_values(min), "distance": of_values(_distance),
    "vectmagn": of_values(lambda value: math.hypot(*value.values())),
    **dict.fromkeys(["numtostr", "dnumtostr"], of_values(number_text)), "valtostr": of_values(value_text),
    "strlen": of_values(len), "strpart": of_values(lambda text, at,
    count: text[int(at) - 1 : int(at) - 1 + int(count)]),
    "strfind": of_values(lambda text, at, chars: next(
        (n + 1 for n in range(int(at) - 1, len(text)) if text[n] in chars), len(text) + 1)),
    "strmatch": of_values(lambda text, at, part: text.find(part, int(at) - 1) + 1 or len(text) + 1),
    "strtoval": _str_to_val, "numtodnum": of_values(float), "dnumtonum": of_values(float),
    "bitand": _bits(lambda a, b: a & b), "bitor": _bits(lambda a, b: a | b), "bitxor": _bits(lambda a,
    b: a ^ b),
    "bitlsh": _bits(lambda a, b: a << b), "bitrsh": _bits(lambda a, b: a >> b),
    **dict.fromkeys(["bitcheckdnum", "bitcheck"], _bits(lambda value, bit: bool(value & 1 << bit - 1))),
    "gettime": of_values(lambda **_: 0), "ctime": of_values(lambda: "00:00:00"),
    "cdate": of_values(lambda: "2000-01-01"),
    "runmode": of_values(lambda **_: 0), "opmode": of_values(lambda: 1),
    "gettaskname": of_values(lambda **_: "T_ROB1"),
    "robos": of_values(lambda: False), "isstopstateevent": of_values(lambda **_: False),
    "cspeedoverride": of_values(lambda **_: 100.0), "maxrobspeed": of_values(lambda: 5000.0),
}  # fmt: skip
