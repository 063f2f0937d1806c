"""Names on a middleware, such as topics and services: how a vocabulary writes them, and what they stand for.

One entry stands for all that is done under its name: ``topic`` with ``direction = "publish"`` for publishing
and for setting up the publisher, an action for its goal, feedback, result and cancelling.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mutabot.model.operation import WRITTEN, Form

#: the keys that name an operation on a middleware, each with the forms that it stands for, the main one
#: first; a topic's depend on its ``direction``
FORMS: Mapping[str, tuple[Form, ...]] = {
    "topic": (),
    "service": (Form.CALL, Form.CLIENT),
    "action": (Form.GOAL, Form.FEEDBACK, Form.RESULT, Form.CANCEL, Form.CLIENT),
    "parameter": (Form.PARAMETER,),
    "timer": (Form.TICK, Form.TIMER),
    "rate": (Form.SLEEP, Form.RATE),
    "tf": (Form.TRANSFORM,),
}
DIRECTIONS: Mapping[str, tuple[Form, ...]] = {
    "publish": (Form.PUBLISH, Form.ADVERTISE),
    "receive": (Form.RECEIVE, Form.SUBSCRIBE),
}
#: all keys that name an operation
NAMING = ("call", "method", *FORMS)


@dataclass(frozen=True)
class Sides:
    """Where the quantities of an operation stand in its entry.

    Attributes:
        written, read: the keys of their tables; None where there are none.
        words: what messages call what is written, and what is read.
        root: the argument that holds the message that is written; None if arguments are written by name.
        is_message: whether the keys of the tables are bare paths to fields, such as ``pose.position.x``.
    """

    written: str | None = "arguments"
    read: str | None = "result"
    words: tuple[str, str] = ("arguments", "result")
    root: str | None = None
    is_message: bool = False


def _fields(form: Form, written: str | None, read: str | None, *words: str) -> tuple[Form, Sides]:
    said, heard = words or (written or "", read or "")
    return form, Sides(written, read, (said, heard), WRITTEN.get(form), is_message=True)


#: of callables
CALLABLE = Sides()
_TOPIC = ("what is published", "what is received")
_ACTION = ("goal", "feedback or result")
_READ = ("what is sent", "what is read")
#: of what is done under a name; nothing is described of the forms that are missing
SIDES: Mapping[Form, Sides] = {
    Form.PARAMETER: Sides(None, "value", _READ),
    **dict(
        (
            _fields(Form.PUBLISH, "fields", None, *_TOPIC),
            _fields(Form.RECEIVE, None, "fields", *_TOPIC),
            _fields(Form.CALL, "request", "response"),
            _fields(Form.GOAL, "goal", None, *_ACTION),
            _fields(Form.FEEDBACK, None, "feedback", *_ACTION),
            _fields(Form.RESULT, None, "result", *_ACTION),
            _fields(Form.TRANSFORM, None, "fields", *_READ),
        )
    ),
}
_TYPE = re.compile(r"(\w+)/(?:(?:msg|srv|action)/)?(\w+)")
_ARROW = re.compile(r"\s*(?:→|->)\s*")
_GRAPH_NAME = re.compile(r"[\w/*~]+")
#: names that are not resolved by namespaces
_PLAIN = {"parameter": re.compile(r"[\w/*~.\-]+"), "timer": re.compile(r"[\w*.<>]+")}


def forms_of(key: str, direction: str | None) -> Sequence[Form]:
    """The forms that an entry stands for."""
    return DIRECTIONS[direction or ""] if key == "topic" else FORMS[key]


def name_of(key: str, text: str) -> str:
    """The name as operations carry it. Raises ValueError, saying what would be right."""
    if key == "tf":
        return _transform(text)
    if not text.strip():
        raise ValueError("is empty")
    allowed = _PLAIN.get(key, _GRAPH_NAME)
    if not allowed.fullmatch(text):
        odd = next(sign for sign in text if not allowed.fullmatch(sign))
        raise ValueError(f"{text!r}: a name has no {odd!r} in it")
    if key not in _PLAIN and not text.startswith(("/", "*")):
        right = f"{'*/' if text.startswith('~') else '/'}{text.lstrip('~/')}"
        raise ValueError(
            f"{text!r} is not resolved: names are compared after namespaces and remapping; write {right!r}"
        )
    return text


def type_of(text: str) -> str:
    """``package/Name`` for ``package/msg/Name`` and the like. Raises ValueError for anything else."""
    found = _TYPE.fullmatch(text)
    if found is None:
        raise ValueError(f"{text!r} is no type; expected package/Name, such as geometry_msgs/PoseStamped")
    return f"{found[1]}/{found[2]}"


def _transform(text: str) -> str:
    parts = [part.strip().removeprefix("/") for part in _ARROW.split(text)]
    if len(parts) != 2 or not all(parts):
        raise ValueError(f"{text!r} names no two frames; expected 'base -> tool'")
    return " → ".join(parts)
