"""Which task of a program goes on when: one alone blocks as the cell does, several take turns by a seed."""

from __future__ import annotations

from random import Random
from typing import Any

from mutabot_languages.errors import ProgramError

from .interrupts import HANDLERS
from .machine import Machine
from .scope import ControlFlow, ProgramRaised, Steps, TaskOperation
from .station import TICK


class TaskSchedule:
    """Carries out the operations that tasks yield.

    Args:
        machine: the run.
        seed: of the order in which tasks take turns.
    """

    def __init__(self, machine: Machine, seed: int) -> None:
        self._machine, self._station = machine, machine.station
        self._random = Random(seed)
        self._waiting: dict[str, _TaskWait] = {}

    def run(self, main: str) -> None:
        """Run until the main task has ended; the others end with it."""
        tasks = self._machine.tasks
        while main in tasks:
            ready = self._ready()
            self._random.shuffle(ready)
            for name in ready:
                if main in tasks and name in tasks and self._may_begin(name):
                    self._advance(name, main)
            for name in [task for task in self._waiting if task not in tasks]:
                del self._waiting[name]
            if main in tasks and not self._ready():
                self._pass_time()
        for steps in tasks.values():
            steps.close()

    def _ready(self) -> list[str]:
        return [name for name in self._machine.tasks if name not in self._waiting and self._may_begin(name)]

    def _may_begin(self, name: str) -> bool:
        """Return whether a task may go on: while an interrupt is carried out, no other one does."""
        return name == HANDLERS or not self._machine.interrupts.is_handling

    def _advance(self, name: str, main: str) -> None:
        """Let a task go on until it waits."""
        steps: Steps = self._machine.tasks[name]
        try:
            operation = next(steps)
            while len(self._machine.tasks) == 1:
                self._carry_out(operation)
                operation = next(steps)
        except StopIteration:
            self._machine.tasks.pop(name, None)
        except ControlFlow as leave:
            if leave.kind == "exit":  # the whole program
                self._machine.tasks.clear()
            elif leave.kind == "goto":
                raise ProgramError(f"there is no label {leave.value} to go to") from None
            self._machine.tasks.pop(name, None)
        except ProgramRaised as error:
            raise ProgramError(f"an error that no handler takes: {error}") from error
        else:
            self._waiting[name] = self._begin(operation)

    def _carry_out(self, operation: TaskOperation) -> None:
        """Carry out an operation of the only task, as the cell's own calls do: they block."""
        cell = self._station.cell
        if operation.watch is not None:
            wait = self._begin(operation)
            while not wait.move.done:
                self._station.call(operation.site, cell.wait, TICK)
                operation.watch()
            self._station.call(operation.site, wait.move.wait)
        elif operation.motion is not None:
            method, arguments, speed = operation.motion
            self._station.call(operation.site, getattr(cell.arm, method), *arguments, speed=speed)
        else:
            self._station.call(operation.site, cell.wait, operation.seconds)

    def _begin(self, operation: TaskOperation) -> _TaskWait:
        if operation.motion is not None:
            method, arguments, speed = operation.motion
            start = getattr(self._station.cell.arm, f"start_{method}")
            move = self._station.call(operation.site, start, *arguments, speed=speed)
            return _TaskWait(operation, move=move)
        return _TaskWait(operation, end=self._station.time + operation.seconds)

    def _pass_time(self) -> None:
        """Let a tick pass, as all tasks wait, and wake those whose wait is over."""
        first = next(iter(self._waiting.values()))
        self._station.call(first.operation.site, self._station.cell.wait, TICK)
        now = self._station.time
        for name, wait in [*self._waiting.items()]:
            if wait.operation.watch is not None:
                wait.operation.watch()
            if wait.move is not None and wait.move.done:
                self._station.call(wait.operation.site, wait.move.wait)
                del self._waiting[name]
            elif wait.move is None and now >= wait.end - TICK / 2:
                del self._waiting[name]


class _TaskWait:
    """What a task waits for."""

    def __init__(self, operation: TaskOperation, *, move: Any = None, end: float = 0.0) -> None:
        self.operation, self.move, self.end = operation, move, end
