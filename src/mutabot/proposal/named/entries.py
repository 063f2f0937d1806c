"""Proposed entries of a vocabulary for what was done under names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from mutabot.model.operation import Form
from mutabot.proposal.compared import Unreached
from mutabot.proposal.guess import Guess
from mutabot.proposal.named.meanings import Place, is_nothing, meaning

from .seen import Part, Use

#: which key names it, which tables speak of what is written and of what is read
_KEYS: Mapping[Form, tuple[str, str, str]] = {
    Form.PUBLISH: ("topic", "fields", ""),
    Form.RECEIVE: ("topic", "", "fields"),
    Form.CALL: ("service", "request", "response"),
    Form.GOAL: ("action", "goal", ""),
    Form.FEEDBACK: ("action", "", "feedback"),
    Form.RESULT: ("action", "", "result"),
    Form.PARAMETER: ("parameter", "", "value"),
    Form.TICK: ("timer", "", ""),
    Form.SLEEP: ("rate", "", ""),
    Form.TRANSFORM: ("tf", "", "fields"),
}
_DIRECTIONS = {Form.PUBLISH: "publish", Form.RECEIVE: "receive"}
#: how the types of the parts of services and actions of ROS 1 end
_ENDINGS = {
    Form.CALL: ("Request", "Response"),
    Form.GOAL: ("Goal",),
    Form.FEEDBACK: ("Feedback",),
    Form.RESULT: ("Result",),
}
#: what the tests alone read is worth a word if they wait for it: it is what they judge by. What goes wrong in
#: a callback of theirs, the client library may keep to itself
_READINGS = frozenset({Form.RECEIVE, Form.TRANSFORM})


#: what is set up before anything passes, and what passes then
_BEFORE = {
    Form.ADVERTISE: (Form.PUBLISH,),
    Form.SUBSCRIBE: (Form.RECEIVE,),
    Form.CLIENT: (Form.CALL, Form.GOAL),
    Form.TIMER: (Form.TICK,),
    Form.RATE: (Form.SLEEP,),
}
#: what the middleware sets up for itself, and for an action
_OWN = frozenset({"/tf", "/tf_static", "/clock", "/rosout", "/parameter_events", "/statistics"})
_OF_ACTIONS = ("/goal", "/cancel", "/status", "/feedback", "/result")


@dataclass
class Described:
    """A part with the table it belongs to, and what it means; without a guess nothing tells."""

    table: str
    path: str
    part: Part
    guess: Guess | None


@dataclass
class Entry:
    """One entry.

    Attributes:
        key, name: what it is called by.
        direction: of a topic; empty for anything else.
        type: as far as it is known.
        uses: what was seen.
        parts: what passes there.
        is_taken: whether a vocabulary takes it; a wrong guess may be why not.
    """

    key: str
    name: str
    direction: str = ""
    type: str = ""
    uses: list[Use] = field(default_factory=list)
    parts: list[Described] = field(default_factory=list)
    is_taken: bool = True

    @property
    def files(self) -> list[str]:
        """Where it stands."""
        return list(dict.fromkeys(file for use in self.uses for file, _, _ in use.sites))

    @property
    def of_tests(self) -> bool:
        """Whether the tests alone do it."""
        return all(use.of_tests for use in self.uses)

    @property
    def has_meaning(self) -> bool:
        """Whether anything is told of what passes."""
        return any(part.guess is not None for part in self.parts)


def entries(found: Sequence[Use]) -> list[Entry]:
    """An entry for each name that the program uses, and for the readings of the tests that mean something."""
    made: dict[tuple[str, str, str], Entry] = {}
    for use in found:
        if use.of_tests and (use.form not in _READINGS or use.is_called_back):
            continue
        if use.form not in _KEYS:
            continue
        key, _, _ = _KEYS[use.form]
        direction = _DIRECTIONS.get(use.form, "")
        entry = made.setdefault((key, use.name, direction), Entry(key, use.name, direction))
        if entry.uses and use.of_tests and not entry.of_tests:
            continue  # what the program reads is told of the program alone
        if entry.uses and entry.of_tests and not use.of_tests:
            entry.uses, entry.parts = [], []
        entry.uses.append(use)
        entry.type = entry.type or _type(use)
        known = {(part.table, part.path) for part in entry.parts}
        entry.parts += [part for part in _described(use) if (part.table, part.path) not in known]
    return [entry for entry in made.values() if not entry.of_tests or entry.has_meaning]


def unused(found: Sequence[Use]) -> list[Unreached]:
    """What the program sets up, and the tests let nothing pass there."""
    passed = {(use.form, use.name) for use in found if not use.of_tests}
    actions = {use.name for use in found if use.form in (Form.GOAL, Form.CLIENT)}
    left = []
    for use in found:
        then = _BEFORE.get(use.form, ())
        is_action = any(use.name == f"{name}{end}" for name in actions for end in _OF_ACTIONS)
        if not then or use.of_tests or use.name in _OWN or is_action:
            continue
        if not any((form, use.name) in passed for form in then):
            file, line, _ = use.sites[0]
            left.append(Unreached(file, line, f"{then[0]} {use.name}"))
    return left


def _type(use: Use) -> str:
    if use.form is Form.TRANSFORM:
        return ""
    ending = next((one for one in _ENDINGS.get(use.form, ()) if use.type.endswith(one)), "")
    return use.type.removesuffix(ending)


def _described(use: Use) -> Iterator[Described]:
    _, written, read = _KEYS[use.form]
    for table, parts in ((written, use.written), (read, use.read)):
        if not table:
            continue
        place = Place.of(use, parts, is_written=table == written)
        for part in parts:
            meant = meaning(part, place) if part.always else {}
            for path, guess in meant.items():
                yield Described(table, path, part, guess if guess.table else None)
            if not meant and not is_nothing(part, place):
                yield Described(table, part.path, part, None)
