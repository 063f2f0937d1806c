"""Faults that code of their provider puts in place before each test: no calls, and no text of the program.

A provider names its subclass of ``ProcessFault`` in ``mutabot.faults.Planted.in_process``. One is made in
each process of the tests when the first of them begins. What it raises is an error of its mutant, no kill.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib import import_module
from random import Random
from typing import Any

from mutabot.model import Mutant
from mutabot.model.job import InProcess
from mutabot.operators.command import FatalFault
from mutabot.runtime.evidence import Evidence
from mutabot.runtime.observation.probes import opaque


class ProcessFault(ABC):
    """One mutant in a process of the tests.

    A robot that refuses a command because of it is for the tests to judge: the mutant makes no calls itself.

    Attributes:
        mutant: the mutant.
        data: what its provider has told it.
        evidence: what it did in the running test.
        on_act: told when it changes something for the first time in a test.
    """

    def __init__(self, mutant: Mutant, data: Any) -> None:
        self.mutant, self.data = mutant, data
        self.evidence = Evidence()
        self.on_act: Callable[[], None] = lambda: None

    @abstractmethod
    def start_test(self, test: str, random: Random) -> None:
        """A test begins, before its fixtures: put the fault in place. All it draws comes from ``random``."""

    @abstractmethod
    def end_test(self) -> None:
        """The test and its fixtures are over: take the fault away."""

    def reached(self) -> None:
        """Say that the running test has made use of what the fault is about, and found it as it always is."""
        self.evidence.hits += 1

    def acts(self, before: Any = None, after: Any = None) -> None:
        """Say that the running test has made use of it, and that it was another than without the fault."""
        self.evidence.hits += 1
        self.evidence.acted += 1
        if self.evidence.acted == 1:
            self.evidence.example = (_plain(before), _plain(after))
            self.on_act()


class Identity(ProcessFault):
    """The control that changes nothing."""

    def start_test(self, test: str, random: Random) -> None:
        self.reached()

    def end_test(self) -> None:
        """Nothing was put in place."""


class Fatal(ProcessFault):
    """The control by which every test fails."""

    def start_test(self, test: str, random: Random) -> None:
        self.acts()
        raise FatalFault(f"control: {self.mutant.site.place} fails")

    def end_test(self) -> None:
        """Nothing was put in place."""


@dataclass(slots=True)
class _Placed:
    """A mutant's fault; None before the first test, or if it cannot be made, with the reason."""

    mutant: Mutant
    how: InProcess
    fault: ProcessFault | None = None
    failure: str | None = None

    @property
    def evidence(self) -> Evidence:
        found = self.fault.evidence if self.fault is not None else Evidence()
        return found if self.failure is None else replace(found, failure=self.failure)


@dataclass(slots=True)
class ProcessFaults:
    """All such faults in this process.

    Attributes:
        on_act: told the mutant's id when one changes something for the first time in a test.
        fatal: what the fatal control raises: the setup of the running test is to fail with it.
    """

    on_act: Callable[[str], None]
    fatal: FatalFault | None = None
    _placed: list[_Placed] = field(default_factory=list)

    def add(self, mutant: Mutant, how: InProcess) -> None:
        """From the next test on, this is in place."""
        self._placed.append(_Placed(mutant, how))

    @property
    def evidence(self) -> list[Evidence]:
        """What each of them did in the running test."""
        return [one.evidence for one in self._placed]

    def start_test(self, test: str, random_of: Callable[[Mutant], Random]) -> None:
        """A test begins."""
        self.fatal = None
        for one in self._placed:
            try:
                fault = self._fault_of(one)
                fault.evidence = Evidence()
                fault.start_test(test, random_of(one.mutant))
            except FatalFault as error:
                self.fatal = error
            except Exception as error:  # a provider may fail in any way, which says nothing of the tests
                one.failure = f"{one.mutant.operator} cannot be put in place: {type(error).__name__}: {error}"

    def end_test(self) -> None:
        """The test and its fixtures are over."""
        for one in self._placed:
            try:
                if one.fault is not None:
                    one.fault.end_test()
            except Exception as error:  # what comes after cannot be believed
                one.failure = f"{one.mutant.operator} cannot be taken away: {type(error).__name__}: {error}"

    def _fault_of(self, one: _Placed) -> ProcessFault:
        """The fault, which is made when the first test begins."""
        if one.fault is None:
            module, _, name = one.how.reference.partition(":")
            kind = getattr(import_module(module), name)
            fault: ProcessFault = kind(one.mutant, one.how.data)
            if not isinstance(fault, ProcessFault):
                raise TypeError(f"{one.how.reference} is no mutabot.runtime.process_fault.ProcessFault")
            fault.on_act = lambda: self.on_act(one.mutant.id)
            one.fault = fault
        return one.fault


def _plain(value: Any) -> Any:
    return value if value is None or isinstance(value, bool | int | float | str) else opaque(value)
