"""The contract of a mutation operator, and the context in which it acts.

An operator is one class, and nothing else has to be edited: the registries find it. A file holds those of one
kind of fault. What every operator declares, whatever it acts on, says ``Rule``.

- One that acts on **calls** is a subclass of ``Operator`` in a file of a folder below this file's, with its
  name as text: workers load only files in whose text the name is that they look for.
- What acts on anything else belongs to a provider of its own (``mutabot/faults.py``), which says where its
  operators are and what else they have to declare.

What several share has a name that begins with ``_``, be it a class or a file. A package, as
``mutabot_catalogue`` does, names its classes in its ``mutabot.extensions.Extension``. Engines, plan, reports
and documentation know no operator by name: whatever they need to know of one stands here or in the contract
of its provider.

An ``Operator`` answers four questions: where could it act, what does it do there, what does that look like
to an engineer, and which examples show it. It sees quantities and their values, never Python syntax or
a vendor's API, so that whatever can be turned into a ``Call`` can be mutated. What it needs for that it
declares as a set of ``needs``, which the plan checks. Nearly all have one of two shapes: they change a value
(``value.py``), or do something with the call as a whole (``command.py``). ``kinds/commands.py`` has the
shortest ones.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from random import Random
from typing import Any, ClassVar

from mutabot.families import ROBOT
from mutabot.model import Call, Middleware, Operation, Pattern, Quantity, Unchanged
from mutabot.model.quantity import Value

#: how often each class of bugs was counted in public studies, by the word of docstrings
_COUNTED = {
    "timing": "timing and order are 28",
    "sensors": "sensor dropouts and misreadings are 20",
    "parameters": "parameters are 14",
    "commands": "missing and duplicated commands are 13",
    "frames": "frames are 9",
    "signs": "signs are 4",
    "units": "units are 2",
}
_STUDIES = "of the bugs on commands and readings in studies of ROS and PX4/ArduPilot software"
#: how the paragraphs of a docstring begin that are attributes, and what these are called
_PARAGRAPHS = {"Where": "where", "Stands for": "rationale", "Published": "published"}


class Rule(ABC):
    """The base class of operators of all kinds, with their declarations.

    Class attributes:
        name: how ids, reports and selections call it.
        family: the family of its mutants (``mutabot.families``), or one of its own for a plug-in.
        summary: one sentence for the documentation: what the docstring says first, unless it is given.
        examples: worked examples; they are tests.
        where: where it applies, in the words of vocabularies.
        rationale: the bug class that it stands for and the evidence of it, in one sentence, which
            ``{timing}`` and the like stand for; may be empty for those that are published.
        published: rows of the table of published operators that it makes, ``7. original → mutant``, with
            semicolons between them; empty for all others.
        has_sizes: whether it plants each fault in several magnitudes, of which a threshold is sought. Where
            users demand another one, the plan asks ``FaultProvider.at_magnitude`` for it.
        has_moments: whether its mutants act at the moments that users ask for (``when``), which are
            ``Mutant.moment``, and not wherever they are reached.
        is_common: whether it is of those that ``--operators common`` keeps: its faults are among the frequent
            real ones, and few of its mutants are of no use. ``benchmarks/real_bugs/rates.py`` says which are.

    ``where``, ``rationale`` and ``published`` are paragraphs of the docstring, which begin with ``Where:``,
    ``Stands for:`` and ``Published:``, unless they are given.
    """

    name: ClassVar[str]
    family: ClassVar[str]
    summary: ClassVar[str] = ""
    examples: ClassVar[tuple[Any, ...]] = ()
    where: ClassVar[str] = ""
    rationale: ClassVar[str] = ""
    published: ClassVar[str] = ""
    has_sizes: ClassVar[bool] = False
    has_moments: ClassVar[bool] = False
    is_common: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        summary, *others = (" ".join(part.split()) for part in (cls.__doc__ or "").split("\n\n"))
        if summary and "summary" not in vars(cls):
            cls.summary = summary
        for other in others:
            begin, _, text = other.partition(": ")
            name = _PARAGRAPHS.get(begin, "")
            if name and name not in vars(cls):
                for word, counted in _COUNTED.items():
                    text = text.replace(f"{{{word}}}", f"{counted} {_STUDIES}")
                setattr(cls, name, text.rstrip(".") if name == "where" else text)

    def takes_all_calls(self) -> bool:
        """Return whether the effect on a call depends on earlier ones, so that no moment can be asked for."""
        return False


class Need(Enum):
    """Requirements of an operator. If one is not met, the plan leaves its mutants out, with the reason."""

    #: where a written quantity is now (``call.current``): the vocabulary names a reading that gives
    PLACE = auto()
    #: a negative value among the recorded ones, without which it is unknown whether there is a direction
    SIGN = auto()
    #: what the command answers while the robot does nothing (``call.idle``), by baseline or vocabulary
    IDLE = auto()
    #: what time it is in the simulation (``call.time``): the vocabulary names a clock
    CLOCK = auto()
    #: to let the program's time pass (``call.wait``): the vocabulary says how, or a middleware does
    WAIT = auto()
    #: a call that raised in the baseline
    ERROR = auto()
    #: a call of the program: what the tests' own checks read is no place for it
    PROGRAM = auto()
    #: one middleware for all calls of a test, since what it does to one depends on those before
    MEMORY = auto()
    #: copies of the calls and replies that it remembers, which the program cannot change afterwards
    COPIES = auto()


@dataclass(frozen=True, slots=True)
class Subject:
    """What an operator acts on: an operation, one of its text commands, one quantity of it, or the call.

    Attributes:
        operation: the operation.
        pattern: the text command; None for operations that are not text.
        quantity: the quantity; None where the call as a whole is meant.
        variant: which of several mutants here; empty if there is only one.
        magnitude: how big the fault is, in ``unit``; None for faults without a size.
        unit: the unit of the magnitude; None where it has none.
        direction: which way a graded fault goes: ``+``, ``-``, or empty if it goes one way only.
    """

    operation: Operation
    pattern: Pattern | None = None
    quantity: Quantity | None = None
    variant: str = ""
    magnitude: float | None = None
    unit: str | None = None
    direction: str = ""

    @property
    def required_quantity(self) -> Quantity:
        """The quantity, which operators on values always have."""
        assert self.quantity is not None
        return self.quantity

    def given(self, values: Mapping[str, Value], name: str) -> Value:
        """Return the value of the quantity called ``name``. Raises Unchanged if the call does not give it."""
        if name not in values:
            raise Unchanged(self.why_missing)
        return values[name]

    @property
    def why_missing(self) -> str:
        """Why a call that lacks a value is left unchanged."""
        return (
            f"the call {'passes' if self.is_written else 'returns'} no plain value here that can be replaced"
        )

    def of_size(self, magnitude: float, unit: str | None, direction: str = "") -> Subject:
        """Return a copy with a fault of this magnitude, which also names the variant."""
        variant = f"{direction}{magnitude:g}{'%' if unit == 'percent' else unit or ''}"
        return replace(self, variant=variant, magnitude=magnitude, unit=unit, direction=direction)

    @property
    def written(self) -> tuple[Quantity, ...]:
        """Quantities the call writes."""
        return self.pattern.arguments if self.pattern is not None else self.operation.arguments

    @property
    def read(self) -> tuple[Quantity, ...]:
        """Quantities the call reads."""
        return self.pattern.result if self.pattern is not None else self.operation.result

    @property
    def is_written(self) -> bool:
        """Whether the call writes the quantity."""
        return self.quantity in self.written

    @property
    def side(self) -> tuple[Quantity, ...]:
        """The quantities that the call writes if it writes the quantity, otherwise those that it reads."""
        return self.written if self.is_written else self.read

    @property
    def is_command(self) -> bool:
        """Whether the call makes the robot do something."""
        if self.pattern is not None and self.pattern.command is not None:
            return self.pattern.command
        if self.pattern is not None and self.pattern.result and not self.pattern.arguments:
            return False
        return self.operation.command

    @property
    def current(self) -> str | None:
        """The operation that reads the robot's current position; None if the vocabulary names none."""
        own = self.pattern.current if self.pattern is not None else None
        return own or self.operation.current

    @property
    def opposite(self) -> str | None:
        """The opposite command, or the operation that does the opposite; None if there is none."""
        return self.pattern.opposite if self.pattern is not None else self.operation.opposite


@dataclass(frozen=True, slots=True)
class Example:
    """One worked example: a call before, and what the robot and the program see after.

    Attributes:
        subject: what the operator is applied to.
        values: values of the original call.
        replied: values the robot would answer.
        current: where the robot is, by quantity name, for operators that ask.
        performed: values of each call that reaches the robot, in order; ``reversed`` marks the opposite, and
            the name of a call fault what befalls it, with its seconds.
        received: values the program receives; None if it receives the robot's own.
        earlier: values of calls of the same test that went before, and of their replies, for operators that
            remember them.
        time: simulated seconds since the test's first tick.
        lost: whether the program never receives it.
        late: seconds by which it receives it later.
        then: values of what it receives after it.
        raises: what the program gets instead of an answer; None if it gets one.
        away: why the operator changes nothing here; empty if it does act.
        previous: values of the program's call of this operation before this one, wherever it stands.
        waited: seconds of the program's time that pass meanwhile.
        afterwards: values of each call that is made right after the program's next command.
        fails: the exception (``module:Name``) that the program gets in the stead of the robot's answer.
        refused: whether the robot refuses the call.
    """

    subject: Subject
    values: Mapping[str, Value] = field(default_factory=dict)
    replied: Mapping[str, Value] = field(default_factory=dict)
    current: Mapping[str, float] = field(default_factory=dict)
    performed: tuple[Mapping[str, Any], ...] = ()
    received: Mapping[str, Value] | None = None
    raises: type[BaseException] | None = None
    away: str = ""
    earlier: tuple[Mapping[str, Value], ...] = ()
    lost: bool = False
    late: float = 0.0
    time: float = 0.0
    then: tuple[Mapping[str, Value], ...] = ()
    previous: Mapping[str, Value] | None = None
    waited: float = 0.0
    afterwards: tuple[Mapping[str, Any], ...] = ()
    fails: str = ""
    refused: bool = False

    @classmethod
    def changed(
        cls, operation: Operation, before: Any, after: Any, variant: str = "", **more: Any
    ) -> Example:
        """Return an example of a changed value: as it is written or answered, and the new one.

        The first quantity of the operation is meant, or that named ``quantity``; with
        ``size=("+", 20.0, "mm")`` the fault has a magnitude. ``before``, ``after`` and each of ``earlier``
        may be all values of the call. ``more``: other attributes of the example.
        """
        subject = _subject(operation, variant, more)
        values, others = _values(subject, before), _values(subject, after)
        if subject.is_written:
            return cls(subject, values, performed=(others,), **more)
        return cls(subject, replied=values, performed=({},), received=others, **more)

    @classmethod
    def unchanged(
        cls, operation: Operation, before: Any, away: str, variant: str = "", **more: Any
    ) -> Example:
        """Return an example of a value that the operator leaves alone, and why; else as ``changed``."""
        subject = _subject(operation, variant, more)
        more["values" if subject.is_written else "replied"] = _values(subject, before)
        return cls(subject, away=away, **more)

    @classmethod
    def whole(
        cls,
        operation: Operation,
        value: Any,
        *after: Any,
        variant: str = "",
        size: tuple[float, str | None] | None = None,
        earlier: tuple[Any, ...] = (),
        then: tuple[Any, ...] = (),
        **more: Any,
    ) -> Example:
        """Return an example of a call on which the operator acts as a whole.

        Of a call that writes, ``value`` is what it writes, and ``after`` what each call writes that reaches
        the robot. Of one that reads, they are what the robot answers, and what the program gets, if it gets
        any. Values are those of the first quantity, or a table of several; ``size``: the magnitude and its
        unit. ``more``: other attributes of the example.
        """
        first = next(iter((*operation.arguments, *operation.result)), None)

        def of(values: Any) -> Mapping[str, Value]:
            return values if first is None or isinstance(values, Mapping) else {first.name: values}

        subject = Subject(operation, variant=variant)
        subject = subject if size is None else subject.of_size(size[0], size[1])
        known = {"earlier": tuple(map(of, earlier)), "then": tuple(map(of, then)), **more}
        if operation.arguments or not operation.result:
            return cls(subject, of(value), performed=tuple(map(of, after)), **known)
        received = of(after[0]) if after else None
        return cls(subject, replied=of(value), performed=({},), received=received, **known)


def _subject(operation: Operation, variant: str, more: dict[str, Any]) -> Subject:
    """Return the subject of an example, and remove the attributes that name it."""
    quantities = {argument.name: argument for argument in (*operation.arguments, *operation.result)}
    quantity = quantities[more.pop("quantity", next(iter(quantities)))]
    subject = Subject(operation, quantity=quantity, variant=variant)
    more["earlier"] = tuple(_values(subject, given) for given in more.get("earlier", ()))
    if "size" not in more:
        return subject
    direction, size, unit = more.pop("size")
    return subject.of_size(size, unit, direction)


def _values(subject: Subject, given: Any) -> Mapping[str, Value]:
    return given if isinstance(given, Mapping) else {subject.required_quantity.name: given}


class Operator(Rule):
    """A rule that makes mutants of calls.

    Class attributes, beside those of every ``Rule``:
        needs: what it asks for, at every subject.
        does_nothing: whether it promises that no call reaches the robot. A call that would is a fault of the
            operator, and the mutant gets no verdict.
        draws: whether it adds a number that is drawn anew for each round, which reports then show.
        is_raced: whether it leaves to chance what the program's processes still get done, so that equal runs
            may end differently: survivors are run again as well as kills.
        by_chance: whether only chance says at which calls it acts.
        calls: how many calls it takes.
    """

    family: ClassVar[str] = ROBOT
    examples: ClassVar[tuple[Example, ...]] = ()
    has_moments: ClassVar[bool] = True
    needs: ClassVar[frozenset[Need]] = frozenset()
    does_nothing: ClassVar[bool] = False
    draws: ClassVar[bool] = False
    is_raced: ClassVar[bool] = False
    by_chance: ClassVar[bool] = False
    calls: ClassVar[int] = 1

    def takes_all_calls(self) -> bool:
        """Return whether it needs to remember the calls of a test."""
        return Need.MEMORY in self.needs

    def needs_of(self, subject: Subject) -> frozenset[Need]:
        """Return the requirements at this subject."""
        return self.needs

    def only_reads(self, subject: Subject) -> bool:
        """Return whether it only changes values that the program reads, without effect if they are unused."""
        return (
            subject.quantity is not None and subject.quantity in subject.read and Need.WAIT not in self.needs
        )

    def is_chance(self, subject: Subject) -> bool:
        """Return whether it acts at random calls, which cannot be known beforehand."""
        return self.by_chance

    def least_calls(self, subject: Subject) -> int:
        """Return how many calls a test must make for the operator to have an effect."""
        return self.calls

    @abstractmethod
    def subjects(self, whole: Subject) -> Iterable[Subject]:
        """Return the subjects in a call; ``whole`` is the call as a whole: its operation and text command."""

    @abstractmethod
    def middleware(self, subject: Subject, random: Random) -> Middleware:
        """Return the mutant as a coroutine: ``mutated(call, proceed) -> reply``.

        Must pass the call on unchanged where the changed value would not be one the robot API takes, and
        says why, for the reports: ``await proceed(call.as_is("…"))``, or ``reply.as_is("…")`` for a reading.
        ``random`` is the mutant's own generator for this round and test; use no other randomness.
        """

    @abstractmethod
    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        """Describe the fault in a line that an engineer recognises.

        ``before`` and ``after`` are values seen in the baseline and what they would become; None where
        that cannot be known beforehand.
        """


def with_operation(variant: str, target: str) -> str:
    """Return a variant that distinguishes two operations of one site with quantities of the same name."""
    return "+".join(part for part in (variant, target.partition(":")[2] or target) if part)


def subject_of(
    rule: Operator, operation: Operation, pattern: Pattern | None, quantity: str | None, variant: str
) -> Subject:
    """Return what the operator acts on in a mutant of this quantity and variant.

    The variant may have become one ``with_operation``. Controls act where they are put.
    """
    for subject in rule.subjects(Subject(operation, pattern)):
        name = subject.quantity.name if subject.quantity is not None else None
        if name == quantity and variant in (
            subject.variant,
            with_operation(subject.variant, operation.target),
        ):
            return subject
    whole = Subject(operation, pattern, None, variant)
    quantities = (*whole.written, *whole.read)
    return replace(whole, quantity=next((named for named in quantities if named.name == quantity), None))


_BITS = 64


@dataclass(slots=True)
class Context:
    """The context of one mutant in one test.

    Attributes:
        subject: what it acts on.
        quantity: that of the subject, for operators on values.
        random: its generator for this round and test; ``draw`` is the one of a call.
        option: what the operator's table of variants says of the subject's; None if that has none.
        call: the call of the value that it is about to change, for operators on values; only while it does.
        number: of the call, from 1.
        memory: what the operator keeps from one call for later ones: values, or copies; an object of the
            program's that is kept here does not die with the call.
    """

    subject: Subject
    random: Random
    option: Any = None
    quantity: Quantity = field(init=False)
    call: Call = field(init=False)
    number: int = 0
    memory: list[Any] = field(default_factory=list)
    _key: int | None = None

    def __post_init__(self) -> None:
        if self.subject.quantity is not None:
            self.quantity = self.subject.quantity

    def let_go(self, call: Call) -> None:
        """Drop the reference to this call, whose value has been changed."""
        if getattr(self, "call", None) is call:
            del self.call

    def draw(self) -> Random:
        """Return a new copy of the call's own random generator.

        It is keyed by the mutant's own seed, in which are campaign, round, test and site, and by the number
        of the call. From a stream a program that reads once more would shift all later draws, and one
        magnitude of a fault could not be compared with another (common random numbers: L'Ecuyer 1994; keyed
        generators: Salmon et al. 2011).
        """
        if self._key is None:
            self._key = self.random.getrandbits(_BITS)
        return Random(f"{self._key}:{self.number}")

    def by_chance(self) -> None:
        """Raise Unchanged at random; an option of the operator is the probability of acting."""
        if self.draw().random() >= self.option:
            raise Unchanged("not drawn for this call")

    def next_value(self, value: Value, by: int = 1) -> Value:
        """Return the value ``by`` places after this one among the quantity's values, cyclically.

        Raises Unchanged if it is none of them.
        """
        values = self.quantity.values or ()
        if value not in values:
            raise Unchanged("it is not one of the values that the vocabulary gives")
        return values[(values.index(value) + by) % len(values)]
