"""A small stage for tests of the inside: a robot module, a program, a vocabulary, and a session.

Everything is real (interception, adapters, operators) but the event file, whose lines are kept in a list.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any
from unittest import mock

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model import Mutant, Role, Site, Span, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.events import Event, SiteSeen
from mutabot.model.job import Job
from mutabot.model.mutant import Place
from mutabot.runtime.interception.active_mutant import MutatedSite
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.program_text import compiling
from mutabot.runtime.session import Session
from mutabot.runtime.targets.target import NotFoundError, resolve

_numbers = count(1)
_MOCK_CALL = vars(mock)["CallableMixin"].__call__


class ListWriter:
    """Takes report lines like an event file, and keeps them."""

    def __init__(self) -> None:
        self.lines: list[Event] = []

    def send(self, line: Event) -> None:
        self.lines.append(line)


@dataclass
class Stage:
    """One robot module and one program, under names of their own so that tests do not meet."""

    folder: Path
    robot: str
    program: str
    vocabulary_text: str
    early: bool = False
    sessions: list[Session] = field(default_factory=list)
    writer: ListWriter = field(default_factory=ListWriter)

    def __post_init__(self) -> None:
        number = next(_numbers)
        self.robot_name, self.program_name = f"robot_{number}", f"program_{number}"
        self._write(f"{self.robot_name}.py", self.robot)
        self._write(f"{self.program_name}.py", self.program)
        self._write("robot.toml", self.vocabulary_text)
        sys.path.insert(0, str(self.folder))
        importlib.invalidate_caches()

    def _write(self, name: str, text: str) -> None:
        text = (
            dedent(text)
            .replace("robot:", f"{self.robot_name}:")
            .replace("from robot", f"from {self.robot_name}")
        )
        text = text.replace("import robot", f"import {self.robot_name} as robot")
        (self.folder / name).write_text(text, encoding="utf-8")

    def close(self) -> None:
        for session in self.sessions:
            take_away(session)
        sys.path.remove(str(self.folder))
        for name in (self.robot_name, self.program_name):
            sys.modules.pop(name, None)

    @property
    def vocabulary(self) -> Vocabulary:
        return load_vocabulary(["robot.toml"], self.folder)

    def session(
        self,
        mutant: Mutant | None = None,
        *,
        simulated: float | None = None,
        inspect: bool = False,
        record: bool = False,
    ) -> Session:
        """A session with everything in place, in the middle of a test."""
        job = Job(
            root=str(self.folder),
            program=(f"{self.program_name}.py",),
            oracle=(),
            vocabulary=self.vocabulary,
            seed=1,
            round=0,
            mutant=mutant,
            active={} if mutant is None else {mutant.id: Activation.of_call(Place.of(mutant))},
            simulated={} if simulated is None else {"test": simulated},
            inspect=inspect,
            record=record,
        )
        locator = Locator(job.root, job.program, job.oracle)
        session = Session(job, self.writer, locator)  # type: ignore[arg-type]  # it has the one method
        session.install()
        session.start_test("test")
        self.sessions.append(session)
        return session

    def load_program(self) -> ModuleType:
        return importlib.import_module(self.program_name)

    def load_robot(self) -> ModuleType:
        return importlib.import_module(self.robot_name)

    def run(self, session: Session, function: str = "run", *args: Any) -> Any:
        """Call a function of the program; the session must be the one installed last."""
        assert session is self.sessions[-1]
        return getattr(self.load_program(), function)(*args)

    def sites(self) -> list[SiteSeen]:
        return [line for line in self.writer.lines if isinstance(line, SiteSeen)]

    def mutated(
        self,
        operator: str,
        quantity: str | None = None,
        *,
        index: int | str = 0,
        idle: Any = None,
        variant: str = "",
    ) -> tuple[Any, MutatedSite]:
        """Run the program once as the original to find sites, then as a mutant at the site ``index``.

        ``index`` counts the sites in the order in which the run came to them, or is the operation of a site:
        messages that come on several ways have no order.
        Returns the program's result and the activation with its activity.
        """
        recording = self.session()
        self.run(recording)
        take_away(recording)
        sys.modules.pop(self.program_name)  # its text asks the session that was there when it was loaded
        sites = self.sites()
        seen = next(s for s in sites if s.operation == index) if isinstance(index, str) else sites[index]
        mutant = Mutant(
            1, "robot", operator, _site(seen.span), seen.operation, seen.pattern, quantity, variant, "", idle
        )
        session = self.session(mutant)
        result = self.run(session)
        assert session.mutant is not None
        return result, session.mutant


def _site(span: Span) -> Site:
    return Site(span, "text", 1, Role.PROGRAM)


def forget(step: Any) -> None:
    """Compile files without a step from now on."""
    if step in compiling.steps:
        compiling.steps.remove(step)


def take_away(session: Session) -> None:
    """Let nothing of a session act any more: only tests have several in one process."""
    session.dispatcher.meter = None
    sites: Any = session.call_sites
    sites.stands, sites.hands = (lambda site, found, receiver, frame: found), None
    for step in (sites, session.text, session.returns):
        forget(step)
    found = [other for other in sys.modules.copy().values() if isinstance(other, ModuleType)]
    folder = session.job.root
    of_stage = [other for other in found if _is_below(folder, other)]
    for target, original in session.callables.found.items():
        module, _, qualname = target.partition(":")
        with suppress(NotFoundError, AttributeError, TypeError, KeyError):
            owner, name, _ = resolve(sys.modules[module], qualname)
            # the stage's modules are imported by none but its own; a walk through all others is slow
            may_name = of_stage if _is_below(folder, sys.modules[module]) else found
            _put_back(owner, name, original, may_name)
    if session.messages is not None:
        session.messages.remove()
    mocks_as_ever()


def mocks_as_ever() -> None:
    """See no calls of mocks any more."""
    classes: Any = mock
    classes.CallableMixin.__call__ = _MOCK_CALL


def _is_below(folder: str, module: ModuleType) -> bool:
    return (vars(module).get("__file__") or "").startswith(folder)


def _put_back(owner: Any, name: str, original: Any, modules: list[ModuleType]) -> None:
    wrapper = vars(owner).get(name)
    is_inherited = isinstance(owner, type) and any(
        vars(base).get(name) is original for base in owner.__mro__[1:]
    )
    if is_inherited:
        delattr(owner, name)
    else:
        setattr(owner, name, original)
    for module in modules:
        for key, value in list(vars(module).items()):
            if value is wrapper:
                setattr(module, key, original)


Make = Callable[..., Stage]
