"""Operations: what a robot program does through its API, by calls or under names on a middleware."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.notation import Notation
from mutabot.model.path import Path
from mutabot.model.quantity import Kind, Quantity


class Form(StrEnum):
    """The kinds of use of a name on a middleware, such as publishing, with their two sides.

    Those that *write* have an argument that holds all of it, called ``message``, ``request`` or ``goal``;
    what those that *read* bring is the result. Forms that set something up (a publisher, a timer) have
    arguments of their own; see ``SETTING_UP``.
    """

    #: write ``message``
    PUBLISH = "publish"
    #: read a message, in a callback or by waiting for it
    RECEIVE = "receive"
    #: write ``request``, read the response
    CALL = "call"
    #: write ``goal``
    GOAL = "goal"
    #: read feedback, in a callback
    FEEDBACK = "feedback"
    #: read the result of an action
    RESULT = "result"
    #: write nothing: ask for an action to be cancelled
    CANCEL = "cancel"
    #: read the value of a parameter
    PARAMETER = "parameter"
    #: a timer's callback is called; named after its callback
    TICK = "tick"
    #: wait for the next turn of a rate; named after the node
    SLEEP = "sleep"
    #: read a transform, named ``base → tool``
    TRANSFORM = "transform"
    #: set up a publisher, a subscription, a client of a service or action, a timer, a rate
    ADVERTISE = "advertise"
    SUBSCRIBE = "subscribe"
    CLIENT = "client"
    TIMER = "timer"
    RATE = "rate"

    @property
    def comes_by_itself(self) -> bool:
        """Whether it arrives by a callback or is waited for, so that it may come late, twice or never."""
        return self in (Form.RECEIVE, Form.FEEDBACK, Form.TICK)

    @property
    def settings(self) -> tuple[Quantity, ...]:
        """The quantities that are written in setting something up, which no vocabulary describes."""
        if self is Form.PARAMETER:
            return (_DEFAULT,)
        return tuple(setting for setting in _SETTINGS if setting.name in SETTING_UP.get(self, ()))


#: forms whose argument holds all that is written, and its name
WRITTEN = {Form.PUBLISH: "message", Form.CALL: "request", Form.GOAL: "goal"}
#: forms that entries of a vocabulary speak of; all others go with them
MAIN = frozenset({*WRITTEN, Form.RECEIVE, Form.PARAMETER, Form.TICK, Form.SLEEP, Form.TRANSFORM})
#: forms for whose answer the program waits, or which it gets later
ANSWERED = frozenset({Form.CALL, Form.GOAL, Form.RESULT, Form.TRANSFORM})
#: forms that set something up, and the arguments that all middlewares give them: ``name`` is the name as the
#: program gives it, ``depth`` the length of the queue, ``period`` is in seconds; qualities are those of ROS 2
SETTING_UP = {
    Form.ADVERTISE: ("name", "depth", "reliability", "durability", "deadline", "latch"),
    Form.SUBSCRIBE: ("name", "depth", "reliability", "durability", "deadline"),
    Form.CLIENT: ("name",),
    Form.TIMER: ("period",),
    Form.RATE: ("period",),
}
_SETTINGS = (
    Quantity("name", Path("name"), Kind.SETTING),
    Quantity("depth", Path("depth"), Kind.SETTING),
    Quantity("reliability", Path("reliability"), Kind.SETTING, values=("reliable", "best_effort")),
    Quantity("durability", Path("durability"), Kind.SETTING, values=("volatile", "transient_local")),
    Quantity("deadline", Path("deadline"), Kind.SETTING, unit="s"),
    Quantity("latch", Path("latch"), Kind.SETTING, values=(False, True)),
    Quantity("period", Path("period"), Kind.SETTING, unit="s"),
)
#: the default of a parameter, as the program or its declaration gives it
_DEFAULT = Quantity("default", Path("default"), Kind.SETTING)


@frozen
class Named:
    """The identity of an operation that has a name on a middleware.

    Attributes:
        form: what is done.
        name: the resolved name, after remapping and with all namespaces, such as ``/arm/goal``; ``*`` stands
            for any text.
        node: resolved name of the nodes that it is meant of, with ``*`` likewise; None for all.
        type: type of the message, service or action as ``package/Name``; None if the vocabulary does not say.
    """

    form: Form
    name: str
    node: str | None = None
    type: str | None = None

    @property
    def target(self) -> str:
        """The target of its operation: ``publish /arm/goal``."""
        return f"{self.form} {self.name}" + (f" of {self.node}" if self.node is not None else "")

    @classmethod
    def of(cls, target: str) -> Named:
        """Parse a target, as ``target`` gives it; it lacks the type."""
        rest, _, node = target.partition(" of ")
        form, _, name = rest.partition(" ")
        return cls(Form(form), name, node or None)

    def fits(self, form: Form, name: str, node: str | None) -> bool:
        """Return whether a use under a resolved name in a node is this operation."""
        if form is not self.form or not fnmatchcase(name, self.name):
            return False
        return self.node is None or (node is not None and fnmatchcase(node, self.node))


def named_of(target: str) -> Named | None:
    """Parse the target of a name on a middleware; return None for any other target."""
    return Named.of(target) if target.partition(" ")[0] in tuple(Form) and " " in target else None


#: the words by which the goal of an action ends without having been reached
ENDINGS = ("ABORTED", "REJECTED", "CANCELED")


@frozen
class Refused:
    """How a command's answer, or a message after it, shows that the robot refuses it.

    Attributes:
        path: into the result, or into the message of the topic; ``""`` is the whole.
        values: each of these is a refusal.
        topic: resolved name under which it is said, in which ``*`` stands for any text: of a topic, or of the
            action whose result or end (see ``ENDINGS``) says it; None if the result of the call itself does.
    """

    path: str
    values: tuple[Any, ...]
    topic: str | None = None

    @property
    def parsed(self) -> Path:
        """The path, parsed."""
        return _parsed(self.path)


@cache
def _parsed(path: str) -> Path:
    return Path.parse(path, rooted=False)


#: what the target of a method begins with that counts for whatever object has it
ANY = "*:*"


@frozen
class Case:
    """A value of an argument, on which the meaning of a call depends.

    Attributes:
        argument: path to the argument, or into ``self``.
        value: the value as text: ``true``, ``false``, ``none``, or what it prints.
        key: the key of the vocabulary that says so: ``mode``, or ``when`` for calls that may have any value.
    """

    argument: str
    value: str
    key: str = "mode"


@frozen(refuses=True)
class Pattern:
    """One of several commands of an operation, identified by a text, an argument's value, or both.

    Attributes:
        text: the notation of the text, such as ``lift/{height:g}``, together with the cases.
        arguments: the meaning of the fields, and of other arguments beside the text.
        result: the meaning of what the call returns for this command.
        opposite: notation of the opposite command, or None if it has none.
        idle: what the call returns while the robot does nothing, as data (see ``answer``); None if the
            vocabulary does not say.
        source: where the vocabulary says so (``robot.toml:12 · link:send · lift/{height}``).
        when: the values of arguments for which a call is this command.
        base: the notation of the text alone; None without cases, or if there is no text.
        command, current, refused: the same as those of an operation, where an entry of the vocabulary has it
            for these calls alone; without a word of its own, that of the operation holds.
    """

    text: str
    arguments: tuple[Quantity, ...] = ()
    result: tuple[Quantity, ...] = ()
    opposite: str | None = None
    source: str = ""
    idle: Any = None
    when: tuple[Case, ...] = ()
    base: str | None = None
    command: bool | None = None
    current: str | None = None
    refused: tuple[Refused, ...] = ()

    @property
    def notation(self) -> str | None:
        """The notation of the text that selects this command; None if no text does."""
        return self.base if self.when else self.text

    @property
    def fields(self) -> frozenset[str]:
        """The names of the fields of the text."""
        notation = self.notation
        return (
            frozenset(field.name for field in Notation.compile(notation).fields) if notation else frozenset()
        )

    @property
    def name(self) -> str:
        """The notation without format specifications, as ids and reports print it."""
        return Notation.compile(self.text).short


@frozen(refuses=True)
class Operation:
    """One callable of a robot API, with the meaning of its arguments and result.

    Attributes:
        target: the callable as ``module:qualified.name``.
        arguments: quantities it writes.
        result: quantities it reads.
        command: whether calling it makes the robot do something, so that leaving the call out matters.
        current: operation that reads where the robot is now; None if by-to cannot be computed.
        opposite: callable that does the opposite, with the same arguments; None if there is none.
        refusals: exceptions (``module:Name``) by which the robot refuses a command.
        message: path to what says which command a call is, from an argument or ``self``; or None.
        patterns: the commands, if ``message`` is given, or if the meaning depends on an argument.
        idle: what it returns while the robot does nothing, as data (see ``answer``); None if the vocabulary
            does not say.
        source: where the vocabulary says so (``robot.toml:12 · robot:Arm.move_by``).
        signature: what its arguments are, for a callable without a signature; see ``model.signature``.
        overrides: whether methods of the program's own subclasses that override it belong to it.
        kind: what kind of target it has, which says how it is found at run time: the name of a file in
            ``runtime.targets``; None for a Python callable.
        named: what it is on a middleware; None for a Python callable.
        refused: how the robot says by data that it refuses the command.
        is_partial: whether only those calls are meant that are one of its patterns; all others are left
            alone, as if the vocabulary did not name the callable.
    """

    target: str
    arguments: tuple[Quantity, ...] = ()
    result: tuple[Quantity, ...] = ()
    command: bool = True
    current: str | None = None
    opposite: str | None = None
    refusals: tuple[str, ...] = ()
    message: str | None = None
    patterns: tuple[Pattern, ...] = ()
    source: str = ""
    signature: str | None = None
    overrides: bool = False
    idle: Any = None
    kind: str | None = None
    named: Named | None = None
    refused: tuple[Refused, ...] = ()
    is_partial: bool = False

    @classmethod
    def reading(cls, target: str, kind: Kind, **more: Any) -> Operation:
        """Make an operation that returns one value, no command; ``more``: attributes of its quantity."""
        return cls(target, result=(Quantity("result", Path(), kind, **more),), command=False)

    @classmethod
    def writing(cls, target: str, name: str, kind: Kind, **more: Any) -> Operation:
        """Make an operation with one argument; ``more``: attributes of its quantity."""
        return cls(target, (Quantity(name, Path(name), kind, **more),))

    @classmethod
    def under_name(
        cls, form: Form, name: str, arguments: tuple[Quantity, ...] = (), result: tuple[Quantity, ...] = ()
    ) -> Operation:
        """Make an operation under a name on a middleware; a sent message, request or goal is a command."""
        named = Named(form, name)
        return cls(named.target, arguments, result, command=form in WRITTEN, kind="messages", named=named)

    @property
    def form(self) -> Form | None:
        """The kind of use of its name; None if it has no name on a middleware."""
        return self.named.form if self.named is not None else None

    def by_numbers(self) -> Operation:
        """Return the operation with values compared as numbers, for a mock in place of the robot."""

        def compared(arguments: tuple[Quantity, ...]) -> tuple[Quantity, ...]:
            return tuple(
                replace(argument, by_number=argument.is_whole or argument.full_turn is not None)
                for argument in arguments
            )

        patterns = tuple(replace(pattern, arguments=compared(pattern.arguments)) for pattern in self.patterns)
        return replace(self, arguments=compared(self.arguments), patterns=patterns)

    @property
    def module(self) -> str:
        """The module part of the target."""
        return "" if self.named is not None else self.target.partition(":")[0]

    @property
    def name(self) -> str:
        """The part of the target that is looked up in the module; reports call the operation by it."""
        return self.target if self.named is not None else self.target.partition(":")[2]

    @property
    def last_name(self) -> str:
        """The last part of the name by which it is called."""
        return self.name.rpartition(".")[2]

    @property
    def described(self) -> dict[str, str]:
        """The names of the described arguments, each with the key that describes it."""
        found = {quantity.path.root or "": f"arguments.{quantity.name}" for quantity in self.arguments}
        for pattern in self.patterns:
            fields = pattern.fields
            for quantity in pattern.arguments:
                if quantity.name not in fields:
                    found.setdefault(quantity.path.root or "", f"arguments.{quantity.name}")
            for case in pattern.when:
                root = Path.parse(case.argument, rooted=True).root or ""
                if root != "self":
                    found.setdefault(root, case.key)
        if self.message is not None:
            root = Path.parse(self.message, rooted=True).root or ""
            if root != "self":
                found[root] = "message"
        return found

    @property
    def currents(self) -> tuple[str, ...]:
        """The readings that give the robot's position, for any of its calls."""
        named = (self.current, *(pattern.current for pattern in self.patterns))
        return tuple(dict.fromkeys(name for name in named if name is not None))

    @property
    def readings(self) -> tuple[Quantity, ...]:
        """The quantities that can give the robot's position: those read, or those published last."""
        is_published = self.named is not None and self.named.form is Form.PUBLISH
        return self.arguments if is_published else self.result

    @property
    def opposites(self) -> tuple[str, ...]:
        """All operations that do the opposite of any of its calls; the opposite of a text is another text."""
        of_cases = (pattern.opposite for pattern in self.patterns if pattern.notation is None)
        return tuple(dict.fromkeys(name for name in (self.opposite, *of_cases) if name is not None))

    def is_field(self, quantity: Quantity) -> bool:
        """Return whether a quantity is in the message, request, goal or answer, and is no other argument."""
        root = quantity.path.root
        return root is None or (self.named is not None and root == WRITTEN.get(self.named.form))

    @property
    def all_refused(self) -> tuple[Refused, ...]:
        """All ways in which the robot reports, by data, that it refuses any of its calls."""
        return (*self.refused, *(refusal for pattern in self.patterns for refusal in pattern.refused))

    def pattern(self, text: str | None) -> Pattern | None:
        """Return the pattern with this notation, or None."""
        return next((pattern for pattern in self.patterns if pattern.text == text), None)


@frozen
class Clock:
    """How to read simulated time while a test runs.

    Attributes:
        tick: callable that advances the simulation, as ``module:qualified.name``.
        time: path to the time, in the unit below: into the result (``""`` is the result itself) or,
            starting with an argument's name or ``self``, into an argument after the call.
        rooted: whether ``time`` starts at an argument.
        unit: unit of that time, or of the step.
        step: simulated time that every tick takes, in the unit; None if it is read from ``time``.
    """

    tick: str
    time: str = ""
    rooted: bool = False
    unit: str = "s"
    source: str = ""
    step: float | None = None


def owner_of(target: str) -> str:
    """Return the owner of a callable, as ``module:Name``; empty for a module's own functions."""
    owner = target.rpartition(".")[0]
    return owner if ":" in owner else ""


@frozen
class Wait:
    """How the program's time can be advanced.

    Attributes:
        target: callable that takes one number and returns when that much time has passed, as
            ``module:qualified.name``. A method is called on the object of its class that the program uses.
        unit: unit of that number.
    """

    target: str
    unit: str = "s"
    source: str = ""


@frozen
class Probe:
    """A reading that mutabot takes during a test and at its end, to compare worlds.

    Attributes:
        target: callable without arguments, or a value, as ``module:qualified.name``. A method, property or
            attribute of a class's objects is read from those that the program uses.
        tolerance: greatest difference between two equal worlds, in the reading's own units.
        result: what parts of it mean, where that decides how they are compared: angles and orientations.
    """

    target: str
    tolerance: float = 1e-6
    source: str = ""
    result: tuple[Quantity, ...] = ()


@frozen
class Vocabulary:
    """The merged content of the vocabulary files.

    Attributes:
        operations: the robot API.
        refusals: exceptions by which any operation refuses a command.
        checks: exceptions that are verdicts of a check (monitors), beside AssertionError.
        failures: exceptions that mean the simulator itself failed.
        clock: simulated time, or None if the vocabulary does not say.
        probes: end-of-test readings.
        wait: how the program's time is let pass, or None if the vocabulary does not say.
    """

    operations: tuple[Operation, ...] = ()
    refusals: tuple[str, ...] = ()
    checks: tuple[str, ...] = ()
    failures: tuple[str, ...] = ()
    clock: Clock | None = None
    probes: tuple[Probe, ...] = ()
    wait: Wait | None = None

    def operation(self, target: str) -> Operation | None:
        """Return the operation with this target, or None."""
        return next((operation for operation in self.operations if operation.target == target), None)

    def quantity(self, target: str, pattern: str | None, name: str | None) -> Quantity | None:
        """Return the quantity of this name in a command or in its operation; None if there is none."""
        operation = self.operation(target)
        if operation is None or name is None:
            return None
        owner = operation.pattern(pattern) or operation
        known = (*owner.arguments, *owner.result, *operation.arguments, *operation.result)
        return next((quantity for quantity in known if quantity.name == name), None)
