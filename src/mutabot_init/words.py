"""The meanings of words in the names of robot libraries: a table of verbs, one of nouns, one of units."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

#: before which a word is two: ``batchwrite``, but no ``multithread``
_JOINED = re.compile(r"(?<=[a-z]{4})(?<!th)(?<!sp)(?=(?:read|write)$)")
_WORD = re.compile(r"(?<![A-Za-z])[A-Za-z]{1,2}\d+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case: ``set``, ``digital``, ``out``; ``move``, ``j``."""
    words = [word.lower() for word in _WORD.findall(name)]
    return tuple(part for word in words for part in _JOINED.sub(" ", word).split())


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


def _by_word(table: Mapping[str, str]) -> dict[str, str]:
    return {word: meaning for meaning, words in table.items() for word in words.split()}


#: what a motion does, by the verb in the name of a callable
VERBS = _by_word(
    {
        "translation": "move movel movep movec servol servop go goto travel drive fly approach translate arc "
        "shift jog slide lift lower raise drop ascend descend curve linear",
        "rotation": "rotate turn spin swivel rot clockwise counterclockwise anticlockwise cw ccw movej "
        "servoj",
        "duration": "wait sleep pause dwell delay",
    }
)
#: along which axis, by the direction in the name of a callable
DIRECTIONS = _by_word(
    {
        "z": "up down lift lower raise drop ascend descend",
        "x": "forward forwards back backward backwards",
        "y": "left right",
    }
)
TURNS = _words("clockwise counterclockwise anticlockwise cw ccw left right")
MODES = _by_word(
    {
        "by": "by relative rel offset shift jog translate rotate turn delta increment forward forwards back "
        "backward backwards left right up down lift lower raise drop ascend descend clockwise "
        "counterclockwise anticlockwise cw ccw",
        "to": "to at absolute abs goto target set movel movej movep movec servol servoj ptp lin position "
        "positions pose joints",
    }
)
#: words by which an assigned value is a change
CHANGES = _words("by relative rel offset shift jog delta increment")
#: callables that make the robot do something, and those that only read
COMMANDS = _words(
    "home park move movej movel movep movec go goto pick place grasp grip grab release open close lock "
    "unlock wait sleep stop lift lower raise drop rotate turn translate attach detach push start feed insert "
    "press screw weld dock undock servo servoj servol speedj speedl step write jog drive set send sendall "
    "command enable disable ptp lin calibrate takeoff land fly up down left right forward "
    "forwards back backward backwards curve flip clockwise counterclockwise on off toggle blink "
    "emergency arm disarm pulse pause resume aspirate dispense halt activate deactivate shake"
)
#: words that are commands only where a name begins with them
IMPERATIVES = _words(
    "brake clamp unclamp extend retract engage disengage infuse withdraw prime tare eject inject hold "
    "hover play"
)
#: what moves by itself, and what it is told: other classes run programs, tasks and loops
ACTUATORS = _words(
    "motor motors servo servos stepper actuator thruster winch pump conveyor axis wheel wheels"
)
DRIVEN = _words("run coast")
READERS = _words(
    "read get getl getj query ask measure is has recv receive where locate detect scan actual current"
)
#: how callables begin that read, whatever else they are called
ASKING = _words("read get getl getj query ask recv receive")
#: how functions are called that put values into a buffer
PACKERS = _words("set put pack encode insert")
#: how what only computes is called, whatever its text does on the way
COMPUTERS = _words(
    "calculate calc compute estimate parse format encode decode serialize deserialize check validate verify "
    "ik inverse solve random"
)
#: those that make no more than another form of what they are given
CODECS = _words("parse format encode decode serialize deserialize render")
#: how functions are called that make a request, which something else sends
BUILDERS = _words("build prepare construct generate")
#: how callables begin that keep something for later
KEEPERS = _words("save store record remember adopt")
#: what counts or keeps what was done
BOOKS = _words("metric metrics statistic statistics stats buffer cache history viewer")
#: what is made ready before the robot does anything, and the clock of a simulator
SETUP = _words(
    "create connect disconnect load make init initialize configure configuration simulation reset safety "
    "handler callback listener observer username password login logout authenticate baud baudrate bitrate "
    "parity stopbits bytesize"
)
#: what a function is called that is handed over, to be called back
CALLBACKS = _words("callback callbacks handler listener observer")
#: what lets a simulation go on, and what has such a clock
STEPS = _words("step tick advance stepSimulation step_simulation")
SIMULATORS = _words("sim simulation simulator world physics scene engine")
TALK = _words("log logging comment print say show info warn warning debug error display event")
#: commands to a connection, or to what runs beside the program, and questions about them
CONNECTION = _words("open close closed opened")
RUNNING = _words("start stop")
#: what runs beside the program, and what it is connected by: beginning or ending them moves nothing
HELPERS = _words(
    "notifier listener thread timer logger socket connection transport interface serial port link session"
)
#: how long or wide something is, and not how far it goes, unless a verb says so
SIZES = _words("length width diameter thickness")
#: words of settings, which no sensor reads
SETTINGS = _words("max maximum min minimum default initial limit limits only supported supports configured")
#: what a sensor measures of which vocabularies have no kind of its own
MEASURED = _words(
    "flow humidity ph conductivity turbidity density viscosity illuminance lux setpoint battery"
)
#: what says how often or how much of it, and is measured by no sensor
COUNTED = _words("count id index unit units type source status mode time total name")
#: what something is, which never changes
TYPES = _words("type kind category")
#: words for a state that are no participles
STATES = _words("in at found held lost stuck contact ready busy")
#: predicates of replies and of connections, which no sensor reads
HOUSEKEEPING = _words(
    "error ok success connected alive valid failed exception setup installed reply response zero nan finite "
    "update updates upgrade"
)
#: what is asked of a connection, whatever follows
LINKED = _words("connected alive online reachable ping")
FRAMES = _words("frame packet pdu message telegram datagram")
REPLIES = _words("response reply result error exception future pdu packet message status")
#: what a person moves, and not the robot
INPUTS = _words("joystick gamepad stick xbox keyboard mouse")
#: what takes pictures: it grabs no part
CAMERAS = _words("camera cam video capture frame picture image")
GRIPPER = _words("gripper grip hand finger fingers claw jaw vacuum suction suck grasp grasping hande robotiq")
OUTPUT = _words("output outputs digital signal valve relay lamp coil io do out led gpio solenoid")

#: what has a width in seconds, hertz or bits
SIGNALS = _words("pulse frame band bit data bus line")
#: what has a range in its own unit, a setting
RANGED = _words("gyro accel accelerometer magnetometer imu voltage current scale full dynamic")

#: words that undo each other
OPPOSITES = (
    ("lift", "drop"), ("raise", "lower"), ("up", "down"), ("pick", "release"), ("grip", "release"),
    ("grasp", "release"), ("open", "close"), ("on", "off"), ("forward", "back"), ("forward", "backward"),
    ("left", "right"), ("start", "stop"), ("attach", "detach"), ("extend", "retract"), ("clamp", "unclamp"),
    ("lock", "unlock"), ("engage", "disengage"), ("activate", "deactivate"),
)  # fmt: skip

#: what a value is, by the last noun in its name
NOUNS = _by_word(
    {
        "speed": "speed speeds velocity velocities vel vels omega speedl speedj",
        "acceleration": "acceleration accelerations acc accel mvacc a_max",
        "jerk": "jerk",
        "force": "force forces thrust",
        "torque": "torque torques effort moment",
        "mass": "mass payload weight",
        "temperature": "temperature temp",
        "pressure": "pressure",
        "voltage": "voltage volts",
        "frequency": "frequency freq hz bandwidth",
        "ratio": "ratio percent percentage brightness throttle power throttle duty",
        "height": "height altitude depth lift",
        "length": "distance dist length amount travel range gap ultrasonic lidar width",
        "angle": "angle angles theta degree degrees deg radians rad heading bearing rotation turn "
        "alpha beta gamma",
        "joints": "joints jnts joint q qpos qs jpos",
        "place": "pose tpose poses tcp xyz pos position positions location point waypoint coord coords "
        "translation target where locate goto goal getl movel",
        "turned": "orientation rotvec rpy euler orn",
        "time": "seconds secs sec duration time delay dwell pause milliseconds t wait sleep",
        "opening": "opening openness gripper",
        "switch": "on off enable enabled signal level active closed open state grip",
        "label": "color colour label kind type category",
        "generic": "value val command cmd setpoint data",
        "action": "action actions act ctrl",
        "none": "boot stamp timestamp mask rate axis code status err errno id index idx port channel "
        "timeout name mode number num count steps samples iterations n blocking radius gain gains limit "
        "limits size rgb lookahead key flag flags tolerance tolerances threshold epsilon unit units inertia",
    }
)
#: what a setter may be about, whatever its argument is called
SUBJECTS = _words("speed acceleration jerk force torque mass temperature pressure voltage frequency ratio")
#: which kind of quantity such a value is, written and read, and in which units
KINDS: Mapping[str, tuple[str, str, str]] = {
    **{kind: (kind, kind, kind) for kind in SUBJECTS},
    "height": ("translation", "distance", "length"),
    "length": ("translation", "distance", "length"),
    "angle": ("rotation", "angle", "angle"),
    "time": ("duration", "", "time"),
}
_LENGTHS = {
    "mm": r"mm|(?i:millimet(?:er|re)s?)",
    "cm": r"cm|(?i:centimet(?:er|re)s?)",
    "m": r"m|(?i:met(?:er|re)s?)",
}
#: degrees of freedom, and those of motion, are no unit
_ANGLES = {
    "deg": r"(?i:deg|degrees?)(?![\s-]+of[\s-]+(?:\w+[\s-]+)?(?i:freedom|motion|mobility))|°",
    "rad": r"(?i:rad|radians?)",
}
_PER_SECOND = r"(?:\s*/\s*s(?:ec(?:ond)?s?)?|\s+per\s+second)"
_SQUARED = r"\s*/\s*s(?:ec)?\s*(?:\^2|²|\*\*2|2|/\s*s(?:ec)?)"
#: how docstrings and names write each unit; what is longer comes first
_SPELT: Mapping[str, str] = {
    **{f"{unit}/s^3": rf"(?:{text})\s*/\s*s(?:\^3|³|\*\*3|3)" for unit, text in (_LENGTHS | _ANGLES).items()},
    **{f"{unit}/s^2": rf"(?:{text}){_SQUARED}" for unit, text in (_LENGTHS | _ANGLES).items()},
    **{f"{unit}/s": rf"(?:{text}){_PER_SECOND}" for unit, text in (_LENGTHS | _ANGLES).items()},
    "rpm": r"(?i:rpm)",
    **_LENGTHS,
    **_ANGLES,
    "ms": r"ms|(?i:msecs?|milliseconds?)",
    "s": r"s|(?i:secs?|seconds?)",
    "Nm": r"N\s?m|(?i:newton[ -]?met(?:er|re)s?)",
    "N": r"N|(?i:newtons?)",
    "kg": r"kg|(?i:kilograms?)",
    "V": r"V|(?i:volts?)",
    "Hz": r"Hz|(?i:hertz)",
    "percent": r"%|(?i:perc|pct|percent(?:ages?)?)",
    "degC": r"°C|(?i:celsius)",
    "Pa": r"Pa|(?i:pascals?)",
    "kPa": r"kPa|(?i:kilopascals?)",
    "mbar": r"(?i:mbar|millibars?)",
    "bar": r"(?i:bars?)",
    "psi": r"(?i:psi)",
}
_UNIT = re.compile(
    r"(?<![\w/'’°])(?:"
    + "|".join(f"(?P<u{number}>{text})" for number, text in enumerate(_SPELT.values()))
    + r")(?![\w/²³^'’])"
)
#: how names end that have their unit in two words, as ``speed_m_s``
UNITS_OF_TWO_WORDS: Mapping[tuple[str, ...], str] = {
    (unit, "s"): f"{unit}/s" for unit in ("m", "cm", "mm", "rad", "deg")
}
#: units in letters that only mean them after such a noun, as in ``torque_nm``
UNITS_OF_LETTERS = {("torque", "nm"): "Nm", ("temperature", "c"): "degC", ("voltage", "v"): "V"}
UNITS: Mapping[str, tuple[str, ...]] = {
    "length": ("m", "cm", "mm"),
    "angle": ("rad", "deg"),
    "time": ("s", "ms"),
    "speed": ("m/s", "cm/s", "mm/s", "rad/s", "deg/s", "rpm"),
    "acceleration": ("m/s^2", "mm/s^2", "rad/s^2", "deg/s^2"),
    "jerk": ("m/s^3", "mm/s^3", "rad/s^3", "deg/s^3"),
    "force": ("N",),
    "torque": ("Nm",),
    "mass": ("kg", "g"),
    "temperature": ("degC",),
    "pressure": ("Pa", "kPa", "mbar", "bar", "psi"),
    "voltage": ("V",),
    "frequency": ("Hz",),
    "ratio": ("percent", "fraction"),
}


def units_in(text: str, dimension: str) -> list[str]:
    """Return the different units of a dimension that a text names, in order."""
    names = list(_SPELT)
    found = [names[int(str(match.lastgroup)[1:])] for match in _UNIT.finditer(text)]
    return [unit for unit in dict.fromkeys(found) if unit in UNITS[dimension]]


def noun_of(words: Sequence[str]) -> str:
    """Return what a value with such a name is, by its last known noun; empty without one."""
    noun = next((NOUNS[word] for word in reversed(words) if word in NOUNS), "")
    is_signal = "width" in words and SIGNALS & set(words)
    return "" if noun == "length" and (is_signal or ("range" in words and RANGED & set(words))) else noun


def first(table: Mapping[str, str], words: Iterable[str]) -> str | None:
    """Return the meaning of the first word that a table contains."""
    return next((table[word] for word in words if word in table), None)
