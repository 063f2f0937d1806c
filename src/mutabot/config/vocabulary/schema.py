"""The schema of a vocabulary file: its keys, and the types of their values.

What the values mean together is checked where the tables are turned into operations. An operation is a Python
callable, or all that is done under a name on a middleware, which has a key of its own in place of ``call``:
``topic`` with ``direction = "publish"`` stands for publishing and for setting up the publisher, an action for
its goal, feedback, result and cancelling.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from mutabot.config.mistakes import DocumentPlace, shown
from mutabot.config.table import Table
from mutabot.model import Kind, Mode, Path
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
    """The places of an operation's quantities in its entry.

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


def is_name(text: str) -> bool:
    """Return whether a text is a name in Python."""
    return text.isidentifier() and not keyword.iskeyword(text)


def is_target(text: str) -> bool:
    """Return whether a text is a target."""
    try:
        check_target(text)
    except ValueError:
        return False
    return True


def check_target(text: str) -> str:
    """Check a target, ``module:qualified.name``, and return it. Raises ValueError if it is invalid."""
    module, colon, name = text.partition(":")
    odd = next((part for part in (*module.split("."), *name.split(".")) if not is_name(part)), None)
    if text.strip() and not colon:
        raise ValueError(f"{text!r} has no colon between module and name; write module:qualified.name")
    if odd is not None:
        what = f"{odd!r} is not a Python name" if odd else "a name is missing"
        raise ValueError(f"{text!r}: {what}; expected module:qualified.name")
    return text


def _check_method(name: str | None) -> str | None:
    if name is not None and not is_name(name):
        raise ValueError(f"{shown(name)} is not the name of a method, such as move_by")
    return name


def _check_scalar(value: Any) -> Any:
    if not isinstance(value, str | bool | int | float):
        raise ValueError(f"must be a text, a number, true or false, not {shown(value)}")
    return value


def _check_signs(text: str, allowed: re.Pattern[str]) -> str:
    if not text.strip():
        raise ValueError("is empty")
    if not allowed.fullmatch(text):
        odd = next(sign for sign in text if not allowed.fullmatch(sign))
        raise ValueError(f"{text!r}: a name has no {odd!r} in it")
    return text


def _check_resolved(text: str) -> str:
    if not _check_signs(text, re.compile(r"[\w/*~]+")).startswith(("/", "*")):
        right = f"{'*/' if text.startswith('~') else '/'}{text.lstrip('~/')}"
        raise ValueError(
            f"{text!r} is not resolved: names are compared after namespaces and remapping; write {right!r}"
        )
    return text


def _frames(text: str) -> str:
    """Return two frames as one text, as operations have them."""
    parts = [part.strip().removeprefix("/") for part in re.split("→|->", text)]
    if len(parts) != 2 or not all(parts):
        raise ValueError(f"{text!r} names no two frames; expected 'base -> tool'")
    return " → ".join(parts)


def _type(text: str) -> str:
    """Return ``package/Name`` for ``package/msg/Name`` and the like."""
    found = re.fullmatch(r"(\w+)/(?:(?:msg|srv|action)/)?(\w+)", text)
    if found is None:
        raise ValueError(f"{text!r} is not a type; expected package/Name, such as geometry_msgs/PoseStamped")
    return f"{found[1]}/{found[2]}"


def _ladder(raw: Any) -> Any:
    """Return a ladder's table; a list of steps alone becomes one without a unit."""
    return {"steps": raw} if isinstance(raw, list) else raw


def _check_argument(text: str) -> str:
    path = Path.parse(text, rooted=True)
    if text == "self":
        raise ValueError('self is the object itself; name what lies in it, such as "self.name"')
    if any(step.bounds is not None for step in path.steps):
        raise ValueError(f"{text!r} is not one value")
    return text


#: a callable or an exception, ``module:qualified.name``
Target = Annotated[str, AfterValidator(check_target)]
#: a name of topics, services, actions, nodes or rates
_GraphName = Annotated[str, AfterValidator(_check_resolved)]
#: names that are not resolved by namespaces
_ParameterName = Annotated[str, AfterValidator(partial(_check_signs, allowed=re.compile(r"[\w/*~.\-]+")))]
_TimerName = Annotated[str, AfterValidator(partial(_check_signs, allowed=re.compile(r"[\w*.<>]+")))]
#: the units of time in ``model.units``
TimeUnit = Literal["s", "ms", "us", "min"]
#: what an argument or a part of an answer can be compared with
Scalar = Annotated[Any, AfterValidator(_check_scalar)]


class LadderTable(Table):
    """``ladder = { steps = [1, 2, 5], unit = "mm" }``; without a unit, that of the quantity."""

    steps: Annotated[list[float], Field(min_length=2)]
    unit: str | None = None


class QuantityTable(Table):
    """``{ kind = "translation", axis = "x", unit = "m", … }``"""

    kind: Annotated[Kind, Field(strict=False)]
    axis: str | None = None
    unit: str | None = None
    frame: str | None = None
    mode: Annotated[Mode | None, Field(strict=False)] = None
    values: list[Any] | None = None
    range: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    clip: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    noise: Annotated[float | None, Field(gt=0)] = None
    order: str | None = None
    relative: bool = False
    ladder: Annotated[LadderTable | None, BeforeValidator(_ladder)] = None
    missing: str | None = None
    tcp: float | None = None


class PatternTable(Table):
    """One entry of ``patterns``, without the keys of a quantity that may describe its only field."""

    text: str
    opposite: str | None = None
    idle: Any = None
    arguments: dict[str, Any] = Field(default_factory=dict)
    result: dict[str, Any] | None = None


class OperationTable(Table):
    """One ``[[operation]]``; ``NAMING`` has the keys that name it, of which it has one."""

    call: Target | None = None
    method: Annotated[str | None, AfterValidator(_check_method)] = None
    topic: _GraphName | None = None
    direction: Literal["publish", "receive"] | None = None
    service: _GraphName | None = None
    action: _GraphName | None = None
    parameter: _ParameterName | None = None
    timer: _TimerName | None = None
    rate: _GraphName | None = None
    tf: Annotated[str, AfterValidator(_frames)] | None = None
    type: Annotated[str, AfterValidator(_type)] | None = None
    node: _GraphName | None = None
    command: bool | None = None
    current: str | None = None
    opposite: str | None = None
    idle: Any = None
    refusals: list[Target] = Field(default_factory=list)
    message: str | None = None
    patterns: list[Any] = Field(default_factory=list)
    when: Any = None
    refused: Any = None
    signature: str | None = None
    overrides: bool = False
    arguments: dict[str, Any] | None = None
    fields: dict[str, Any] | None = None
    request: dict[str, Any] | None = None
    response: dict[str, Any] | None = None
    goal: dict[str, Any] | None = None
    feedback: dict[str, Any] | None = None
    result: dict[str, Any] | None = None
    value: dict[str, Any] | None = None


class RefusedTable(Table):
    """``refused = { path = "status", values = [5, 6], topic = "/arm/notification" }``"""

    path: str = ""
    values: Annotated[list[Scalar], Field(min_length=1)]
    topic: _GraphName | None = None


class CaseTable(Table):
    """``when = { argument = "type", value = "gripper" }``"""

    argument: Annotated[str, AfterValidator(_check_argument)]
    value: Scalar


class ClockTable(Table):
    """``clock = { tick = "module:qualname", time = "self.time", unit = "s" }``, or with a fixed ``step``"""

    tick: Target
    time: str = ""
    unit: TimeUnit = "s"
    step: Annotated[float | None, Field(gt=0)] = None


class WaitTable(Table):
    """``wait = { call = "module:qualname", unit = "s" }``"""

    call: Target
    unit: TimeUnit = "s"


class ProbeTable(Table):
    """One ``[[probe]]``."""

    call: Target
    tolerance: Annotated[float, Field(ge=0)] = 1e-6
    result: dict[str, Any] | None = None


class VocabularyTable(Table):
    """The top of a vocabulary file."""

    operation: list[Any] = Field(default_factory=list)
    refusals: list[Target] = Field(default_factory=list)
    checks: list[Target] = Field(default_factory=list)
    failures: list[Target] = Field(default_factory=list)
    clock: dict[str, Any] | None = None
    wait: dict[str, Any] | None = None
    probe: list[Any] = Field(default_factory=list)


def read_idle(place: DocumentPlace, raw: Any) -> Any:
    """Return ``idle = …`` as data that ``model.answer.restore`` understands; mistakes are noted.

    A TOML value is the answer itself; ``{ call = "module:name" }`` names a function that makes it.
    """
    if isinstance(raw, dict) and set(raw) == {"call"}:
        if isinstance(raw["call"], str):
            (place / "call").attempt(check_target, raw["call"])
        else:
            (place / "call").error(f"must be a text, not {shown(raw['call'])}")
        return raw
    return _data(place, raw)


def _data(place: DocumentPlace, raw: Any) -> Any:
    if isinstance(raw, list):
        return {"list": [_data(place, item) for item in raw]}
    if isinstance(raw, dict):
        return {"dict": [[key, _data(place / key, item)] for key, item in raw.items()]}
    if raw is not None and not isinstance(raw, str | bool | int | float):
        wanted = 'a text, a number, true, false, an array or table of these, or { call = "module:name" }'
        place.error(f"must be {wanted}, not {shown(raw)}")
    return raw
