"""Guesses what arguments and results mean, from names, docstrings and values: a line or a question.

The verb of the callable decides first: the argument of ``set_speed(x)`` is a speed, that of ``move_up(x)``
a distance along z. A guess with questions becomes a comment in the draft.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from .observations import WatchedPart
from .words import (
    ASKING,
    COUNTED,
    DIRECTIONS,
    FRAMES,
    GRIPPER,
    HOUSEKEEPING,
    INPUTS,
    KINDS,
    MEASURED,
    MODES,
    NOUNS,
    OUTPUT,
    READERS,
    REPLIES,
    SETTINGS,
    SIZES,
    STATES,
    SUBJECTS,
    TURNS,
    TYPES,
    UNITS,
    UNITS_OF_LETTERS,
    UNITS_OF_TWO_WORDS,
    VERBS,
    first,
    noun_of,
    units_in,
    words_of,
)

#: a quantity as a vocabulary writes it; kind, axis and mode of a motion
TomlTable = dict[str, Any]
MotionMeaning = tuple[str, str | None, str | None]

_AXIS = re.compile(r"(?P<delta>d|delta_?|offset_?)?(?P<axis>[xyz])\d?")
_TURN = re.compile(r"(?:d|delta_?)?(?:theta|rot|rotation|angle|euler|r|w)_?(?P<axis>[xyz])")
#: kind, axis and mode of what is only named
_NAMED: Mapping[str, MotionMeaning] = {
    "angle": ("rotation", None, None),
    "height": ("translation", "z", None),
    "length": ("translation", None, "by"),
}
_RATE = re.compile(r"v_?(?P<axis>[xyz])")
_NAMED_TURNS = {"yaw": "z", "pitch": "y", "roll": "x", "heading": "z"}
_JOINT = re.compile(r"(?:j|joint_?|q|axis_?)(?P<number>[1-9]|1[0-2])")
_A_NUMBER = r"(-?\d+(?:\.\d+)?)"
#: how docstrings write a range
_RANGES = (
    re.compile(rf"between\s+{_A_NUMBER}\s*(?:\([^)]*\))?\s+and\s+(?:the\s+default\s+)?{_A_NUMBER}"),
    re.compile(rf"[\[(]{_A_NUMBER}\s*(?:\.\.\.?|,)\s*{_A_NUMBER}[\])]"),
    re.compile(rf"{_A_NUMBER}\s*(?:~|to)\s*{_A_NUMBER}"),
    # no date, and no name such as RS-485
    re.compile(r"(?<![\w.-])(\d+(?:\.\d+)?)\s?(?:-|–|\.\.\.?)\s?(\d+(?:\.\d+)?)(?![\w-]|\.\d)"),
)
#: what libraries may scale to a share of its most
_SCALED = frozenset({"speed", "acceleration", "angle", "force", "torque"})
#: ends of a scale without a unit: of a fraction, or of a number of bits
_TOPS = (1.0, 127.0, 255.0, 1023.0, 4095.0)
#: words of docstrings for a number that counts
_COUNT = re.compile(
    r"\b(?:number of(?! (?:milli|micro)?sec)|steps|samples|iterations|points)\b", re.IGNORECASE
)
#: a callable's words for a change, where what follows is no frame: ``move_to_relative_point``
_RELATIVE = re.compile(
    r"\brel(?:ative)?\b(?! to\b)|\b(?:run|on|move|drive|go|turn|rotate|spin|travel|forward|backward) for\b"
)
#: words of docstrings for numbers in the units of a drive
_RAW = re.compile(r"\b(?:encoder|(?:micro)?steps|counts|ticks|pulses|increments)\b", re.IGNORECASE)
#: how the line of another argument begins
_NEXT = re.compile(r"\s*(?:[:@]|[-*] |\w+\s*(?:\([^)]*\))?:|$)")
#: more different numbers than these are no settings, but a scale
_MOST_VALUES = 5
_MOST_JOINTS = 12
#: longer texts, and more of them, are no labels
_LONGEST_LABEL, _MOST_LABELS = 30, 6
#: arguments that say how to do it
_HOW = frozenset({"wait", "blocking", "sync", "relative", "asynchronous", "is_radian", "timeout"})
_ACTIONS = frozenset({"action", "actions", "act", "a", "u", "ctrl"})


@dataclass
class Guess:
    """A quantity and how certain the guess is.

    Attributes:
        table: the quantity; empty if nothing could be guessed.
        questions: what the user must answer before it counts.
        note: how it was found, where that was by the size of values.
    """

    table: TomlTable = field(default_factory=dict)
    questions: list[str] = field(default_factory=list)
    note: str = ""

    @property
    def is_sure(self) -> bool:
        """Whether the quantity can be added to the vocabulary as it is."""
        return bool(self.table) and not self.questions


@dataclass(frozen=True)
class NameContext:
    """The context of a name.

    Attributes:
        words: words of the callable's own name.
        owner: words of its class and module.
        doc: docstrings of the callable and its class, or of the class that holds the value.
        annotation: type as written, or empty.
        values: values that were seen, and what the program compares them with.
        names: the names of all arguments.
        relative: what an argument ``relative`` said; empty if there is none.
        members: names of the members of its enumeration.
        angle_unit: unit of angles, as an argument such as ``degrees`` said; empty if none did.
    """

    words: tuple[str, ...] = ()
    owner: tuple[str, ...] = ()
    doc: str = ""
    annotation: str = ""
    values: Sequence[Any] = ()
    names: frozenset[str] = frozenset()
    relative: frozenset[bool] = frozenset()
    members: Sequence[str] = ()
    angle_unit: str = ""

    @property
    def is_of_gripper(self) -> bool:
        """Whether the callable or its class concerns a gripper."""
        return bool(GRIPPER & {*self.words, *self.owner})


def guess_argument(name: str, setting: NameContext) -> Guess:
    """Return what an argument means; an empty guess if neither the callable's name nor its own shows it."""
    words, unit = _without_unit(words_of(name))
    noun = noun_of(words)
    is_size = bool(SIZES & set(words))
    if not noun and unit in UNITS["length"] and len(words) == 1 and len(words[0]) > 1 and not is_size:
        noun = "length"  # its name is a unit: metres, mm
    if noun == "none" or any(isinstance(value, str) for value in setting.values):
        return Guess()  # a text says how to do it, not what
    is_open = noun in ("generic", "place", "opening", "switch", "ratio", "length")
    if setting.is_of_gripper and is_open and (len(words) == 1 or not _are_truth(setting)):
        return _opening(unit, name, setting)
    if _are_truth(setting):
        is_output = (noun == "switch" and len(words) == 1) or (
            noun == "generic" and OUTPUT & {*setting.words, *setting.owner}
        )
        return Guess({"kind": "output", "values": [False, True]}) if is_output else Guess()
    if OUTPUT & {*setting.words, *setting.owner} and noun in ("generic", "switch"):
        return _output(setting)
    stem = "_".join(words)
    if OUTPUT & {*setting.words} and stem in ("x", "y", "z") and first(VERBS, setting.words) is None:
        return Guess()  # the number of an output
    motion = _by_verb(noun, stem, setting) or _by_name(noun, stem)
    is_asked = bool(ASKING.intersection(setting.words[:1]))
    if is_asked and (motion is not None or noun == "length"):
        return Guess()  # what is read moves nothing: a length is how much is read, x is where
    limits = _documented_range(_about(name, setting.doc), setting) if noun == "generic" else None
    if limits is not None and limits[1] in _TOPS and limits[0] in (0.0, -limits[1]):
        return Guess({"kind": "output", "range": limits})
    along = words[-1] if len(words) > 1 and words[-1] in ("x", "y", "z") else None
    if motion is not None:
        return _moved(motion[0], motion[1] or along, motion[2], unit, name, setting)
    subject, is_only = _subject(setting), len(setting.names - _HOW) <= 1
    if noun in ("generic", "place", "") and subject in KINDS and is_only:
        noun = subject
    if noun in KINDS:
        return _set(noun, along, unit, name, setting)
    return Guess()


def _set(noun: str, axis: str | None, unit: str | None, name: str, setting: NameContext) -> Guess:
    """Return the guess of a value that is set, where no verb says that something moves."""
    kind, _, dimension = KINDS[noun]
    if kind not in ("translation", "rotation"):
        return measured({"kind": kind, **({"axis": axis} if axis else {})}, dimension, unit, name, setting)
    guess = _moved(kind, axis, None, unit, name, setting)
    if noun == "length":  # the size of a scan or a part
        guess.questions.insert(0, "does something move that far?")
    return guess


def _subject(setting: NameContext) -> str:
    """Return what a callable is about, by the last word of its name: a time scaling is no time."""
    words, _ = _without_unit(setting.words)
    return noun_of(words) if words and words[-1] in NOUNS else ""


def _by_verb(noun: str, stem: str, setting: NameContext) -> MotionMeaning | None:
    """Return kind, axis and mode if the callable's verb alone decides, whatever its only number is called."""
    verb, subject = first(VERBS, setting.words), _subject(setting)
    is_axis = _AXIS.fullmatch(stem) is not None
    is_vector = len({"x", "y", "z", "dx", "dy", "dz"} & setting.names) > 1
    if (noun in ("generic", "") or is_axis) and subject in SUBJECTS and verb is None:
        return KINDS[subject][0], stem if is_axis and (stem != "x" or is_vector) else None, None
    is_amount = noun in ("generic", "length", "angle") or is_axis
    axis = first(DIRECTIONS, setting.words)
    verb = verb or ("translation" if axis else None)
    if verb in (None, "duration") or is_vector or not is_amount:
        return None
    if verb == "rotation":
        return "rotation", "z" if TURNS & set(setting.words) else None, None
    is_translation = axis is not None or (noun in ("length", "generic") and not is_axis)
    return ("translation", axis, "by" if noun == "length" else None) if is_translation else None


def _by_name(noun: str, stem: str) -> MotionMeaning | None:
    """Return kind, axis and mode if the argument's name alone shows a motion; else None."""
    if match := _AXIS.fullmatch(stem):
        return "translation", match["axis"], "by" if match["delta"] else None
    if match := _RATE.fullmatch(stem):
        return "speed", match["axis"], None
    if match := _TURN.fullmatch(stem):
        return "rotation", match["axis"], None
    if match := _JOINT.fullmatch(stem):
        return "rotation", f"j{match['number']}", "to"
    turned = stem if stem in _NAMED_TURNS else stem.removeprefix("d")
    if turned in _NAMED_TURNS:
        return "rotation", _NAMED_TURNS[turned], None if turned == stem else "by"
    return _NAMED.get(noun) if not SIZES & {*stem.split("_")} else None


def _moved(
    kind: str, axis: str | None, mode: str | None, unit: str | None, name: str, setting: NameContext
) -> Guess:
    """Return the guess of a commanded motion, or of what a setter sets."""
    table: TomlTable = {"kind": kind, **({"axis": axis} if axis else {})}
    if kind not in ("translation", "rotation"):
        return measured(table, kind, unit, name, setting)
    guess = measured(table, "angle" if kind == "rotation" else "length", unit, name, setting)
    if guess.table.get("kind") != kind:
        return guess
    mode = mode or _mode(setting)
    if mode is None:
        guess.questions.insert(0, 'a target (mode = "to") or a change (mode = "by")?')
    guess.table["mode"] = mode or "to"
    if len(setting.relative) > 1:
        guess.table["mode"] = {"argument": "relative", "true": "by", "false": "to"}
    return guess


def _mode(setting: NameContext) -> str | None:
    if setting.relative:
        return "by" if True in setting.relative else "to"
    if _RELATIVE.search(" ".join(setting.words)):
        return "by"
    modes = {MODES[word] for word in setting.words if word in MODES}
    if len(modes) == 1 or "by" in setting.words:
        return "by" if "by" in setting.words else modes.pop()
    documented = {word for word in ("relative", "absolute") if re.search(rf"\b{word}", setting.doc.lower())}
    return {"relative": "by", "absolute": "to"}[documented.pop()] if len(documented) == 1 else None


def measured(table: TomlTable, dimension: str, unit: str | None, name: str, setting: NameContext) -> Guess:
    """Return the guess of a quantity with a unit: from its name or a docstring, else from its values."""
    fitting = UNITS[dimension]
    if unit in fitting:
        return Guess({**table, "unit": unit})
    if unit == "percent" and dimension in _SCALED:
        are_shares = all(isinstance(value, int | float) and 0 <= value <= 1 for value in setting.values)
        asked = ["the unit: percent, or a fraction?"] if are_shares else []
        return Guess({"kind": "ratio", "unit": "percent"}, asked)
    if unit in UNITS["time"] and dimension in ("length", "angle"):
        return Guess()  # a gap in seconds is no distance
    about = _about(name, setting.doc)
    if dimension == "angle" and setting.angle_unit:
        return Guess({**table, "unit": setting.angle_unit})
    units = units_in(about, dimension)
    if dimension in _SCALED and "percent" in units_in(about, "ratio"):
        asked = [f"the unit: {', '.join(units)}, or a ratio in percent?"] if units else []
        return Guess({**table, "unit": units[0]} if units else {"kind": "ratio", "unit": "percent"}, asked)
    is_letter = name == "t" and not units and first(VERBS, setting.words) != "duration"
    if dimension == "time" and (_COUNT.search(about) or is_letter):
        return Guess({**table, "unit": "s"}, ["a time, in which unit (s, ms), or a number of steps?"])
    limits = _documented_range(about, setting) if dimension in _SCALED else None
    if limits is not None and limits[1] in _TOPS[1:]:
        return Guess({"kind": "output", "range": limits})
    if limits is not None and limits[1] in (1.0, 100.0) and not units:
        unit = "fraction" if limits[1] == 1.0 else "percent"
        return Guess({"kind": "ratio", "unit": unit, "range": limits})
    units = units or units_in(setting.doc, dimension)
    if len(units) == 1:
        return Guess({**table, "unit": units[0]})
    is_raw = dimension != "time" and _RAW.search(about) is not None
    is_raw = is_raw or (table["kind"] == "position" and _may_be_counts(setting.values))
    shown = _unit_by_size(dimension, setting.values) if not (units or is_raw) else None
    if shown is not None:
        return Guess({**table, "unit": shown}, note="unit inferred from the values")
    question = f"the unit: {', '.join(units or fitting)}{', or counts of the drive' if is_raw else ''}?"
    return Guess({**table, "unit": (units or fitting)[0]}, [question])


def _may_be_counts(values: Sequence[Any]) -> bool:
    """Return whether all sequences hold whole numbers alone, as encoders give them."""
    lists = [value for value in values if isinstance(value, list)]
    return bool(lists) and all(float(element).is_integer() for value in lists for element in value)


def _about(name: str, doc: str) -> str:
    """Return the lines of a docstring that are about an argument."""
    lines, found = doc.splitlines(), []
    for index, line in enumerate(lines):
        if re.search(rf"(?<!\w){re.escape(name)}(?!\w)", line):
            found.append(line)
            found += [next_line for next_line in lines[index + 1 : index + 2] if not _NEXT.match(next_line)]
    return "\n".join(found)


def _documented_range(text: str, setting: NameContext) -> list[float] | None:
    """Return the smallest and largest value that an argument's documentation gives; None without any."""
    pairs = {(float(low), float(high)) for pattern in _RANGES for low, high in pattern.findall(text)}
    seen = [value for value in setting.values if isinstance(value, int | float)]
    found = [[least, most] for least, most in pairs if least < most and least <= min(seen, default=least)]
    found = [pair for pair in found if max(seen, default=pair[0]) <= pair[1]]
    return found[0] if len(found) == 1 else None


def _unit_by_size(dimension: str, values: Sequence[Any]) -> str | None:
    """Return the unit that numbers of this size have: no arm reaches 10 m, and 1.57 is not in degrees."""
    flat = [element for value in values for element in (value if isinstance(value, list) else [value])]
    numbers = [
        abs(element) for element in flat if isinstance(element, int | float) and not isinstance(element, bool)
    ]
    largest = max(numbers, default=0.0)
    is_whole = all(float(number).is_integer() for number in numbers)
    if dimension == "length":
        least = (
            100 if any(isinstance(value, list) for value in values) else 1000
        )  # a list is the pose of an arm
        return "m" if 0 < largest < 2 and not is_whole else "mm" if largest >= least else None
    if dimension == "angle":
        return "deg" if largest > 6.5 else "rad" if largest > 0 and not is_whole else None
    if dimension == "time":
        return "s" if 0 < largest <= 60 else None
    return None


def _opening(unit: str | None, name: str, setting: NameContext) -> Guess:
    if _are_truth(setting):
        return Guess({"kind": "opening", "values": [False, True]})
    values = _distinct(setting.values)
    if len(values) == 2 and set(values) == {0, 1}:
        return Guess({"kind": "opening", "values": values})
    about = _about(name, setting.doc)
    units = [unit] if unit else units_in(about, "length")
    limits = _documented_range(about, setting)
    if limits in ([0.0, 1.0], [0.0, 100.0]) and not units:
        units = ["fraction" if limits[1] == 1.0 else "percent"]
    if limits is not None:  # a number without a unit is no opening, but has a range
        return Guess(
            {"kind": "opening", "unit": units[0], "range": limits}
            if units
            else {"kind": "output", "range": limits}
        )
    table: TomlTable = {"kind": "opening", **({"unit": units[0]} if units else {}), "range": ["…", "…"]}
    asked = "what is fully closed, what is fully open?"
    return Guess(table, [asked if units else f"{asked} in which unit (fraction, percent, mm, m)?"])


def _output(setting: NameContext) -> Guess:
    values = _distinct(setting.values)
    if len(values) >= 2 and len(values) <= _MOST_VALUES:
        return Guess({"kind": "output", "values": values})
    if values and all(value in (0, 1) for value in values):
        return Guess({"kind": "output", "values": [0, 1]})
    return Guess({"kind": "output", "values": ["…", "…"]}, ["which values can it have?"])


def _literals(annotation: str) -> list[str]:
    literal = re.fullmatch(r"Literal\[(.*)\]", annotation)
    return re.findall(r"'([^']*)'", literal[1]) if literal else []


def guess_reading(name: str, setting: NameContext) -> Guess:
    """Return what a result, or its part with this name, means."""
    words, unit = _without_unit(words_of(name))
    about = {*words, *setting.words}
    while len(words) > 1 and words[0] in READERS:
        words = words[1:]
    noun, stem = noun_of(words), "_".join(words)
    is_predicate = bool({"is", "has", "can"} & about)
    is_reply = bool(about & HOUSEKEEPING) and (is_predicate or bool(REPLIES & set(setting.owner)))
    is_reply = is_reply or (is_predicate and bool(FRAMES & set(setting.owner)))  # which message it is
    if INPUTS & set(setting.owner) or is_reply or SETTINGS & set(words):
        return Guess()
    is_setting = bool(TYPES & set(words)) or words[-1:] == ("mode",)
    if 2 <= len(setting.members) <= _MOST_LABELS and not is_setting:
        return Guess({"kind": "label", "values": list(setting.members)})
    is_number = all(type(value) in (int, float) for value in setting.values)
    is_measured = bool(MEASURED & set(words)) and noun not in KINDS and not COUNTED & set(words)
    if is_number and (is_measured or _counts_fingers(noun, setting)):
        return Guess({"kind": "number"})
    if noun == "none":
        return Guess()
    if _are_truth(setting) or (is_predicate and all(value in (0, 1) for value in setting.values)):
        return Guess({"kind": "flag"} if is_predicate or _names_a_state(words, setting) else {})
    is_read = bool(READERS & about) or noun == "switch"
    if (
        noun == "label"
        or setting.annotation.startswith("Literal")
        or (setting.annotation == "str" and is_read)
    ):
        return _label(setting)
    if any(isinstance(value, str) for value in setting.values):
        return Guess()  # what may be a text is no quantity
    if GRIPPER & about:
        return measured({"kind": "distance"}, "length", unit, name, setting) if noun else Guess()
    motion = _by_name("", stem)
    if motion is not None:
        kind, axis, _ = motion
        turned = "angle" if axis is not None and axis.startswith("j") else "orientation"
        read, dimension = {"translation": ("position", "length"), "rotation": (turned, "angle")}.get(
            kind, (kind, kind)
        )
        return measured({"kind": read, **({"axis": axis} if axis else {})}, dimension, unit, name, setting)
    if noun == "place" and unit in UNITS["angle"]:
        noun = "angle"  # of a joint
    noun = noun if noun in KINDS else noun_of(setting.words) if noun in ("", "generic") else noun
    if noun in KINDS and KINDS[noun][1]:
        _, kind, dimension = KINDS[noun]
        return measured({"kind": kind}, dimension, unit, name, setting)
    return Guess()


def _counts_fingers(noun: str, setting: NameContext) -> bool:
    """Return whether it is where a gripper's fingers are, in steps of the drive: whole numbers, no unit."""
    is_place = setting.is_of_gripper and noun in ("place", "opening") and not units_in(setting.doc, "length")
    return is_place and all(type(value) is int for value in setting.values) and max(setting.values) > 2


def _names_a_state(words: Sequence[str], setting: NameContext) -> bool:
    """Return whether a truth value with such a name is a state that is read, and not a setting."""
    if words and NOUNS.get(words[-1]) in ("switch", "opening", "label"):
        return True
    is_participle = any(word.endswith(("ed", "ing")) for word in setting.words)
    return is_participle or bool((READERS | STATES) & {*words, *setting.words})


def _label(setting: NameContext) -> Guess:
    values = _literals(setting.annotation) or _distinct(setting.values)
    if any(isinstance(value, str) and re.fullmatch(rf"\s*{_A_NUMBER}\s*", value) for value in values):
        return Guess()  # a number, written as a text
    texts = [value for value in values if isinstance(value, str)]
    if len(values) > _MOST_LABELS or any(len(text) > _LONGEST_LABEL for text in texts):
        return Guess()
    if len(values) >= 2:
        return Guess({"kind": "label", "values": list(values)})
    return Guess({"kind": "label", "values": [*values, "…"]}, ["which values can it have?"])


def guess_elements(part: WatchedPart, name: str, setting: NameContext, *, written: bool) -> dict[str, Guess]:
    """Return what a sequence's elements mean, by path; empty if no name shows it.

    ``setting.values`` are the sequences that were seen.
    """
    at, length = part.path, part.length or 0
    words, verb = words_of(name), noun_of(setting.words)
    noun = noun_of(words)
    if written and (name.lower() in _ACTIONS or noun == "action"):
        return {f"{at}[{index}]": _action(index, part.limits) for index in range(min(length, _MOST_JOINTS))}
    if "speed" in (verb, noun) and length <= _MOST_JOINTS:
        return {f"{at}[0:{length}]": Guess({"kind": "speed", "unit": "…"}, ["the unit, and the axis?"])}
    if noun in ("none", "acceleration", "force", "torque", "time", "speed") or verb == "speed":
        return {}
    if _without_unit(words)[1] in UNITS["time"]:
        return {}
    for about, meaning in ((words, noun), (setting.words, verb)):
        is_turning = meaning == "joints" or (meaning == "angle" and 3 < length <= 7)
        is_turning = is_turning or (meaning == "place" and ("joint" in about or _is_no_pose(setting.values)))
        is_turning = is_turning or bool({"movej", "servoj", "getj", "j"} & set(about))
        if is_turning and 1 <= length <= _MOST_JOINTS and not setting.is_of_gripper:
            axis = "j1" if length == 1 else f"j1..j{length}"
            return {f"{at}[0:{length}]": _element("rotation", "angle", axis, name, setting, written)}
        if meaning == "place" and length in (2, 3, 6, 7) and not setting.is_of_gripper:
            return _pose(at, name, length, setting, written)
    return {}


def _is_no_pose(values: Sequence[Any]) -> bool:
    """Return whether seven numbers do not end in a quaternion, and so are joints."""
    return any(len(value) == 7 and abs(sum(part * part for part in value[3:]) - 1) > 0.1 for value in values)


def _element(kind: str, read: str, axis: str, name: str, setting: NameContext, written: bool) -> Guess:
    if written:
        context = replace(setting, words=(*setting.words, "to")) if _mode(setting) is None else setting
        return _moved(kind, axis, None, None, name, context)
    dimension = "length" if kind == "translation" else "angle"
    return measured({"kind": read, "axis": axis}, dimension, None, name, setting)


def _pose(at: str, name: str, length: int, setting: NameContext, written: bool) -> dict[str, Guess]:
    count = min(length, 3)
    first_part = replace(setting, values=[value[:count] for value in setting.values])
    place = _element("translation", "position", "xyz"[:count], name, first_part, written)
    found = {f"{at}[0:{count}]": place}
    if length == 6:
        asked = "a rotation vector, or Euler angles (kind, order)? the unit: rad, deg?"
        found[f"{at}[3:6]"] = Guess({"kind": "rotation_vector", "unit": "rad"}, [asked])
    if length == 7:
        found[f"{at}[3:7]"] = Guess({"kind": "quaternion", "order": "…"}, ["the order: wxyz, xyzw?"])
    return found


def _action(index: int, limits: list[list[float]] | None) -> Guess:
    """Return the guess of an element of a policy's action or a simulator's controls, on its own scale."""
    if limits is not None and limits[index][0] < limits[index][1]:
        return Guess({"kind": "output", "range": limits[index]})
    return Guess({"kind": "output", "range": ["…", "…"]}, ["its least and greatest value?"])


def _without_unit(words: tuple[str, ...]) -> tuple[tuple[str, ...], str | None]:
    """Return a name's words without a unit at its end, and the unit."""
    if len(words) > 2 and words[-2:] in UNITS_OF_TWO_WORDS:
        return words[:-2], UNITS_OF_TWO_WORDS[words[-2:]]
    about = (NOUNS.get(words[-2], ""), words[-1]) if len(words) > 1 else ("", "")
    if about in UNITS_OF_LETTERS:
        return words[:-1], UNITS_OF_LETTERS[about]
    found = [unit for dimension in UNITS for unit in units_in(words[-1], dimension)] if words else []
    if not found or words[-1] in ("t", "g"):
        return words, None
    return (words[:-1] or words), found[0]


def _are_truth(setting: NameContext) -> bool:
    seen = list(setting.values)
    return setting.annotation == "bool" or (bool(seen) and all(isinstance(value, bool) for value in seen))


def _distinct(values: Sequence[Any]) -> list[Any]:
    kinds = {type(value) for value in values}
    return list(dict.fromkeys(values if len(kinds) <= 1 or kinds == {int, float} else []))
