"""Turns observed calls into proposed operations, with the commands that a call can express.

A text, or a node, register or name, distinguishes such commands: patterns, and the values beside them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from .guess import Guess, NameContext, guess_argument, guess_elements, guess_reading
from .layout import with_compared
from .observations import Command, Holder, Values, WatchedCallable, WatchedPart
from .words import (
    ACTUATORS,
    BOOKS,
    BUILDERS,
    CALLBACKS,
    CAMERAS,
    CHANGES,
    CODECS,
    COMMANDS,
    COMPUTERS,
    CONNECTION,
    DRIVEN,
    GRIPPER,
    HELPERS,
    HOUSEKEEPING,
    IMPERATIVES,
    KEEPERS,
    LINKED,
    MODES,
    OPPOSITES,
    OUTPUT,
    PACKERS,
    READERS,
    REPLIES,
    RUNNING,
    SETTINGS,
    SETUP,
    SIMULATORS,
    STEPS,
    SUBJECTS,
    TALK,
    TYPES,
    VERBS,
    noun_of,
    words_of,
)

_REFUSAL = re.compile(r"refus|reach|limit|reject|range|unable|collision|violation", re.IGNORECASE)
#: how predicates begin
_COMPARING = frozenset({"is", "has", "can"})
#: how the name of a state ends that is no command: ``lights_on``
_SWITCHED = frozenset({"on", "off", "open", "enable", "up", "down"})
#: how what is switched on goes on, and no event: ``on_for_seconds``, ``on_to_position``
_SWITCHED_FOR = frozenset({"for", "to"})
#: types of results that are made rather than read: the last are what ``with`` runs a block in
_MADE = frozenset(
    {"property", "function", "type", "_GeneratorContextManager", "_AsyncGeneratorContextManager"}
)
#: types of numbers; of those that are not finite no values are kept
_NUMBERS = frozenset({"int", "float", "bool"})
#: readings of where something is that a motion of this kind moves, and their kinds
_MOVED = {"translation": "position", "rotation": "orientation"}
_SHOWN_BY = {"position": "position", "orientation": "orientation", "angle": "orientation"}


@dataclass
class Proposal:
    """A proposed operation.

    Attributes:
        call: the callable and what was seen of it.
        arguments, result: guesses by path; ``""`` is the result itself.
        message: argument with a text command, or None.
        patterns: notations of the text commands.
        current, opposite: targets of other operations, or None.
        reads_by_name: whether the text only says what to read.
        is_plain: whether it is proposed although its meaning is unknown.
        doubt: why it may be no operation, a question; empty if nothing says so.
        is_taken: whether it is proposed.
    """

    call: WatchedCallable
    arguments: dict[str, Guess] = field(default_factory=dict)
    result: dict[str, Guess] = field(default_factory=dict)
    message: str | None = None
    patterns: list[tuple[str, Guess]] = field(default_factory=list)
    current: str | None = None
    opposite: str | None = None
    reads_by_name: bool = False
    is_plain: bool = False
    doubt: str = ""
    is_taken: bool = False

    @property
    def target(self) -> str:
        """The callable's name as vocabularies write it."""
        return self.call.target

    @property
    def refusals(self) -> list[str]:
        """The exceptions that look like a refusal."""
        return [name for name in self.call.raised if _REFUSAL.search(name.partition(":")[2])]

    @property
    def is_clock(self) -> bool:
        """Whether it looks like a call that advances a simulation by one step."""
        words = {*words_of(self.call.owner), *words_of(self.target.partition(":")[0])}
        return self.call.name in STEPS and not self.call.arguments and bool(SIMULATORS & words)

    @property
    def is_reading(self) -> bool:
        """Whether it takes no relevant arguments and returns something."""
        return bool(self.result) and not self.arguments and self.message is None

    @property
    def is_operation(self) -> bool:
        """Whether it can be proposed as it is."""
        if self.is_clock or self.call.problem or self.doubt or _is_setup(self.call):
            return False
        if self.call.is_set:  # without a line that holds, an entry means what is read
            is_sure = any(guess.is_sure for guess in self.arguments.values())
            return is_sure or any(guess.table for _, guess in self.patterns)
        if self.call.discriminator and self.message == self.call.discriminator and self.reads_by_name:
            return any(guess.table for _, guess in self.patterns)  # else nothing can be misread
        sure = any(guess.is_sure for guess in [*self.arguments.values(), *self.result.values()])
        is_moved = not VERBS.keys().isdisjoint(words_of(self.call.name))
        is_written = bool(self.arguments) and is_moved and not _reads(self.call)
        are_known = any(guess.table or not guess.questions for _, guess in self.patterns)
        return sure or is_written or are_known or self.is_plain or _is_command(self.call)


def proposals(calls: Sequence[WatchedCallable], groups: Sequence[Sequence[Any]] = ()) -> list[Proposal]:
    """Return the proposals for calls; ``groups``: constants that the program compares with the same thing."""
    found = [_proposal(call, groups) for call in calls if not (_is_housekeeping(call) or _computes(call))]
    _doubt(found)
    assigned = {candidate.target for candidate in found if candidate.call.is_set and candidate.is_operation}
    found = [candidate for candidate in found if candidate.call.is_set or candidate.target not in assigned]
    taken = {candidate.target: candidate for candidate in found if candidate.is_operation}
    for proposal in taken.values():
        proposal.is_taken = True
        _find_current(proposal, taken)
        _find_opposite(proposal, taken)
    return found


def _proposal(call: WatchedCallable, groups: Sequence[Sequence[Any]]) -> Proposal:
    proposal = Proposal(call)
    proposal.message = _message(call)
    proposal.reads_by_name = proposal.message is not None and _reads(call) and not is_exchange(call)
    for name, values in call.arguments.items():
        if name != proposal.message:
            for part in values.parts.values():
                if (values.always(part) or part.path == name) and not _is_row(part, name):
                    proposal.arguments.update(_argument(name, part, call))
    _share_units(proposal.arguments)
    by_name = proposal.message is None or proposal.reads_by_name
    if by_name and has_discriminator(call) and (call.discriminator != "self" or not proposal.arguments):
        proposal.arguments = {}
        proposal.message, proposal.reads_by_name = call.discriminator, is_read(call)
        proposal.patterns = commands_of(call, groups)
    elif proposal.message is not None:
        texts = [value for part in call.arguments[proposal.message].parts.values() for value in part.values]
        proposal.patterns = patterns_of([str(text) for text in texts])
        if is_exchange(call) or _answers(call):
            for notation, guess in proposal.patterns:
                if not guess.table and "{" not in notation:
                    guess.questions = ["does it command, or only ask?"]
    else:
        proposal.result = _result(call, groups)
        if (proposal.arguments or _is_command(call)) and call.name != "step":
            # what a command answers says whether it was carried out; no sensor reads it
            proposal.result = {}
    return proposal


def _doubt(found: Sequence[Proposal]) -> None:
    """Mark what closes, and nothing opens: a connection that is done with, or something of the robot."""
    targets = {proposal.target for proposal in found}
    for proposal in found:
        call, holder = proposal.call, proposal.target.removesuffix(proposal.call.name)
        words = words_of(call.name)
        about = {*words_of(call.owner), *words_of(call.target.partition(":")[0].rpartition(".")[2])}
        if CONNECTION.issuperset(words) and not (call.arguments or about & (GRIPPER | OUTPUT)):
            others = {f"{holder}{other}" for other in _with_opposites(call.name)}
            if not others & targets:
                proposal.doubt = "does it move something of the robot, or only end or begin a connection?"


def _is_row(part: WatchedPart, name: str) -> bool:
    """Return whether it is a row of an argument that is a table: rows have no meanings of their own."""
    return part.length is not None and not part.name and part.path != name


def _share_units(guesses: dict[str, Guess]) -> None:
    """Give all lengths, and all angles, of one call the unit that is known for one of them."""
    for kind in ("translation", "rotation"):
        some = [guess for guess in guesses.values() if guess.table["kind"] == kind]
        units = {guess.table["unit"] for guess in some if guess.is_sure}
        for guess in some if len(units) == 1 else ():
            if guess.questions and guess.questions[0].startswith("the unit"):
                guess.table["unit"], guess.questions = next(iter(units)), guess.questions[1:]


def _is_housekeeping(call: WatchedCallable) -> bool:
    """Return whether it is about a connection, or queries the state of a reply."""
    words, owner = set(words_of(call.name)), {*words_of(call.owner)}
    is_link = (call.is_managed and words & CONNECTION) or (owner & HELPERS and words & (CONNECTION | RUNNING))
    is_started = HELPERS.intersection(words_of(call.name)[-1:]) and words & (RUNNING | CONNECTION)
    if (is_link or is_started or owner & BOOKS) and not (GRIPPER | OUTPUT) & (words | owner):
        return True
    if LINKED.intersection(words_of(call.name)[:1]) and _types(call.result) <= {"bool"}:
        return True
    return bool(words & HOUSEKEEPING) and ("is" in words or bool(REPLIES & owner))


def _computes(call: WatchedCallable) -> bool:
    """Return whether it makes or computes something from its arguments, without the robot."""
    is_constructor = call.is_of_class and call.owner != "" and call.result.type == call.owner
    is_constructor = is_constructor or call.result.type in _MADE
    # a state that is decoded is a reading; a number says the same as the fields
    is_number = call.is_property and _types(call.result) <= {"int", "float"}
    is_value = call.holder is Holder.VALUE or (call.holder is Holder.DATA and is_number)
    if call.holder is Holder.CONTAINER or (is_value and call.only_computes):
        return True
    verb = set(words_of(call.name)[:1])
    is_called_so = verb & (COMPUTERS if call.owner else COMPUTERS | BUILDERS)
    is_pure = bool(call.arguments) and (call.only_computes or is_called_so)
    is_pure = bool(is_pure or verb & CODECS)
    # what computes from its arguments alone reads nothing, and nor does what compares with one
    may_read = _reads(call) and (bool(call.owner) or not call.only_computes) and not verb & CODECS
    may_read = may_read and not (call.only_computes and _COMPARING & set(words_of(call.name)))
    return is_constructor or ((is_pure or _fills_buffer(call)) and not may_read)


def _types(values: Values) -> set[str]:
    return {part.type for part in values.parts.values()}


def _fills_buffer(call: WatchedCallable) -> bool:
    """Return whether it is a function that puts a value into a buffer, which something else sends."""
    words, first = words_of(call.name), next(iter(call.arguments.values()), None)
    is_buffer = first is not None and any(part.type == "bytearray" for part in first.parts.values())
    return not call.owner and is_buffer and bool(words) and words[0] in PACKERS


def _is_setup(call: WatchedCallable) -> bool:
    words = set(words_of(call.name))
    first = words_of(call.name)[:1]
    is_told = first == ("on",) and len(words) > 1 and words.isdisjoint(_SWITCHED_FOR)
    if first in (("handle",), ("notify",), ("emit",)) or is_told:
        return True  # something is told to the program
    is_of_timeout = words_of(call.name)[-1:] in (("timeout",), ("settimeout",))
    hands_over = bool(call.arguments) and call.arguments.keys() <= CALLBACKS
    return bool(SETUP & words) or {"pin", "mode"} <= words or is_of_timeout or hands_over


def _is_command(call: WatchedCallable) -> bool:
    words = set(words_of(call.name))
    is_picture = "grab" in words and bool(CAMERAS & {*words, *words_of(call.owner)})
    is_state = _types(call.result) == {"bool"} and not call.arguments
    first, last = words_of(call.name)[:1], words_of(call.name)[-1:]
    if not KEEPERS.isdisjoint(first):
        return False
    is_asked = is_state and COMMANDS.isdisjoint(first) and not _SWITCHED.isdisjoint(last)
    if call.is_property or call.only_computes or is_picture or is_asked:
        return False
    if "raise" in words and words & {"for", "if", "error", "exception"}:
        return False  # it raises an exception, and no part
    is_verb = bool(words & COMMANDS) or bool(IMPERATIVES.intersection(first))
    owner = {*words_of(call.owner)}
    is_verb = is_verb or bool(DRIVEN.intersection(first) and owner & ACTUATORS and not owner & HELPERS)
    return is_verb and not (words & TALK or _reads(call))


def _reads(call: WatchedCallable) -> bool:
    words = words_of(call.name)
    # set_current(2.0) writes amperes, and get_current_speed() reads
    return bool(READERS.intersection(words[:-1] if words[:1] == ("set",) else words))


def _message(call: WatchedCallable) -> str | None:
    """Return the argument that contains a text command; None if none does."""
    if TALK & set(words_of(call.name)):
        return None
    for name, values in call.arguments.items():
        is_text = any(isinstance(value, str) for part in values.parts.values() for value in part.values)
        if is_text and (name in MESSAGES or (_reads(call) and name == "name")):
            return name
    return None


def _argument(name: str, part: WatchedPart, call: WatchedCallable) -> Iterator[tuple[str, Guess]]:
    is_whole = part.path == name
    setting = _setting(call, part, call.annotations.get(name, "") if is_whole else "")
    own = part.name or (call.name if call.is_set else name)
    if part.length is not None:
        yield from guess_elements(part, own, setting, written=True).items()
        return
    if not part.values and part.type not in _NUMBERS:
        return  # an object of which no part is known
    if not is_whole:
        mode = ("to",) if not {"by", "relative"} & set(setting.words) else ()
        is_subject = noun_of(setting.words) in SUBJECTS  # a velocity has parts that are velocities
        words = (*setting.words, *(() if is_subject else (*words_of(name), *mode)))
        doc = f"{part.doc}\n{setting.doc}"
        setting = replace(setting, words=words, doc=doc, annotation="", names=frozenset({"x", "y"}))
    if call.is_set and not CHANGES & {*setting.words, *words_of(own)}:  # what is assigned is where to go
        other = (word for word in setting.words if MODES.get(word) != "by")
        setting = replace(setting, words=(*other, "to"))
    guess = guess_argument(own, setting)
    if guess.table:
        yield part.path, guess


def _result(call: WatchedCallable, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    found: dict[str, Guess] = {}
    parts = [part for part in call.result.parts.values() if call.result.always(part)]
    sequences, paths = [part for part in parts if part.length is not None], {part.path for part in parts}
    for part in parts:
        if part.path and not part.name and part.length is not None and len(sequences) > 1:
            continue  # one of several sequences: which one is unknown
        if (part.values or part.members) and not _is_alike(part, paths):
            found.update(_reading(call, part, groups))
    return {path: guess for path, guess in found.items() if guess.table}


def _is_alike(part: WatchedPart, paths: set[str]) -> bool:
    """Return whether it is a part of a record in a list of four or more: the first stands for all."""
    index, _, rest = part.path.removeprefix("[").partition("]")
    is_later = index.isdigit() and index != "0" and bool(rest)
    return is_later and all(f"[{number}]{rest}" in paths for number in range(4))


def _reading(call: WatchedCallable, part: WatchedPart, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    setting = _setting(call, part, call.returns if not part.path else "")
    own = part.name or "_".join(words_of(call.name))
    subject = noun_of(words_of(call.name))
    if SETTINGS & {*words_of(call.name)} or (part.name in ("x", "y", "z") and subject in SUBJECTS):
        return {}  # a velocity has parts that are no positions
    if part.name and TYPES.intersection(words_of(part.name)[-1:]):
        return {}  # what an object is, rather than what a sensor reads
    if part.name:  # a field says itself what it is
        doc = part.doc + setting.doc
        setting = NameContext((), setting.owner, doc, values=part.values, members=part.members)
    if part.length is not None:
        named = _named_elements(call, part)
        return named if named is not None else guess_elements(part, own, setting, written=False)
    if part.path and not part.name:  # an element of a tuple
        if call.name == "step":  # of which only the flags are known
            return {part.path: Guess({"kind": "flag"})} if part.type == "bool" else {}
        index = re.fullmatch(r"\[(\d+)\]", part.path)
        return _named_element(call, part, int(index[1])) if index else {}
    if not part.path:
        values = tuple(with_compared(part.values, groups))
        annotation = setting.annotation or (part.type if part.type in ("bool", "str") else "")
        setting = replace(setting, annotation=annotation, values=values)
    return {part.path: guess_reading(own, setting)}


def _named_elements(call: WatchedCallable, part: WatchedPart) -> dict[str, Guess] | None:
    """Return what the elements of a tuple of numbers mean, by their names; None if it is a pose or a list."""
    names = call.returned
    if part.path or part.length != len(names) or not any(names) or {*names} <= {"x", "y", "z", ""}:
        return None
    found: dict[str, Guess] = {}
    for index in range(len(names)):
        values = list(dict.fromkeys(value[index] for value in part.values if len(value) > index))
        element = replace(part, path=f"[{index}]", values=values, length=None)
        found.update(_named_element(call, element, index))
    return found


def _named_element(call: WatchedCallable, part: WatchedPart, index: int) -> dict[str, Guess]:
    """Return what an element of a tuple means: by its name, and by the callable's if it is the value read."""
    # what a task ends with is no reading, as that of run()
    is_read = _reads(call) or call.is_property or bool(noun_of(words_of(call.name)))
    name = call.returned[index] if is_read and index < len(call.returned) else ""
    owner = _setting(call, part, "").owner
    words: tuple[str, ...] = ()
    if noun_of(words_of(name)) == "generic" and _reads(call):
        words, name = words_of(call.name), "_".join(words_of(call.name))
    setting = NameContext(words, owner, call.doc, part.type, part.values, members=part.members)
    return {part.path: guess_reading(name, setting)} if name else {}


def _find_current(proposal: Proposal, found: dict[str, Proposal]) -> None:
    """Find the reading that returns the position of a moved thing: of the same object, with all its axes."""
    wanted, owner = _with_axes(proposal.arguments, _MOVED), proposal.target.rpartition(".")[0]
    if not wanted or not owner:
        return
    for reading in found.values():
        words = set(words_of(reading.call.name))
        is_other = words & (GRIPPER | {"target", "goal", "speed", "limit"}) or reading.call.arguments
        if reading.target.rpartition(".")[0] != owner or not reading.is_reading or is_other:
            continue
        are_sure = all(guess.is_sure for guess in reading.result.values())
        if are_sure and wanted <= _with_axes(reading.result, _SHOWN_BY):
            proposal.current = reading.target
            return


def _with_axes(guesses: Mapping[str, Guess], kinds: Mapping[str, str]) -> set[tuple[str, str]]:
    """Return the descriptions of quantities, each with an axis."""
    return {
        (kinds[guess.table["kind"]], axis)
        for guess in guesses.values()
        if guess.table["kind"] in kinds
        for axis in _axes(guess.table.get("axis", ""))
    }


def _axes(axis: str) -> list[str]:
    return list(axis) if set(axis) <= set("xyz") else [axis]


def _find_opposite(proposal: Proposal, found: dict[str, Proposal]) -> None:
    if proposal.is_reading:
        return
    owner, name = proposal.target.removesuffix(proposal.call.name), proposal.call.name
    for other in _with_opposites(name):
        candidate = found.get(f"{owner}{other}")
        if candidate is not None and set(candidate.call.arguments) == set(proposal.call.arguments):
            proposal.opposite = candidate.target
            return


def _with_opposites(text: str) -> Iterator[str]:
    """Yield the text with each of its words that has an opposite replaced by that."""
    for pair in OPPOSITES:
        for first, second in (pair, pair[::-1]):
            for word, opposite in (
                (first, second),
                (first.title(), second.title()),
                (first.upper(), second.upper()),
            ):
                # a capital begins a word also within one, as in GripperOpen
                before = "[a-z]" if word == first else "[A-Z]"
                swapped = re.sub(
                    rf"(?<!{before}){word}(?![{'A-Z' if word.isupper() else 'a-z'}])", opposite, text
                )
                if swapped != text:
                    yield swapped


def _setting(call: WatchedCallable, part: WatchedPart, annotation: str) -> NameContext:
    module, _, qualname = call.target.partition(":")
    owner = [*words_of(module.rpartition(".")[2]), *words_of(qualname.rpartition(".")[0])]
    degrees = _truth_values("degrees", call) | {
        not value for value in _truth_values("radians", call) | _truth_values("is_radian", call)
    }
    return NameContext(
        words=words_of(call.name),
        owner=tuple(owner),
        doc=f"{call.doc}\n{call.owner_doc}",
        annotation=annotation if "[" in annotation else annotation.rpartition(".")[2],
        values=part.values,
        names=frozenset(call.arguments),
        relative=_truth_values("relative", call),
        members=part.members,
        angle_unit=("deg" if True in degrees else "rad") if len(degrees) == 1 else "",
    )


def _truth_values(name: str, call: WatchedCallable) -> frozenset[bool]:
    """Return the truth values that an argument with this name had."""
    parts = call.arguments[name].parts.values() if name in call.arguments else ()
    return frozenset(value for part in parts for value in part.values if isinstance(value, bool))


#: names of arguments that hold a text command
MESSAGES = frozenset({"message", "command", "cmd", "msg", "text", "line", "order"})
_NUMBER = re.compile(r"(?<![\w{])[-+]?\d+(?:\.\d+)?(?!\w)")
_LETTER = re.compile(r"[^\W\d_]")
_FIELD = re.compile(r"\{(\w+):g\}")
_FIELDS = {"lift": "height", "drop": "height", "turn": "angle", "rotate": "angle", "wait": "seconds"}
_READS, _WRITES = frozenset({"read", "get"}), frozenset({"write", "send", "set"})
#: how the argument is called that holds what is written, beside those that say how
_WRITTEN = frozenset({"value", "values", "val", "data", "state"})
#: arguments that say how to write rather than what
_HOW = frozenset(
    {
        "timeout", "wait", "device_id", "slave", "unit", "no_response_expected", "count", "qos", "retain",
        "headers", "auth", "verify", "cookies", "stream", "proxies", "cert", "topic_type", "service_type",
    }
)  # fmt: skip
#: more different numbers than these are no settings, but a scale
_MOST_VALUES = 5


def patterns_of(texts: Sequence[str]) -> list[tuple[str, Guess]]:
    """Return notations that match these texts, each with the meaning of its only field, if it has one."""
    notations: dict[str, list[float]] = {}
    for text in filter(_LETTER.search, texts):  # a number alone is no command
        numbers = [float(number) for number in _NUMBER.findall(text)]
        notations.setdefault(_notation(text), []).extend(numbers)
    found = []
    for notation, numbers in notations.items():
        guess = Guess()
        if len(_FIELD.findall(notation)) == 1:
            words = words_of(_FIELD.sub("", notation))
            guess = guess_argument("value", NameContext(words, values=numbers))
        opposite = next(
            (candidate for candidate in _with_opposites(notation) if candidate in notations), None
        )
        if opposite is not None:
            guess.table["opposite"] = opposite
        found.append((notation, guess))
    return found


def _notation(text: str) -> str:
    if _FIELD.search(text):
        return text
    words = re.findall(r"[a-z]+", text.lower())
    name = next((word for word in words if word not in ("to", "by")), "value")
    literal = text.replace("{", "{{").replace("}", "}}")
    if len(_NUMBER.findall(literal)) == 1:
        return _NUMBER.sub(lambda _: "{" + _FIELDS.get(name, "value") + ":g}", literal)
    fields = iter(range(1, 100))
    return _NUMBER.sub(lambda _: f"{{value{next(fields)}:g}}", literal)


def has_discriminator(call: WatchedCallable) -> bool:
    """Return whether there are commands, and their texts look like names.

    An object whose method is called is distinguished by an address (``ns=2;s=Gate``), not a description
    (``Bus, channel 0``).
    """
    if not call.commands:
        return False
    are_addresses = call.is_set or all("=" in text or not re.search(r"\s", text) for text in call.commands)
    is_one = len(call.commands) == 1 and "=" not in next(iter(call.commands))
    return call.discriminator != "self" or (are_addresses and not is_one)


def is_read(call: WatchedCallable) -> bool:
    """Return whether a callable's commands read."""
    return bool(_READS & set(words_of(call.name))) and not is_exchange(call)


def _answers(call: WatchedCallable) -> bool:
    """Return whether its answers are different texts, as of questions, rather than one that confirms."""
    part = call.result.parts.get("")
    texts = [value for value in part.values if isinstance(value, str)] if part is not None else []
    return len(texts) > 1


def is_exchange(call: WatchedCallable) -> bool:
    """Return whether a callable writes and then reads, so that only its text says if that is a command."""
    return bool(_READS & set(words_of(call.name))) and bool(_WRITES & set(words_of(call.name)))


def commands_of(call: WatchedCallable, groups: Sequence[Sequence[Any]] = ()) -> list[tuple[str, Guess]]:
    """Return each command as a notation, with the meaning of the value written with it, or read.

    ``groups``: constants that the program compares one and the same thing with.
    """
    found = []
    for text, command in call.commands.items():
        table = _read(text, command, groups) if is_read(call) else _written(text, command)
        notation = text.replace("{", "{{").replace("}", "}}")
        found.append((notation, Guess(table, note=_seen(command, is_read(call)))))
    return found


def _written(text: str, command: Command) -> dict[str, Any]:
    tables = {}
    names = command.arguments.keys() & _WRITTEN or command.arguments.keys() - _HOW
    for name, values in command.arguments.items():
        part = _only_element(name, values) if name in names else None
        parts = [part] if part is not None else _fields(name, values) if name in names else []
        for written in parts:
            table = _value(written.name or text, written)
            if table:
                tables[written.path] = table
    return {"arguments": tables} if tables else {}


def _fields(name: str, values: Values) -> list[WatchedPart]:
    """Return the named values in a table that is written: ``json["speed"]``."""
    return [part for part in values.parts.values() if part.name and part.path != name and values.always(part)]


def _only_element(name: str, values: Values) -> WatchedPart | None:
    """Return a value that is written, or the only element of a list that always has one; else None."""
    part = values.parts.get(name)
    if part is not None and part.length == 1 and all(len(value) == 1 for value in part.values):
        elements = list(dict.fromkeys(value[0] for value in part.values))
        part = replace(part, path=f"{name}[0]", values=elements, length=None)
    elif part is None and f"{name}[1]" not in values.parts:
        part = values.parts.get(f"{name}[0]")
    return part if part is not None and values.always(part) else None


def _value(text: str, part: WatchedPart) -> dict[str, Any]:
    """Return what a written value means: by the node's name, else by its values."""
    values = list(part.values)
    if part.length is not None or not values or any(isinstance(value, str) for value in values):
        return {}
    if all(isinstance(value, bool) for value in values):
        return {"kind": "output", "values": [False, True]}
    words = words_of(text)
    guess = guess_argument((words or ("",))[-1], NameContext((*words[:-1], "set"), values=values))
    if guess.is_sure and guess.table["kind"] in ("translation", "rotation", "duration"):
        return guess.table
    # a number with a name of its own is on a scale
    is_open = bool(part.name) and (guess.questions or not all(type(value) is int for value in values))
    return {"kind": "output", "values": values} if not is_open and 2 <= len(values) <= _MOST_VALUES else {}


def _read(text: str, command: Command, groups: Sequence[Sequence[Any]]) -> dict[str, Any]:
    part = _only_element("", command.result)
    if part is None or part.length is not None or not part.values:
        return {}
    if part.type == "bool" or set(map(type, part.values)) == {bool}:
        return _at(part, {"kind": "flag"})
    if set(part.values) == {0, 1}:
        return _at(part, {"kind": "flag", "values": [0, 1]})
    words = words_of(text)
    annotation = "str" if part.type == "str" else ""
    setting = NameContext(words, annotation=annotation, values=with_compared(part.values, groups))
    guess = guess_reading((words or ("",))[-1], setting)
    return _at(part, guess.table) if guess.is_sure else {}


def _at(part: WatchedPart, table: dict[str, Any]) -> dict[str, Any]:
    """Return what a command's result is, or its only element."""
    return {"result": {part.path: table} if part.path else table}


def _seen(command: Command, reads: bool) -> str:
    several = [command.result] if reads else list(command.arguments.values())
    shown = [str(value) for values in several for part in values.parts.values() for value in part.values]
    return ", ".join(shown[:4]) + (", …" if len(shown) > 4 else "")
