"""The contract of a fault in the processes of the tests: one object, which is one mutant in one process.

Mutants of calls and of the program text are such faults of the core. A package names its own subclass of
``ActiveFault`` in ``mutabot.faults.PlannedMutant.active``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from mutabot.model.activation import NTH, TEST, FatalFault, Key
from mutabot.runtime.activity import Activity, shown

if TYPE_CHECKING:
    from random import Random

    from mutabot.model import Mutant


class FaultContext(Protocol):
    """The interface that a process of the tests offers to its fault."""

    @property
    def round(self) -> int:
        """The round, from 0."""

    @property
    def test(self) -> str:
        """Node id of the running test; empty before the first one."""

    @property
    def seconds(self) -> float | None:
        """Simulated seconds since the first tick of the running test; None without a clock."""

    def untracked(self) -> AbstractContextManager[None]:
        """Return a context in which calls of operations are attributed to the fault, not to the program.

        The methods of a fault are called in it. What a fault puts into the program is not.
        """

    def acted(self) -> None:
        """Report that the fault has changed something in the running test."""

    def change_file(self, path: str, content: bytes) -> None:
        """Give a file of the project another content, for this process and all below it.

        To be called in ``prepare_process`` of a fault that is made at once (``AT_ONCE``), if the program
        imports the file or reads it while it is imported. Processes below the tests find it changed.

        Args:
            path: relative to the project's root, with ``/``.
            content: all that is to be in the file.

        Raises OSError if the file cannot be written, or if this process has no files of its own: the user's
        are never changed.
        """


class ActiveFault(ABC):
    """The base class of faults: one mutant in one process of the tests.

    Its methods are called in this order: ``prepare_process`` once; in each test ``start_test``, ``reach`` for
    each of its keys but those of the start of a test, and ``end_test``. In a process that was forked for it,
    all begins where the fork is. What they raise is an error of the mutant, and no kill.

    Class attributes:
        is_checked: whether an exception that the program or a test meets is an error of the mutant if it
            comes from the fault's own package. The core's own report such errors themselves.
        is_of_text: whether it is a change of the program's files. A test that the robot's refusal ends has
            then not judged it, unless the robot refuses the call in the original as well.

    Attributes:
        mutant: the mutant.
        data: what its provider has sent it, as ``mutabot.model.activation.Activation.data`` has it.
        context: the process.
        keys: where it first differs from the original.
        meant: the exceptions that it has raised for the program on purpose.
    """

    is_checked: ClassVar[bool] = True
    is_of_text: ClassVar[bool] = False

    def __init__(self, mutant: Mutant, data: Any, context: FaultContext) -> None:
        self.mutant, self.data, self.context = mutant, data, context
        self.keys: tuple[Key, ...] = ()
        self.meant: list[BaseException] = []
        self._activity = Activity()

    @property
    def activity(self) -> Activity:
        """What the fault did in the running test."""
        return self._activity

    def prepare_process(self) -> None:  # noqa: B027  # most have nothing to prepare
        """Prepare this process, as soon as what the fault awaits exists."""

    @abstractmethod
    def start_test(self, test: str, random: Random) -> None:
        """Begin a test, before its fixtures, or continue it in a process that was just forked.

        Args:
            test: its node id.
            random: of all that the fault draws in this test.
        """

    def reach(self, key: Key) -> None:  # noqa: B027  # most are in place from the start of a test
        """Act on a key of the fault that the running test has reached, from where it may differ."""

    @abstractmethod
    def end_test(self) -> None:
        """Take the fault away, as the test and its fixtures are over."""

    def begin_count(self) -> None:
        """Reset the activity of the fault for a new test."""
        self._activity = Activity()

    def reached(self) -> None:
        """Report that the running test used the fault's target unchanged."""
        self._activity.hits += 1

    def acts(self, before: Any = None, after: Any = None) -> None:
        """Report that the running test used the fault's target, and that the fault changed it."""
        self._activity.hits += 1
        self._activity.acted += 1
        if self._activity.acted == 1:
            self._activity.example = (shown(before), shown(after))
            self.context.acted()

    def raising(self, error: BaseException) -> BaseException:
        """Return an exception for the program: ``raise self.raising(TimeoutError("no answer"))``.

        Any other that this fault's code raises is an error of the mutant.
        """
        self.meant.append(error)
        return error


class _ControlFault(ActiveFault):
    """The base class of controls, which are reached where the mutants at their place first differ."""

    is_checked: ClassVar[bool] = False

    def start_test(self, test: str, random: Random) -> None:
        """Act at the start of each test, if that is the control's place."""
        if all((key[2] if key[0] == NTH else key[0]) == TEST for key in self.keys):
            self.control()

    def reach(self, key: Key) -> None:
        """Act at each of the control's keys."""
        self.control()

    def end_test(self) -> None:
        """Do nothing, as nothing was put in place."""

    def control(self) -> None:
        """Do what the control is for."""


class IdentityControl(_ControlFault):
    """The control that changes nothing."""

    def control(self) -> None:
        """Note that the control was reached."""
        self.reached()


class FatalControl(_ControlFault):
    """The control by which every test fails."""

    def control(self) -> None:
        """Raise FatalFault."""
        self.acts()
        raise self.error

    @property
    def error(self) -> FatalFault:
        """The error that the control raises."""
        return FatalFault(f"control: {self.mutant.site.place} fails")
