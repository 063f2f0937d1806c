"""Names on a middleware, such as topics and services: how a vocabulary writes them, and what they stand for.

One entry stands for all that is done under its name: ``topic`` with ``direction = "publish"`` for publishing
and for setting up the publisher, an action for its goal, feedback, result and cancelling.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from mutabot.model.operation import WRITTEN, Form

#: the keys that name an operation on a middleware, a topic's with its ``direction``, each with the forms that
#: it stands for, the main one first
FORMS: Mapping[tuple[str, str | None], tuple[Form, ...]] = {
    ("topic", "publish"): (Form.PUBLISH, Form.ADVERTISE),
    ("topic", "receive"): (Form.RECEIVE, Form.SUBSCRIBE),
    ("service", None): (Form.CALL, Form.CLIENT),
    ("action", None): (Form.GOAL, Form.FEEDBACK, Form.RESULT, Form.CANCEL, Form.CLIENT),
    ("parameter", None): (Form.PARAMETER,),
    ("timer", None): (Form.TICK, Form.TIMER),
    ("rate", None): (Form.SLEEP, Form.RATE),
    ("tf", None): (Form.TRANSFORM,),
}
#: all keys that name an operation
NAMING = ("call", "method", *dict.fromkeys(key for key, _ in FORMS))


@dataclass(frozen=True)
class Sides:
    """Where the quantities of an operation stand in its entry.

    Attributes:
        written, read: the keys of their tables; None where there are none.
        root: the argument that holds the message that is written; None if arguments are written by name.
        is_message: whether the keys of the tables are bare paths to fields, such as ``pose.position.x``.
    """

    written: str | None = "arguments"
    read: str | None = "result"
    root: str | None = None
    is_message: bool = False


#: of callables
CALLABLE = Sides()
#: of what is done under a name; nothing is described of the forms that are missing
SIDES: Mapping[Form, Sides] = {
    form: Sides(written, read, WRITTEN.get(form), is_message=form is not Form.PARAMETER)
    for form, written, read in (
        (Form.PUBLISH, "fields", None),
        (Form.RECEIVE, None, "fields"),
        (Form.CALL, "request", "response"),
        (Form.GOAL, "goal", None),
        (Form.FEEDBACK, None, "feedback"),
        (Form.RESULT, None, "result"),
        (Form.PARAMETER, None, "value"),
        (Form.TRANSFORM, None, "fields"),
    )
}
_TYPE = re.compile(r"(\w+)/(?:(?:msg|srv|action)/)?(\w+)")
_ARROW = re.compile(r"\s*(?:→|->)\s*")
_GRAPH_NAME = re.compile(r"[\w/*~]+")
#: names that are not resolved by namespaces
_PLAIN = {"parameter": re.compile(r"[\w/*~.\-]+"), "timer": re.compile(r"[\w*.<>]+")}


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
