"""A stage with a small client library in the place of a middleware: its hooks are written as all hooks are.

Everything is real (handlers, adapters, operators, deliveries) but the client library, whose clock is a number
that sleeping moves on.
"""

from __future__ import annotations

import heapq
import importlib
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from mutabot.model import Mutant, Operation, Role, Site, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.events import SiteSeen
from mutabot.model.job import Job
from mutabot.model.mutant import Place
from mutabot.model.operation import Form
from mutabot.runtime.interception.active_mutant import MutatedSite
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.session import Session
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import MiddlewareControls, Where
from tests.runtime.stage import take_away

from .stage import ListWriter

_numbers = count(1)
NODE = "/mission"


class LostAnswerError(Exception):
    """What this middleware raises for an answer that never comes."""


@dataclass
class Client:
    """The client library.

    Attributes:
        messages: where handlers are found; None as long as nobody hooks it.
        log: what reached the robot, with the time.
        now: its clock, in seconds.
        coming: what will be received by waiting.
        cancelled: results of what was cancelled.
    """

    messages: Messages | None = None
    log: list[Any] = field(default_factory=list)
    now: float = 0.0
    coming: list[Any] = field(default_factory=list)
    cancelled: list[Any] = field(default_factory=list)
    jumped: float = 0.0
    _due: list[tuple[float, int, Callable[[], object]]] = field(default_factory=list)

    def publish(self, name: str, message: Any) -> None:
        """Send a message."""

        def wrapped(message: Any) -> None:
            self.log.append((self.now, name, message))
            self.tell(name, message)

        self._do(Form.PUBLISH, name, wrapped, message)

    def tell(self, name: str, message: Any) -> None:
        """A message passes by."""
        if self.messages is not None:
            self.messages.heard(name, message)

    def call(self, name: str, request: Any) -> Any:
        """Call a service, which answers with what it was asked."""

        def wrapped(request: Any) -> Any:
            self.log.append((self.now, name, request))
            return SimpleNamespace(asked=request)

        return self._do(Form.CALL, name, wrapped, request)

    def send(self, name: str, goal: Any) -> Any:
        """Send a goal."""

        def wrapped(goal: Any) -> Any:
            self.log.append((self.now, name, goal))
            return goal

        return self._do(Form.GOAL, name, wrapped, goal)

    def receive(self, name: str, message: Any, callback: Callable[[Any], Any]) -> Any:
        """A message has come: the program's callback is called."""
        self.tell(name, message)
        where = Where(callback.__code__, NODE, self._means)
        handler = self._find(Form.RECEIVE, name)
        return callback(message) if handler is None else where.deliver(handler, message, callback)

    def tick(self, callback: Callable[[Any], Any]) -> None:
        """A timer's callback is called."""
        handler = self._find(Form.TICK, "/mission/check")
        where = Where(callback.__code__, NODE, self._means)
        callback(None) if handler is None else where.deliver(handler, None, callback)

    def wait(self, name: str) -> Any:
        """Wait for a message."""

        def wait() -> Any:
            if not self.coming:
                raise TimeoutError(name)
            return self.coming.pop(0)

        handler = self._find(Form.RECEIVE, name)
        where = Where(node=NODE, means=self._means)
        return wait() if handler is None else where.wait_for(handler, wait, lambda _: False, time)

    def set_up(self, form: Form, **settings: Any) -> None:
        """Set something up."""
        name = f"/arm/{settings['name']}"  # the node stands in this namespace

        def wrapped(
            name: Any = ..., depth: Any = ..., reliability: Any = ..., deadline: Any = ..., latch: Any = ...
        ) -> None:
            given = {**locals()}
            given.pop("self")
            self.log.append({key: value for key, value in given.items() if value is not ...})

        handler = self._find(form, name)
        where = Where(node=NODE, means=self._means)
        wrapped(**settings) if handler is None else handler(wrapped, None, (), settings, where)

    def parameter(self, name: str, default: Any = None) -> Any:
        """Read a parameter, which is always 5."""
        handler = self._find(Form.PARAMETER, name)
        where = Where(node=NODE, means=self._means)

        def wrapped(default: Any = None) -> Any:
            return 5

        return 5 if handler is None else handler(wrapped, None, (), {"default": default}, where)

    def spin(self) -> None:
        """Do all that is due later."""
        while self._due:
            self.now, _, action = heapq.heappop(self._due)
            action()

    def _do(self, form: Form, name: str, wrapped: Callable[[Any], Any], written: Any) -> Any:
        handler = self._find(form, name)
        if handler is None:
            return wrapped(written)
        return handler(wrapped, None, (written,), {}, Where(node=NODE, means=self._means))

    def _find(self, form: Form, name: str) -> Any:
        return self.messages.find(form, name, NODE) if self.messages is not None else None

    @property
    def _means(self) -> MiddlewareControls:
        async def sleep(seconds: float) -> None:
            self.now += seconds

        async def lost() -> Any:
            raise LostAnswerError

        async def cancel(result: Any) -> None:
            self.cancelled.append(result)

        def jump(seconds: float) -> None:
            self.jumped += seconds

        def later(seconds: float, action: Callable[[], object]) -> None:
            heapq.heappush(self._due, (self.now + seconds, len(self._due), action))

        return MiddlewareControls(sleep, later, lost, cancel, jump, goes_out=later)


@dataclass
class ClientStage:
    """One program over the client library, which it gets as the argument of ``run``."""

    folder: Path
    operations: tuple[Operation, ...]
    sessions: list[Session] = field(default_factory=list)
    counted: int = 0
    writer: ListWriter = field(default_factory=ListWriter)

    def program(self, text: str) -> ModuleType:
        """The program's module."""
        name = f"client_program_{next(_numbers)}"
        (self.folder / f"{name}.py").write_text(text, encoding="utf-8")
        sys.path.insert(0, str(self.folder))
        try:
            importlib.invalidate_caches()
            return importlib.import_module(name)
        finally:
            sys.path.remove(str(self.folder))

    def session(
        self, program: ModuleType, mutant: Mutant | None = None, oracle_nodes: tuple[str, ...] = ()
    ) -> tuple[Session, Client]:
        """A session in the midst of a test, and the client library under its hooks."""
        job = Job(
            root=str(self.folder),
            program=(f"{program.__name__}.py",),
            oracle=(),
            vocabulary=Vocabulary(self.operations),
            seed=1,
            round=0,
            mutant=mutant,
            active={} if mutant is None else {mutant.id: Activation.of_call(Place.of(mutant))},
            inspect=False,
            oracle_nodes=oracle_nodes,
        )
        locator = Locator(job.root, job.program, job.oracle)
        session = Session(job, self.writer, locator)  # type: ignore[arg-type]
        session.install()
        self.sessions.append(session)
        session.start_test("test")
        return session, Client(session.messages or Messages(session.inspection.target_is_wrong))

    def mutated(
        self,
        text: str,
        operator: str,
        variant: str = "",
        quantity: str | None = None,
        *,
        coming: Any = (),
        oracle_nodes: tuple[str, ...] = (),
    ) -> tuple[Any, Client, MutatedSite]:
        """Run a program as the original to find its only site, then as a mutant there.

        Returns what it returns or raises, the client library, and the mutant at work.
        """
        program = self.program(text)
        session, client = self.session(program)
        client.coming = list(coming)
        program.run(client)
        take_away(session)
        return self.again(program, operator, variant, quantity, coming=coming, oracle_nodes=oracle_nodes)

    def again(
        self,
        program: ModuleType,
        operator: str,
        variant: str = "",
        quantity: str | None = None,
        *,
        coming: Any = (),
        oracle_nodes: tuple[str, ...] = (),
    ) -> tuple[Any, Client, MutatedSite]:
        """The same for a program that has run as the original."""
        seen = [line for line in self.writer.lines if isinstance(line, SiteSeen)][-1]
        site = Site(seen.span, "text", 1, Role.PROGRAM)
        mutant = Mutant(1, "middleware", operator, site, seen.operation, seen.pattern, quantity, variant, "")
        session, client = self.session(program, mutant, oracle_nodes)
        client.coming = list(coming)
        try:
            result: Any = program.run(client)
        except Exception as error:
            result = error
        assert session.meter is not None
        self.counted = session.meter.operations
        take_away(session)
        assert session.mutant is not None
        return result, client, session.mutant
