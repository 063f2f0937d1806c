"""Calls that were seen, turned into proposed operations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.model.watched import WatchedCallable, WatchedPart

from .commands import MESSAGES, commands_of, is_read, patterns_of, tells_commands
from .guess import Guess, NameContext, guess_argument, guess_elements, guess_reading
from .layout import with_compared
from .words import COMMANDS, GRIPPER, HOUSEKEEPING, OPPOSITES, READERS, REPLIES, SETUP, TALK, words_of

_REFUSAL = re.compile(r"refus|reach|limit|reject|range|unable|collision|violation", re.IGNORECASE)
#: which reading tells where something is that a motion of this kind moves
_READ = {"translation": ("position",), "rotation": ("orientation", "angle")}


@dataclass
class Proposal:
    """One proposed operation.

    Attributes:
        call: the callable and what was seen of it.
        arguments, result: guesses by path; ``""`` is the result itself.
        message: argument with a text command, or None.
        patterns: notations of the text commands.
        current, opposite: targets of other operations, or None.
        reads_by_name: whether the text only says what to read.
        is_plain: whether it is proposed although nothing tells what it means.
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
    is_taken: bool = False

    @property
    def target(self) -> str:
        """As vocabularies name it."""
        return self.call.target

    @property
    def refusals(self) -> list[str]:
        """Exceptions that look like a refusal."""
        return [name for name in self.call.raised if _REFUSAL.search(name.partition(":")[2])]

    @property
    def is_reading(self) -> bool:
        """Whether it takes nothing that matters and answers something."""
        return bool(self.result) and not self.arguments and self.message is None

    @property
    def is_operation(self) -> bool:
        """Whether it can be proposed as it is."""
        if self.call.problem or (self.call.is_property and self.arguments) or _is_setup(self.call):
            return False
        if self.call.told_by and self.message == self.call.told_by and self.reads_by_name:
            return any(guess.table for _, guess in self.patterns)  # else nothing can be misread
        sure = any(guess.is_sure for guess in [*self.arguments.values(), *self.result.values()])
        is_written = bool(self.arguments) and not _reads(self.call)
        return sure or is_written or bool(self.patterns) or self.is_plain or _is_command(self.call)


def proposals(calls: Sequence[WatchedCallable], groups: Sequence[Sequence[Any]] = ()) -> list[Proposal]:
    """What becomes of calls; ``groups``: constants that the program compares one and the same thing with."""
    found = [_proposal(call, groups) for call in calls if not _is_housekeeping(call)]
    taken = {one.target: one for one in found if one.is_operation}
    for proposal in taken.values():
        proposal.is_taken = True
        _find_current(proposal, taken)
        _find_opposite(proposal, taken)
    return found


def _proposal(call: WatchedCallable, groups: Sequence[Sequence[Any]]) -> Proposal:
    proposal = Proposal(call)
    proposal.message = _message(call)
    proposal.reads_by_name = proposal.message is not None and _reads(call)
    for name, values in call.arguments.items():
        if name != proposal.message:
            for part in values.parts.values():
                if values.always(part) or part.path == name:
                    proposal.arguments.update(_argument(name, part, call))
    _share_units(proposal.arguments)
    by_name = proposal.message is None or proposal.reads_by_name
    if by_name and tells_commands(call) and (call.told_by != "self" or not proposal.arguments):
        proposal.arguments = {}
        proposal.message, proposal.reads_by_name = call.told_by, is_read(call)
        proposal.patterns = commands_of(call, groups)
    elif proposal.message is not None:
        texts = [value for part in call.arguments[proposal.message].parts.values() for value in part.values]
        proposal.patterns = patterns_of([str(text) for text in texts])
    else:
        proposal.result = _result(call, groups)
        if (proposal.arguments or _is_command(call)) and call.name != "step":
            # what a command answers says whether it was carried out; no sensor reads it
            proposal.result = {}
    return proposal


def _share_units(guesses: dict[str, Guess]) -> None:
    """Lengths, and angles, of one call have one unit: what tells that of one tells that of all."""
    for kind in ("translation", "rotation"):
        some = [guess for guess in guesses.values() if guess.table["kind"] == kind]
        units = {guess.table["unit"] for guess in some if guess.is_sure}
        for guess in some if len(units) == 1 else ():
            if guess.questions and guess.questions[0].startswith("the unit"):
                guess.table["unit"], guess.questions = next(iter(units)), guess.questions[1:]


def _is_housekeeping(call: WatchedCallable) -> bool:
    """Whether it asks a reply, or a connection, how it is."""
    words = set(words_of(call.name))
    return bool(words & HOUSEKEEPING) and ("is" in words or bool(REPLIES & set(words_of(call.owner))))


def _is_setup(call: WatchedCallable) -> bool:
    return bool(SETUP & set(words_of(call.name)))


def _is_command(call: WatchedCallable) -> bool:
    words = set(words_of(call.name))
    return not (call.is_property or words & TALK or _reads(call)) and bool(words & COMMANDS)


def _reads(call: WatchedCallable) -> bool:
    return bool(READERS & set(words_of(call.name)))


def _message(call: WatchedCallable) -> str | None:
    """The argument that holds a text command."""
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
    own = part.name or name
    if part.length is not None:
        found = guess_elements(own, part.length, setting, written=True, limits=part.limits)
        yield from ((f"{part.path}{step}", guess) for step, guess in found.items())
        return
    if not is_whole:
        mode = ("to",) if not {"by", "relative"} & set(setting.words) else ()
        words = (*setting.words, *words_of(name), *mode)
        doc = f"{part.doc}\n{setting.doc}"
        setting = replace(setting, words=words, doc=doc, annotation="", names=frozenset({"x", "y"}))
    guess = guess_argument(own, setting)
    if guess.table:
        yield part.path, guess


def _result(call: WatchedCallable, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    found: dict[str, Guess] = {}
    parts = [part for part in call.result.parts.values() if call.result.always(part)]
    sequences = [part for part in parts if part.length is not None]
    for part in parts:
        if part.path and not part.name and part.length is not None and len(sequences) > 1:
            continue  # one of several sequences: nothing tells which one it is
        if part.values:
            found.update(_reading(call, part, groups))
    return {path: guess for path, guess in found.items() if guess.table}


def _reading(call: WatchedCallable, part: WatchedPart, groups: Sequence[Sequence[Any]]) -> dict[str, Guess]:
    setting = _setting(call, part, call.returns if not part.path else "")
    own = part.name or "_".join(words_of(call.name))
    if part.name:  # a field says itself what it is
        setting = NameContext((), setting.owner, part.doc + setting.doc, values=part.values)
    if part.length is not None:
        found = guess_elements(own, part.length, setting, written=False)
        return {f"{part.path}{step}": guess for step, guess in found.items()}
    if part.path and not part.name:  # an element of a tuple: only the flags of a step are known
        return {part.path: Guess({"kind": "flag"})} if call.name == "step" and part.type == "bool" else {}
    if not part.path:
        values = tuple(with_compared(part.values, groups))
        annotation = setting.annotation or (part.type if part.type in ("bool", "str") else "")
        setting = NameContext(setting.words, setting.owner, setting.doc, annotation, values)
    return {part.path: guess_reading(own, setting)}


def _find_current(proposal: Proposal, found: dict[str, Proposal]) -> None:
    """Look for the reading that tells where a moved thing is: of the same object, with all its axes."""
    wanted = {
        (kind, axis)
        for guess in proposal.arguments.values()
        for kind in _READ.get(guess.table["kind"], ())[:1]
        for axis in _axes(guess)
    }
    owner = proposal.target.rpartition(".")[0]
    if not wanted or not owner:
        return
    for reading in found.values():
        words = set(words_of(reading.call.name))
        is_other = words & (GRIPPER | {"target", "goal", "speed", "limit"}) or reading.call.arguments
        if reading.target.rpartition(".")[0] != owner or not reading.is_reading or is_other:
            continue
        read = {
            ("position" if guess.table["kind"] == "position" else "orientation", axis)
            for guess in reading.result.values()
            if guess.table["kind"] in ("position", "orientation", "angle")
            for axis in _axes(guess)
        }
        if wanted <= read and all(guess.is_sure for guess in reading.result.values()):
            proposal.current = reading.target
            return


def _axes(guess: Guess) -> list[str]:
    axis = guess.table.get("axis", "")
    return list(axis) if axis and set(axis) <= set("xyz") else [axis] if axis else []


def _find_opposite(proposal: Proposal, found: dict[str, Proposal]) -> None:
    head, mark, name = re.fullmatch(r"(?:(.*)([.:]))?(.*)", proposal.target).groups()  # type: ignore[union-attr]
    for pair in OPPOSITES:
        for one, other in (pair, pair[::-1]):
            candidate = found.get(f"{head}{mark}{re.sub(rf'(?<![a-z]){one}(?![a-z])', other, name)}")
            if candidate is None or candidate is proposal:
                continue
            if set(candidate.call.arguments) == set(proposal.call.arguments):
                proposal.opposite = candidate.target
                return


def _setting(call: WatchedCallable, part: WatchedPart, annotation: str) -> NameContext:
    module, _, qualname = call.target.partition(":")
    owner = [*words_of(module.rpartition(".")[2]), *words_of(qualname.rpartition(".")[0])]
    relative = call.arguments.get("relative")
    said = {bool(value) for part in relative.parts.values() for value in part.values} if relative else set()
    return NameContext(
        words=words_of(call.name),
        owner=tuple(owner),
        doc=f"{call.doc}\n{call.owner_doc}",
        annotation=annotation if "[" in annotation else annotation.rpartition(".")[2],
        values=part.values,
        names=frozenset(call.arguments),
        relative=frozenset(said),
    )
