"""The shape of a vocabulary file: which keys there are and what type their values have.

What the values mean together is checked where the tables are turned into operations. An operation that is no
Python callable, which is named ``module:qualified.name``, has a key of its own in place of ``call``, as those
with a name on a middleware have (``vocabulary.named``), and the kind that finds it at run time in
``Operation.kind`` (see ``runtime.targets.target``). A callable may make what a command answers while the
robot does nothing.
"""

from __future__ import annotations

import builtins
import keyword
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from mutabot.config.mistakes import DocumentPlace, shown
from mutabot.config.table import Table
from mutabot.model import Kind, Mode


def is_name(text: str) -> bool:
    """Whether Python takes a text for a name."""
    return text.isidentifier() and not keyword.iskeyword(text)


def is_target(text: str) -> bool:
    """Whether a text is a target."""
    try:
        check_target(text)
    except ValueError:
        return False
    return True


def check_target(text: str) -> str:
    """Return a target, ``module:qualified.name``. Raises ValueError if it is none, saying what is wrong."""
    form = "module:qualified.name"
    module, colon, name = text.partition(":")
    parts = (*module.split("."), *name.split("."))
    if not text.strip():
        raise ValueError(f"is empty; expected {form}")
    if not colon:
        raise ValueError(f"{text!r} has no colon between module and name; write {_with_colon(text)!r}")
    if ":" in name:
        raise ValueError(f"{text!r} has more than one colon; expected {form}")
    if not module or not name:
        side = "name after" if module else "module before"
        raise ValueError(f"{text!r} has no {side} the colon; expected {form}")
    if "" in parts:
        raise ValueError(f"{text!r} has a dot too many; expected {form}")
    odd = next((part for part in parts if not is_name(part)), None)
    if odd is not None:
        raise ValueError(f"{text!r}: {odd!r} is not a Python name; expected {form}")
    return text


def _with_colon(text: str) -> str:
    if isinstance(getattr(builtins, text, None), type):
        return f"builtins:{text}"
    parts = text.split(".")
    if len(parts) == 1:
        return f"module:{text}"
    # robot.Arm.move: by convention a module's name is lower case and a class's is not
    first = next((index for index, part in enumerate(parts) if index and part[:1].isupper()), len(parts) - 1)
    return f"{'.'.join(parts[:first])}:{'.'.join(parts[first:])}"


def _check_method(name: str | None) -> str | None:
    if name is not None and not is_name(name):
        raise ValueError(f"{shown(name)} is not the name of a method, such as move_by")
    return name


def _check_scalar(value: Any) -> Any:
    if not isinstance(value, str | bool | int | float):
        raise ValueError(f"must be a text, a number, true or false, not {shown(value)}")
    return value


#: a callable or an exception, ``module:qualified.name``
Target = Annotated[str, AfterValidator(check_target)]
#: the units of time in ``model.units``
TimeUnit = Literal["s", "ms", "us", "min"]
#: what an argument or a part of an answer can be compared with
Scalar = Annotated[Any, AfterValidator(_check_scalar)]


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
    noise: float | None = None
    order: str | None = None
    relative: bool = False
    ladder: Any = None
    repeatability: float | None = None
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
    """One ``[[operation]]``; ``names.NAMING`` has the keys that name it, of which it has one."""

    call: Target | None = None
    method: Annotated[str | None, AfterValidator(_check_method)] = None
    topic: str | None = None
    direction: Literal["publish", "receive"] | None = None
    service: str | None = None
    action: str | None = None
    parameter: str | None = None
    timer: str | None = None
    rate: str | None = None
    tf: str | None = None
    type: str | None = None
    node: str | None = None
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
    topic: str | None = None


class CaseTable(Table):
    """``when = { argument = "type", value = "gripper" }``"""

    argument: str
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
    """``idle = …`` as data that ``model.answer.restore`` understands; mistakes are noted.

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
