"""Names on a middleware: which keys name an operation, and what is wrong with a name."""

from __future__ import annotations

import re
from collections.abc import Sequence

from mutabot.model.named import Form

#: the keys that name an operation, each with the forms that it stands for, the main one first
FORMS: dict[str, tuple[Form, ...]] = {
    "service": (Form.CALL, Form.CLIENT),
    "action": (Form.GOAL, Form.FEEDBACK, Form.RESULT, Form.CANCEL, Form.CLIENT),
    "parameter": (Form.PARAMETER,),
    "timer": (Form.TICK, Form.TIMER),
    "rate": (Form.SLEEP, Form.RATE),
    "tf": (Form.TRANSFORM,),
}
#: what ``topic`` stands for, by its ``direction``
DIRECTIONS: dict[str, tuple[Form, ...]] = {
    "publish": (Form.PUBLISH, Form.ADVERTISE),
    "receive": (Form.RECEIVE, Form.SUBSCRIBE),
}
#: all keys that name an operation on a middleware
NAMING = ("topic", *FORMS)

_TYPE = re.compile(r"(\w+)/(?:(?:msg|srv|action)/)?(\w+)")
_ARROW = re.compile(r"\s*(?:→|->)\s*")
_GRAPH_NAME = re.compile(r"[\w/*~]+")
_PARAMETER = re.compile(r"[\w/*~.\-]+")
_TIMER = re.compile(r"[\w*.<>]+")


def name_of(key: str, text: str) -> str:
    """The name as operations carry it. Raises ValueError, saying what would be right."""
    if key == "tf":
        return _transform(text)
    if not text.strip():
        raise ValueError("is empty")
    allowed = {"parameter": _PARAMETER, "timer": _TIMER}.get(key, _GRAPH_NAME)
    if not allowed.fullmatch(text):
        odd = next(sign for sign in text if not allowed.fullmatch(sign))
        raise ValueError(f"{text!r}: a name has no {odd!r} in it")
    if key not in ("parameter", "timer"):
        _check_resolved(text)
    return text


def node_of(text: str) -> str:
    """The name of a node, which may have ``*`` in it. Raises ValueError likewise."""
    return name_of("node", text)


def type_of(text: str) -> str:
    """``package/Name`` for ``package/msg/Name`` and the like. Raises ValueError for anything else."""
    found = _TYPE.fullmatch(text)
    if found is None:
        raise ValueError(f"{text!r} is no type; expected package/Name, such as geometry_msgs/PoseStamped")
    return f"{found[1]}/{found[2]}"


def forms_of(key: str, direction: str | None) -> Sequence[Form]:
    """The forms that an entry stands for."""
    return DIRECTIONS[direction or ""] if key == "topic" else FORMS[key]


def _check_resolved(text: str) -> None:
    if text.startswith(("/", "*")):
        return
    rest = text.lstrip("~/")
    where = f"*/{rest}" if text.startswith("~") else f"/{rest}"
    raise ValueError(
        f"{text!r} is not resolved: names are compared after namespaces and remapping; write {where!r}"
    )


def _transform(text: str) -> str:
    parts = [part.strip().removeprefix("/") for part in _ARROW.split(text)]
    if len(parts) != 2 or not all(parts):
        raise ValueError(f"{text!r} names no two frames; expected 'base -> tool'")
    return " → ".join(parts)
