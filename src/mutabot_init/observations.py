"""The observations of one plain run of the tests, as its processes write them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

from mutabot.api.values import Form

#: the owner of a method of any object, as targets name it
ANY = "*:*"


class Holder(Enum):
    """What the objects of a class are: a robot is none of ``DATA``, ``VALUE`` and ``CONTAINER``."""

    ANYTHING = auto()
    #: fields, as of a dataclass
    DATA = auto()
    #: fields that never change, as of a named tuple, an enumeration, an exception
    VALUE = auto()
    #: a text, list or mapping of an installed library
    CONTAINER = auto()


@dataclass(slots=True)
class WatchedPart:
    """A part of an argument, a result or a message.

    Attributes:
        path: where it lies, as vocabularies write it.
        name: the last name of the path; empty for an index or the whole.
        doc: docstring of the class that holds it.
        type: name of its type, for a field of a message as the definition says.
        within: the message types that hold it, each with the name of its field, the outermost first.
        values: the first different values; sequences of numbers as lists, moments in seconds.
        length: least number of elements of a sequence; None for anything else.
        limits: least and greatest value of each element, where the object gives them.
        members: names of the members of its enumeration.
        count: in how many values it was there.
    """

    path: str
    name: str = ""
    doc: str = ""
    type: str = ""
    within: tuple[tuple[str, str], ...] = ()
    values: list[Any] = field(default_factory=list)
    length: int | None = None
    limits: list[list[float]] | None = None
    members: list[str] = field(default_factory=list)
    count: int = 0


@dataclass(slots=True)
class Values:
    """The values of one argument, result or message over all calls.

    Attributes:
        times: how many values were looked at.
        type: type of the whole, ``package/Name`` for a message.
        parts: its parts by path.
    """

    times: int = 0
    type: str = ""
    parts: dict[str, WatchedPart] = field(default_factory=dict)

    def always(self, part: WatchedPart) -> bool:
        """Return whether every value had this part."""
        return part.count >= self.times


@dataclass(slots=True)
class Command:
    """The observed uses of one of a callable's commands, such as the writes to one node."""

    arguments: dict[str, Values] = field(default_factory=dict)
    result: Values = field(default_factory=Values)


@dataclass(slots=True)
class WatchedCallable:
    """A callable that the program or the tests use.

    Attributes:
        target: as vocabularies name it.
        of_tests: whether the tests call it.
        own: whether the program itself defines it.
        doc, owner, owner_doc: its docstring, its class, and that class's docstring.
        is_property: whether it is read like an attribute.
        is_set: whether it is a property that is assigned.
        is_managed: whether its class is a context manager, which opens and closes a connection.
        is_of_class: whether it is a method of its class, and not of its objects.
        holder: what its class's objects are.
        only_computes: whether its text shows that it changes nothing.
        signature: its arguments as a vocabulary writes them; empty if they are unknown.
        is_documented: whether only a docstring gives the signature.
        annotations: types of the arguments as written, in their order.
        returns: type of the result as written.
        returned: names of the elements of a result that is a tuple, as its text or docstring names them.
        problem: why its calls cannot be intercepted; empty if they can.
        raised: exceptions that it raised, or that its text raises.
        stands_in: whether it was seen on a mock or a fake.
        reaches: whether it is a call of a mock or a fake, or leads to one.
        leads_to_names: whether it uses a name of a middleware.
        sites: ``file:line`` to the number of calls there.
        arguments: values by argument.
        positional: values of arguments whose names are unknown.
        result: what it answered.
        discriminator: path of the value that distinguishes its commands; empty if there is none.
        commands: these commands by their texts.
        other_commands: calls that have no such path, as one that writes a list of names has none.
    """

    target: str
    of_tests: bool = False
    own: bool = False
    doc: str = ""
    owner: str = ""
    owner_doc: str = ""
    is_property: bool = False
    is_set: bool = False
    is_managed: bool = False
    is_of_class: bool = False
    holder: Holder = Holder.ANYTHING
    only_computes: bool = False
    signature: str = ""
    is_documented: bool = False
    annotations: dict[str, str] = field(default_factory=dict)
    returns: str = ""
    returned: list[str] = field(default_factory=list)
    problem: str = ""
    raised: list[str] = field(default_factory=list)
    stands_in: bool = False
    reaches: bool = False
    leads_to_names: bool = False
    sites: dict[str, int] = field(default_factory=dict)
    arguments: dict[str, Values] = field(default_factory=dict)
    positional: Values = field(default_factory=Values)
    result: Values = field(default_factory=Values)
    discriminator: str = ""
    commands: dict[str, Command] = field(default_factory=dict)
    other_commands: int = 0

    @property
    def name(self) -> str:
        """The callable's own name."""
        return self.target.rpartition(":")[2].rpartition(".")[2]

    @property
    def package(self) -> str:
        """The top-level package of the callable."""
        return self.target.partition(":")[0].partition(".")[0]

    @property
    def count(self) -> int:
        """How many calls were observed."""
        return sum(self.sites.values())


@dataclass(slots=True)
class Use:
    """The uses of a name of a middleware, on one side (program or tests).

    Attributes:
        form, name: what, and under which resolved name.
        of_tests: whether the tests did it.
        is_called_back: whether it came to a callback, rather than to who waited for it.
        sites: ``file:line`` to the number of times.
        written, read: what was sent, and what came.
    """

    form: Form
    name: str
    of_tests: bool
    is_called_back: bool
    sites: dict[str, int] = field(default_factory=dict)
    written: Values = field(default_factory=Values)
    read: Values = field(default_factory=Values)


@dataclass(slots=True)
class WatchedCalls:
    """The observations of one process, or of all processes together.

    Attributes:
        calls: callables in the order in which they were first used.
        uses: what was done under names.
        beside: what packages beside this one saw, by their names.
    """

    calls: list[WatchedCallable] = field(default_factory=list)
    uses: list[Use] = field(default_factory=list)
    beside: dict[str, Any] = field(default_factory=dict)
