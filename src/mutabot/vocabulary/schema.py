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
from enum import StrEnum
from typing import Annotated, Any

from pydantic import Field

from mutabot.model import Kind, Mode
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.table import Table
from mutabot.settings.toml_lines import KeyPath


class Better(StrEnum):
    """Which way a probe's number gets better."""

    LESS = "less"
    MORE = "more"


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


class DescribedTable(Table):
    """What every ``[[operation]]`` may say, however it is found."""

    command: bool | None = None
    current: Any = None
    opposite: str | None = None
    idle: Any = None
    refusals: list[str] = Field(default_factory=list)
    message: str | None = None
    patterns: list[Any] = Field(default_factory=list)
    when: Any = None
    refused: Any = None


class OperationTable(DescribedTable):
    """One ``[[operation]]`` that is a callable."""

    call: str
    method: str | None = None
    arguments: dict[str, Any] = Field(default_factory=dict)
    result: dict[str, Any] | None = None
    signature: str | None = None
    overrides: bool = False


class NamedTable(DescribedTable):
    """One ``[[operation]]`` that has a name on a middleware; which keys go together is checked later."""

    topic: str | None = None
    direction: str | None = None
    service: str | None = None
    action: str | None = None
    parameter: str | None = None
    timer: str | None = None
    rate: str | None = None
    tf: str | None = None
    type: str | None = None
    node: str | None = None
    fields: dict[str, Any] | None = None
    request: dict[str, Any] | None = None
    response: dict[str, Any] | None = None
    goal: dict[str, Any] | None = None
    feedback: dict[str, Any] | None = None
    result: dict[str, Any] | None = None
    value: dict[str, Any] | None = None


class CurrentTable(Table):
    """``current = { topic = "/arm/pose" }``"""

    topic: str | None = None
    direction: str | None = None
    service: str | None = None
    action: str | None = None
    parameter: str | None = None
    tf: str | None = None
    node: str | None = None


class RefusedTable(Table):
    """``refused = { path = "status", values = [5, 6], topic = "/arm/notification" }``"""

    path: str = ""
    values: list[Any]
    topic: str | None = None


class ClockTable(Table):
    """``clock = { tick = "module:qualname", time = "self.time", unit = "s" }``, or with a fixed ``step``"""

    tick: str
    time: str = ""
    unit: str = "s"
    step: Annotated[float | None, Field(gt=0)] = None


class WaitTable(Table):
    """``wait = { call = "module:qualname", unit = "s" }``"""

    call: str
    unit: str = "s"


class ProbeTable(Table):
    """One ``[[probe]]``."""

    call: str
    tolerance: Annotated[float, Field(ge=0)] = 1e-6
    result: dict[str, Any] | None = None
    better: Annotated[Better | None, Field(strict=False)] = None


class VocabularyTable(Table):
    """The top of a vocabulary file."""

    operation: list[Any] = Field(default_factory=list)
    refusals: list[str] = Field(default_factory=list)
    checks: list[str] = Field(default_factory=list)
    failures: list[str] = Field(default_factory=list)
    clock: dict[str, Any] | None = None
    wait: dict[str, Any] | None = None
    probe: list[Any] = Field(default_factory=list)


def is_name(text: str) -> bool:
    """Whether Python takes a text for a name."""
    return text.isidentifier() and not keyword.iskeyword(text)


def target_fault(text: str) -> str | None:
    """What is wrong with a target, or None."""
    form = "module:qualified.name"
    if not text.strip():
        return f"is empty; expected {form}"
    if text.count(":") > 1:
        return f"{text!r} has more than one colon; expected {form}"
    if ":" not in text:
        return f"{text!r} has no colon between module and name; write {_with_colon(text)!r}"
    module, _, name = text.partition(":")
    if not module or not name:
        return f"{text!r} has no {'name after' if module else 'module before'} the colon; expected {form}"
    for part in (*module.split("."), *name.split(".")):
        if not part:
            return f"{text!r} has a dot too many; expected {form}"
        if not is_name(part):
            return f"{text!r}: {part!r} is not a Python name; expected {form}"
    return None


def _with_colon(text: str) -> str:
    if isinstance(getattr(builtins, text, None), type):
        return f"builtins:{text}"
    parts = text.split(".")
    if len(parts) == 1:
        return f"module:{text}"
    # robot.Arm.move: by convention a module's name is lower case and a class's is not
    first = next((index for index, part in enumerate(parts) if index and part[:1].isupper()), len(parts) - 1)
    return f"{'.'.join(parts[:first])}:{'.'.join(parts[first:])}"


def read_idle(check: Check, raw: Any, place: KeyPath) -> Any:
    """``idle = …`` as data that ``model.answer.restore`` understands; mistakes are noted.

    A TOML value is the answer itself; ``{ call = "module:name" }`` names a function that makes it.
    """
    if isinstance(raw, dict) and set(raw) == {"call"}:
        target = raw["call"]
        fault = target_fault(target) if isinstance(target, str) else f"must be a text, not {shown(target)}"
        if fault is not None:
            check.error((*place, "call"), fault)
        return {"call": target}
    return _data(check, raw, place)


def _data(check: Check, raw: Any, place: KeyPath) -> Any:
    if isinstance(raw, list):
        return {"list": [_data(check, item, place) for item in raw]}
    if isinstance(raw, dict):
        return {"dict": [[key, _data(check, item, (*place, key))] for key, item in raw.items()]}
    if raw is not None and not isinstance(raw, str | bool | int | float):
        wanted = 'a text, a number, true, false, an array or table of these, or { call = "module:name" }'
        check.error(place, f"must be {wanted}, not {shown(raw)}")
    return raw
