"""The shape of a vocabulary file: which keys there are and what type their values have.

What the values mean together is checked where the tables are turned into operations.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from mutabot.model import Kind, Mode


class Table(BaseModel):
    """A table of a TOML file: nothing unknown, nothing converted, only finite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


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
    """One entry of ``patterns``; the keys of a quantity describe its only field."""

    text: str
    opposite: str | None = None
    idle: Any = None
    arguments: dict[str, Any] = Field(default_factory=dict)
    result: dict[str, Any] | None = None
    kind: Any = None
    axis: Any = None
    unit: Any = None
    frame: Any = None
    mode: Any = None
    values: Any = None
    range: Any = None
    clip: Any = None
    noise: Any = None
    relative: Any = None
    ladder: Any = None
    repeatability: Any = None
    missing: Any = None
    tcp: Any = None


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
