"""Calls that were seen turned into proposed operations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from mutabot.init.commands import MESSAGES, commands_of, is_read, patterns_of, tells_commands

from .compared import with_compared
from .guess import Guess, Setting, guess_argument, guess_elements, guess_reading, is_complete
from .observed import Part, SeenCall, part_of

_COMMANDS = re.compile(
    r"(?:^|_)(?:home|park|move[a-z]?|go|goto|pick|place|grasp|grip|release|open|close|wait|sleep|stop|lift|lower"
    r"|rotate|turn|translate|attach|detach|push|start|feed|insert|press|screw|weld|dock|undock|servo[a-z]?"
    r"|speed[lj]|step|write|jog|drive|set|send|command|reset|enable|disable|ptp|lin|calibrate)(?:_|$)"
)
_READERS = re.compile(
    r"(?:^|_)(?:read|get[lj]?|query|ask|measure|is|has|recv|receive|where|locate|detect|scan)(?:_|$)"
)
_REFUSAL = re.compile(r"refus|reach|limit|reject|range|unable|collision|violation", re.IGNORECASE)
_TALK = re.compile(r"(?:^|_)(?:log|print|say|show|info|warn|warning|debug|error|display)(?:_|$)")
_POSE = re.compile(r"pose|position|locat|where|xyz|point")
_PAIRS = (("open", "close"), ("grip", "release"), ("grasp", "release"), ("attach", "detach"), ("on", "off"))
_AXES = ("x", "y", "z", "roll", "pitch", "yaw")
#: longer texts, and more of them, are no labels
_LONGEST_LABEL, _MOST_LABELS = 30, 6


@dataclass
class Proposal:
    """One proposed operation.

    Attributes:
        call: the callable and what was seen of it.
        arguments, result: guesses by path; ``""`` is the result itself.
        message: argument with a text command, or None.
        patterns: notations of the text commands.
        current, opposite: targets of other operations, or None.
        refusals: exceptions that look like a refusal.
        reads_by_name: whether the text only says what to read.
        is_plain: whether it is proposed although nothing tells what it means.
    """

    call: SeenCall
    arguments: dict[str, Guess] = field(default_factory=dict)
    result: dict[str, Guess] = field(default_factory=dict)
    message: str | None = None
    patterns: list[tuple[str, Guess]] = field(default_factory=list)
    current: str | None = None
    opposite: str | None = None
    refusals: list[str] = field(default_factory=list)
    reads_by_name: bool = False
    is_plain: bool = False

    @property
    def target(self) -> str:
        """As vocabularies name it."""
        return self.call.target

    @property
    def is_reading(self) -> bool:
        """Whether it takes nothing that matters and answers something."""
        return bool(self.result) and not self.arguments and self.message is None

    @property
    def is_operation(self) -> bool:
        """Whether it can be proposed as it is."""
        if self.call.facts["problem"]:
            return False
        if self.call.told_by and self.message == self.call.told_by and self.reads_by_name:
            return any(guess.table for _, guess in self.patterns)  # else nothing can be misread
        complete = any(is_complete(guess) for guess in [*self.arguments.values(), *self.result.values()])
        return complete or bool(self.patterns) or self.is_plain or _is_command(self.call)


def proposals(
    calls: Sequence[SeenCall], groups: Sequence[Sequence[Any]] = ()
) -> tuple[list[Proposal], list[Proposal]]:
    """Proposed operations, and those of which nothing shows what they mean to the robot.

    ``groups``: constants that the program compares one and the same thing with.
    """
    all_ = [_proposal(call, groups) for call in calls]
    found = {one.target: one for one in all_ if one.is_operation}
    for proposal in list(found.values()):
        _find_current(proposal, found)
    for proposal in found.values():
        _find_opposite(proposal, found)
    return list(found.values()), [one for one in all_ if one.target not in found]


def _proposal(call: SeenCall, groups: Sequence[Sequence[Any]]) -> Proposal:
    proposal = Proposal(call)
    raised = [*call.facts["refusals"], *call.facts["raised"]]
    proposal.refusals = [name for name in dict.fromkeys(raised) if _REFUSAL.search(name.partition(":")[2])]
    proposal.message = _message(call)
    proposal.reads_by_name = proposal.message is not None and _reads(call)
    for name, parts in call.arguments.items():
        if name != proposal.message:
            for part in parts:
                proposal.arguments.update(_argument(name, part, call))
    by_name = proposal.message is None or proposal.reads_by_name
    if by_name and not proposal.arguments and tells_commands(call):
        proposal.message, proposal.reads_by_name = call.told_by, is_read(call)
        proposal.patterns = commands_of(call, groups)
    elif proposal.message is not None:
        texts = [value for part in call.arguments[proposal.message] for value in part.values]
        proposal.patterns = patterns_of([str(text) for text in texts])
    else:
        proposal.result = _result(call, groups)
        if (proposal.arguments or _is_command(call)) and call.name != "step":
            proposal.result = _only_measured(proposal.result)
    return proposal


def _only_measured(result: dict[str, Guess]) -> dict[str, Guess]:
    """A command's answer of yes or no says whether it was carried out; no sensor reads it."""
    return {path: guess for path, guess in result.items() if guess.table["kind"] not in ("flag", "label")}


def _is_command(call: SeenCall) -> bool:
    name = snake(call.name)
    if call.facts["is_property"] or _TALK.search(name) or _reads(call):
        return False
    return _COMMANDS.search(name) is not None


def _reads(call: SeenCall) -> bool:
    return _READERS.search(snake(call.name)) is not None


def _message(call: SeenCall) -> str | None:
    """The argument that holds a text command."""
    if _TALK.search(snake(call.name)):
        return None
    for name, parts in call.arguments.items():
        is_text = any(isinstance(value, str) for part in parts for value in part.values)
        if is_text and (name in MESSAGES or (_reads(call) and name == "name")):
            return name
    return None


def _argument(name: str, part: Part, call: SeenCall) -> Iterator[tuple[str, Guess]]:
    is_whole = part.path == name
    if not part.always and not is_whole:
        return  # a path that some calls lack
    setting = _setting(call, call.facts["annotations"].get(name, "") if is_whole else "", part)
    own = part.name or name
    if not is_whole:
        setting = Setting(f"{setting.words}_{snake(name)}", f"{part.doc}\n{setting.doc}", "", part.values)
    if part.length is not None:
        found = guess_elements(own if part.name or is_whole else name, part.length, setting, written=True)
        yield from ((f"{part.path}{step}", guess) for step, guess in found.items())
        return
    if part.values and isinstance(part.values[0], str) and not setting.annotation.startswith("Literal"):
        return
    guess = guess_argument(own, setting)
    if guess.table:
        yield part.path, guess


def _result(call: SeenCall, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    found: dict[str, Guess] = {}
    for part in call.result:
        if part.always and part.values:
            found.update(_reading(call, part, groups))
    return {path: guess for path, guess in found.items() if guess.table}


def _reading(call: SeenCall, part: Part, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    annotation = call.facts["returns"] if not part.path else ""
    setting = _setting(call, annotation, part)
    if part.length is not None:
        return _elements(call, part, setting)
    if part.name:  # a field says itself what it is
        setting = Setting("", f"{part.doc}\n{setting.doc}", part.type if part.type == "bool" else "")
        values = part.values
        guess = guess_reading(part.name, Setting("", setting.doc, setting.annotation, values))
    elif part.path:
        is_end = call.name == "step" and part.type == "bool"
        guess = Guess({"kind": "flag"}) if is_end else Guess()
    else:
        values = tuple(with_compared(part.values, groups))
        setting = Setting(setting.words, setting.doc, annotation or part.type, values)
        guess = guess_reading(snake(call.name).removeprefix("get_").removeprefix("read_"), setting)
    return {part.path: guess} if _is_believable(guess) else {}


def _is_believable(guess: Guess) -> bool:
    """Long texts, and many different ones, are messages rather than labels."""
    values = guess.table.get("values", ())
    if guess.table.get("kind") != "label":
        return bool(guess.table)
    texts = [value for value in values if isinstance(value, str)]
    return len(values) <= _MOST_LABELS and all(len(text) <= _LONGEST_LABEL for text in texts)


def _elements(call: SeenCall, part: Part, setting: Setting) -> dict[str, Guess]:
    assert part.length is not None
    name = part.name or ("" if part.path else snake(call.name))
    if part.path and not part.name:
        return {}  # an element of a tuple: nothing tells which one it is
    words = Setting("" if part.name else setting.words, setting.doc, "", setting.constants)
    is_place = bool(_POSE.search(f"{words.words}_{name}"))
    if part.length in (2, 3) and is_place:
        names = _AXES[: part.length]
        flat = [number for values in part.values for number in values]
        inner = Setting("", setting.doc, "", flat)
        return {f"{part.path}[{index}]": guess_reading(one, inner) for index, one in enumerate(names)}
    found = guess_elements(name, part.length, words, written=False)
    return {f"{part.path}{step}": guess for step, guess in found.items()}


def _find_current(proposal: Proposal, found: dict[str, Proposal]) -> None:
    """Look for the reading that tells where a moved thing is; it may be one the program never uses."""
    wanted = {
        (one, axis)
        for guess in proposal.arguments.values()
        for axis in _axes(guess)
        for one in _readings_of(guess.table["kind"], axis)
    }
    if not wanted:
        return
    owner = proposal.target.rpartition(".")[0]
    seen = [one for one in found.values() if one.target.rpartition(".")[0] == owner and one.is_reading]
    promised = [_promised(raw, proposal.call) for raw in proposal.call.facts["readings"]]
    for reading in [*seen, *promised]:
        known = found.get(reading.target, reading)
        read = {(guess.table["kind"], axis) for guess in known.result.values() for axis in _axes(guess)}
        if wanted & read and not known.arguments and known.message is None and not _takes_something(known):
            found.setdefault(known.target, known)
            proposal.current = known.target
            return


def _takes_something(proposal: Proposal) -> bool:
    return bool(proposal.call.arguments or proposal.call.positional)


def _promised(raw: dict[str, Any], other: SeenCall) -> Proposal:
    """A reading of which only the text is known."""
    facts = {
        **other.facts,
        **raw,
        "refusals": [],
        "raised": [],
        "annotations": {},
        "problem": "",
        "readings": [],
    }
    call = SeenCall(raw["target"], facts, (), {}, (), tuple(part_of(leaf) for leaf in raw["parts"]))
    proposal = Proposal(call)
    for part in call.result:
        setting = _setting(call, "", part)
        if part.length is not None:
            proposal.result.update(_elements(call, part, setting))
        elif part.name:
            proposal.result[part.path] = guess_reading(part.name, Setting("", f"{part.doc}\n{setting.doc}"))
    proposal.result = {path: guess for path, guess in proposal.result.items() if guess.table}
    return proposal


def _axes(guess: Guess) -> list[str]:
    axis = guess.table.get("axis", "")
    if guess.table.get("kind") not in ("translation", "rotation", "position", "orientation", "angle"):
        return []
    return list(axis) if axis and set(axis) <= set("xyz") else [axis] if axis else []


def _readings_of(kind: str, axis: str) -> list[str]:
    if kind == "translation":
        return ["position"]
    return ["angle", "orientation"] if axis.startswith("j") else ["orientation"]


def _find_opposite(proposal: Proposal, found: dict[str, Proposal]) -> None:
    head, mark, name = re.fullmatch(r"(?:(.*)([.:]))?(.*)", proposal.target).groups()  # type: ignore[union-attr]
    for pair in _PAIRS:
        for one, other in (pair, pair[::-1]):
            candidate = found.get(f"{head}{mark}{re.sub(rf'(?<![a-z]){one}(?![a-z])', other, name)}")
            if candidate is None or candidate is proposal:
                continue
            if set(candidate.arguments) == set(proposal.arguments):
                proposal.opposite = candidate.target
                return


def _setting(call: SeenCall, annotation: str, part: Part) -> Setting:
    module, _, qualname = call.target.partition(":")
    names = (module.rpartition(".")[2], *qualname.split("."))
    words = "_".join(snake(name) for name in names)
    doc = f"{call.facts['doc']}\n{call.facts['owner_doc']}"
    written = annotation if "[" in annotation else annotation.rpartition(".")[2]
    return Setting(words, doc, written, part.values)


def snake(name: str) -> str:
    """A name in lower case, its words apart: ``set_digital_out``, ``move_j``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
