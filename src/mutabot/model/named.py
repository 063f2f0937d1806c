"""What operations are that have a name on a middleware: a topic to publish on, a service to call."""

from __future__ import annotations

from enum import StrEnum
from fnmatch import fnmatchcase
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.values.path import Path
from mutabot.model.values.quantity import Kind, Quantity


class Form(StrEnum):
    """What is done under a name, and between which sides.

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


#: forms whose argument holds all that is written, and its name
WRITTEN = {Form.PUBLISH: "message", Form.CALL: "request", Form.GOAL: "goal"}
#: forms that entries of a vocabulary speak of; all others go with them
MAIN = frozenset(
    {
        *WRITTEN,
        Form.RECEIVE,
        Form.PARAMETER,
        Form.TICK,
        Form.SLEEP,
        Form.TRANSFORM,
    }
)
#: forms of what comes by itself and is given to a callback, or waited for: it may come late, twice or never
COMING = frozenset({Form.RECEIVE, Form.FEEDBACK, Form.TICK})
#: forms for whose answer the program waits, or which it is told later
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
DEFAULT = Quantity("default", Path("default"), Kind.SETTING)


def settings_of(form: Form) -> tuple[Quantity, ...]:
    """What is written where something is set up, or a parameter read: no vocabulary needs to describe it."""
    if form is Form.PARAMETER:
        return (DEFAULT,)
    return tuple(one for one in _SETTINGS if one.name in SETTING_UP.get(form, ()))


@frozen
class Named:
    """An operation that is known by its name on a middleware.

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
        """What a target says, as ``target`` gives it; the type is not in it."""
        rest, _, node = target.partition(" of ")
        form, _, name = rest.partition(" ")
        return cls(Form(form), name, node or None)

    def fits(self, form: Form, name: str, node: str | None) -> bool:
        """Whether something that is done in a node under a resolved name is meant."""
        if form is not self.form or not fnmatchcase(name, self.name):
            return False
        return self.node is None or (node is not None and fnmatchcase(node, self.node))


def named_of(target: str) -> Named | None:
    """What a target says; None for one that is no name on a middleware."""
    return Named.of(target) if target.partition(" ")[0] in tuple(Form) and " " in target else None


#: the words by which the goal of an action ends without having been reached
ENDINGS = ("ABORTED", "REJECTED", "CANCELED")


@frozen
class Refused:
    """How the answer to a command, or a message that follows it, says that the robot refuses it.

    Attributes:
        path: into the result, or into the message of the topic; ``""`` is the whole.
        values: each of these is a refusal.
        topic: resolved name under which it is said, in which ``*`` stands for any text: of a topic, or of the
            action whose result or end (see ``ENDINGS``) says it; None if the result of the call itself does.
    """

    path: str
    values: tuple[Any, ...]
    topic: str | None = None
