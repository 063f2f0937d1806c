"""What goes to a worker and comes back: a unit of work and its answer, as JSON in bytes."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.border.codec import from_data, to_data
from mutabot.border.events import EVENTS, Event, event_to_data
from mutabot.campaign.workers.task import Result, Task

from .checked import Misfit, checked, read
from .fitting import check_fit


@dataclass(frozen=True, slots=True)
class Ground:
    """What all units of a campaign stand on.

    Attributes:
        digest: of the bundle, which is its name.
        root: the project's folder on the controller's machine.
        inner: the project's folder in the bundle.
        arguments: the project's pytest arguments.
        environment: variables that the controller decides; None for those that are not to be set.
        paths: folders of the bundle that modules come from.
    """

    digest: str
    root: str
    inner: str
    arguments: tuple[str, ...]
    environment: Mapping[str, str | None]
    paths: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Unit:
    """One task, on its ground. The key of the task stays with the controller.

    ``ticket`` is what the answer must bear: who was not given the unit does not know it.
    """

    ground: Ground
    task: Task
    ticket: str = ""

    def data(self) -> bytes:
        """It as bytes."""
        return _bytes(replace(self, task=replace(self.task, key=None)))

    @classmethod
    def of(cls, data: bytes) -> Unit:
        """The unit in such bytes."""
        return from_data(cls, json.loads(data))


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of a unit.

    Attributes:
        lines: what its process reported.
        exit_code, overdue, where, wall, log: as in ``Result``.
        fault: why it says nothing about the mutant, if it does not: the fault of the worker or its machine.
        is_unfit: whether that worker is of no use to the campaign any more.
        lost: as in ``Result``.
        ticket: of the unit.
    """

    lines: tuple[Any, ...] = ()
    exit_code: int = 0
    overdue: str | None = None
    where: str | None = None
    wall: float = 0.0
    log: str = ""
    fault: str | None = None
    is_unfit: bool = False
    lost: str | None = None
    ticket: str = ""

    @classmethod
    def of_result(cls, lines: Iterable[Event], result: Result, fault: str | None = None) -> Answer:
        """The answer with what a worker process told and came to."""
        return cls(
            tuple(map(event_to_data, lines)), result.exit_code, result.overdue,
            result.where, result.wall, result.log, fault,
        )  # fmt: skip

    def data(self, here: str, there: str) -> bytes:
        """It as bytes, in which the folder ``here`` is called as the controller calls it, ``there``."""
        return _bytes(self).replace(_in_json(here), _in_json(there))

    @classmethod
    def of(cls, data: bytes, unit: Unit) -> tuple[Answer, list[Event]]:
        """The answer in such bytes, and its events. Raises Misfit if it is none to this unit."""
        answer = checked(cls, read(data))
        if answer.ticket != unit.ticket:
            raise Misfit("it is the answer to something else")
        lines = [_line(index, line) for index, line in enumerate(answer.lines)]
        check_fit(lines, unit.task.job)
        return answer, lines

    def result(self, task: Task, lines: Iterable[Event]) -> Result:
        """The result of a task of which this is the answer."""
        found = Result(task)
        for line in lines:
            found.take(line)
        found.exit_code, found.overdue, found.where = self.exit_code, self.overdue, self.where
        found.wall, found.log, found.lost = self.wall, self.log, self.lost
        return found


@dataclass(frozen=True, slots=True)
class Introduction:
    """What a worker says of itself.

    Attributes:
        versions: what it runs with, as keys of outcomes have it.
        has: whether it has the bundle.
    """

    versions: Mapping[str, str] = field(default_factory=dict)
    has: bool = False

    def data(self) -> bytes:
        """It as bytes."""
        return _bytes(self)

    @classmethod
    def of(cls, data: bytes) -> Introduction:
        """The introduction in such bytes. Raises Misfit."""
        return checked(cls, read(data))


def _line(index: int, data: Any) -> Event:
    kind = EVENTS.get(str(data.get("type"))) if isinstance(data, dict) else None
    if kind is None:
        raise Misfit(f".lines[{index}] is no report line")
    try:
        line: Event = checked(kind, {name: value for name, value in data.items() if name != "type"})
    except Misfit as error:
        raise Misfit(f".lines[{index}] ({kind.__name__}): {error}") from None
    return line


def _bytes(value: Any) -> bytes:
    return json.dumps(to_data(value), separators=(",", ":")).encode()


def _in_json(path: str) -> bytes:
    return json.dumps(os.fspath(path))[1:-1].encode()
