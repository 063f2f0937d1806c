"""Faults that code of their provider puts in place before each test: no calls, and no text of the program.

A provider names its subclass of ``ProcessFault`` in ``mutabot.faults.PlannedMutant.in_process``. One is made
in each process of the tests when the first of them begins. What it raises is an error of its mutant, no kill.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from random import Random
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from mutabot.errors import in_words
from mutabot.model import Mutant
from mutabot.model.job import InProcess
from mutabot.operators.command import FatalFault
from mutabot.runtime.evidence import Evidence, everything
from mutabot.runtime.observation.probes import opaque

if TYPE_CHECKING:
    from types import FrameType

    from mutabot.runtime.interception.trace import Locator

#: modules that stand in for the robot in tests
_MOCKS = "unittest.mock"


class ProcessFault(ABC):
    """One mutant in a process of the tests.

    A robot that refuses a command because of it is for the tests to judge: the mutant makes no calls itself.

    Attributes:
        mutant: the mutant.
        data: what its provider has told it.
        evidence: what it did in the running test.
        on_act: told when it changes something for the first time in a test.
        meant: the exceptions that it has raised for the program on purpose.
    """

    def __init__(self, mutant: Mutant, data: Any) -> None:
        self.mutant, self.data = mutant, data
        self.evidence = Evidence()
        self.on_act: Callable[[], None] = lambda: None
        self.meant: list[BaseException] = []

    @abstractmethod
    def start_test(self, test: str, random: Random) -> None:
        """A test begins, before its fixtures: put the fault in place. All it draws comes from ``random``."""

    @abstractmethod
    def end_test(self) -> None:
        """The test and its fixtures are over: take the fault away."""

    def reached(self) -> None:
        """Report that the running test used the fault's target unchanged."""
        self.evidence.hits += 1

    def acts(self, before: Any = None, after: Any = None) -> None:
        """Report that the running test used the fault's target, and that the fault changed it."""
        self.evidence.hits += 1
        self.evidence.acted += 1
        if self.evidence.acted == 1:
            self.evidence.example = (_plain(before), _plain(after))
            self.on_act()

    def raising(self, error: BaseException) -> BaseException:
        """Say that the program is to meet this exception: ``raise self.raising(TimeoutError("no answer"))``.

        Any other that this fault's code raises is an error of the mutant.
        """
        self.meant.append(error)
        return error


class ProcessIdentity(ProcessFault):
    """The control that changes nothing."""

    def start_test(self, test: str, random: Random) -> None:
        self.reached()

    def end_test(self) -> None:
        """Nothing was put in place."""


class ProcessFatal(ProcessFault):
    """The control by which every test fails."""

    def start_test(self, test: str, random: Random) -> None:
        self.acts()
        raise FatalFault(f"control: {self.mutant.site.place} fails")

    def end_test(self) -> None:
        """Nothing was put in place."""


@dataclass(slots=True)
class PlacedFault:
    """The mutant of this process, if it is such a fault.

    Attributes:
        on_act: told the mutant's id when it changes something for the first time in a test.
        fatal: what the fatal control raises: the setup of the running test is to fail with it.
    """

    on_act: Callable[[str], None]
    fatal: FatalFault | None = None
    _mutant: Mutant | None = None
    _how: InProcess | None = None
    _fault: ProcessFault | None = None
    _failure: str | None = None

    def place(self, mutant: Mutant, how: InProcess) -> None:
        """From the next test on, this is in place."""
        self._mutant, self._how = mutant, how

    @property
    def evidence(self) -> Evidence:
        """What it did in the running test."""
        found = Evidence()
        if self._fault is not None:
            with self._guarded(self._fault.mutant, "asked what it did"):
                found = _checked(self._fault.evidence)
        return found if self._failure is None else replace(found, failure=self._failure)

    def start_test(self, test: str, random_of: Callable[[Mutant], Random]) -> None:
        """A test begins."""
        self.fatal = None
        if self._mutant is not None and self._how is not None:
            with self._guarded(self._mutant, "put in place"):
                fault = self._fault = self._fault or self._made(self._mutant, self._how)
                fault.evidence = Evidence()
                fault.start_test(test, random_of(self._mutant))

    def end_test(self) -> None:
        """The test and its fixtures are over; what the fault did is asked after this."""
        if self._fault is not None:
            with self._guarded(self._fault.mutant, "taken away"):
                self._fault.end_test()

    @contextmanager
    def _guarded(self, mutant: Mutant, what: str) -> Iterator[None]:
        """A provider may fail in any way: that is an error of its mutant, and says nothing of the tests."""
        try:
            yield
        except BaseException as error:
            if isinstance(error, FatalFault) and isinstance(self._fault, ProcessFatal):
                self.fatal = error
                return
            self._failure = self._failure or f"{mutant.operator} cannot be {what}: {in_words(error)}"

    def failure_in(self, error: BaseException, robots: Collection[str], locator: Locator) -> str | None:
        """How its own code failed, if that is where an exception comes from that a test or process met.

        Args:
            error: the exception.
            robots: the modules of the operations that are mutated.
            locator: knows the files of the program and its tests.
        """
        fault = self._fault
        if fault is None or isinstance(fault, ProcessFatal):
            return None
        meant = {*map(id, fault.meant)}
        for one in everything(error):
            frames = (frame for frame, _ in reversed(list(walk_tb(one.__traceback__))))
            told = (_is_own(frame, type(fault).__module__, robots, locator) for frame in frames)
            # the nearest to the raise decides that is the fault's, the robot's, the program's or a test's
            if id(one) not in meant and next((is_own for is_own in told if is_own is not None), False):
                return f"{fault.mutant.operator} fails at work: {in_words(one)}"
        return None

    def _made(self, mutant: Mutant, how: InProcess) -> ProcessFault:
        """The fault, which is made when the first test begins."""
        module, _, name = how.reference.partition(":")
        fault: ProcessFault = getattr(import_module(module), name)(mutant, how.data)
        if not isinstance(fault, ProcessFault):
            raise TypeError(f"{how.reference} is no mutabot.runtime.process_fault.ProcessFault")
        fault.on_act = lambda: self.on_act(mutant.id)
        return fault


def _is_own(frame: FrameType, module: str, robots: Collection[str], locator: Locator) -> bool | None:
    """Whether a frame is of a fault's code, or of its package; None for those that say nothing."""
    name = str(frame.f_globals.get("__name__", ""))
    if name in robots:
        return False
    if _is_within(name, module.rpartition(".")[0] or module):
        return True
    if name.startswith(_MOCKS) or any(_is_within(name, one.partition(".")[0]) for one in robots):
        return False
    file = frame.f_code.co_filename
    return False if locator.is_of_project(file) or locator.role(file) is not None else None


def _is_within(name: str, package: str) -> bool:
    return name == package or name.startswith(f"{package}.")


def _checked(evidence: Any) -> Evidence:
    if not isinstance(evidence, Evidence) or {type(evidence.hits), type(evidence.acted)} != {int}:
        raise TypeError(f"its evidence is {type(evidence).__name__}, not as ProcessFault keeps it")
    return evidence


def _plain(value: Any) -> Any:
    return value if value is None or isinstance(value, bool | int | float | str) else opaque(value)
