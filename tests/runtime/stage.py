"""A small stage for tests of the inside: a robot module, a program, a vocabulary, and a session.

Everything is real (interception, adapters, operators) but the pipe, whose lines are kept in a list.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any

from mutabot.config.vocabulary import load
from mutabot.model import Mutant, Role, Site, Span, Vocabulary
from mutabot.model.events import Event, SiteSeen
from mutabot.model.job import Budget, Job
from mutabot.runtime.interception.active_mutant import ActiveMutant
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.session import Session

_numbers = count(1)


class ListPipe:
    """Takes report lines like the real pipe and keeps them."""

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
    pipe: ListPipe = field(default_factory=ListPipe)

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
            session.remove()
        sys.path.remove(str(self.folder))
        for name in (self.robot_name, self.program_name):
            sys.modules.pop(name, None)

    @property
    def vocabulary(self) -> Vocabulary:
        return load(["robot.toml"], self.folder)

    def session(
        self, mutant: Mutant | None = None, *, budget: Budget | None = None, inspect: bool = False
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
            budgets={"test": budget or Budget()},
            inspect=inspect,
        )
        locator = Locator(job.root, job.program, job.oracle)
        session = Session(job, self.pipe, locator)  # type: ignore[arg-type]  # it has the one method
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
        return [line for line in self.pipe.lines if isinstance(line, SiteSeen)]

    def mutated(
        self,
        operator: str,
        quantity: str | None = None,
        *,
        index: int = 0,
        idle: Any = None,
        variant: str = "",
    ) -> tuple[Any, ActiveMutant]:
        """Run the program once as the original to find sites, then as a mutant at the site ``index``.

        Returns the program's result and the activation with its evidence.
        """
        recording = self.session()
        self.run(recording)
        recording.remove()
        sys.modules.pop(self.program_name)  # its text asks the session that was there when it was loaded
        seen = self.sites()[index]
        mutant = Mutant(
            1, "robot", operator, _site(seen.span), seen.operation, seen.pattern, quantity, variant, "", idle
        )
        session = self.session(mutant)
        result = self.run(session)
        return result, session.activations[0]


def _site(span: Span) -> Site:
    return Site(span, "text", 1, Role.PROGRAM)


Make = Callable[..., Stage]
