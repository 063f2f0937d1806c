"""Run the fault of this process: make it when what it awaits exists, and distinguish its errors from others.

Whatever the code of a fault raises is an error of its mutant: no test has noticed anything then.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from importlib import import_module
from random import Random
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

import wrapt

from mutabot.errors import error_text
from mutabot.model import Mutant
from mutabot.model.activation import Activation, FatalFault, Key
from mutabot.runtime.active_fault import ActiveFault, FatalControl, FaultContext
from mutabot.runtime.activity import Activity
from mutabot.runtime.exceptions import Refusal, everything
from mutabot.runtime.executed_text import file_of
from mutabot.runtime.interception.active_mutant import with_refusal

if TYPE_CHECKING:
    from types import FrameType

    from mutabot.model import Call
    from mutabot.runtime.interception.trace import Locator

#: modules that stand in for the robot in tests
_MOCKS = "unittest.mock"
#: what a fault awaits that only a test brings
_OF_TEST = (Activation.FIRST_TEST, Activation.FIRST_TICK)


def preload(active: Iterable[Activation]) -> None:
    """Import the modules of faults whose awaited modules are there. What fails raises when it is needed."""
    there = [found for found in active if not found.awaits or found.awaits in sys.modules]
    for module in {found.reference.partition(":")[0] for found in there}:
        with suppress(Exception):
            import_module(module)


@dataclass(slots=True)
class FaultRunner:
    """The runner of this process's fault, if it has one.

    Attributes:
        context: what the fault is given.
        random_of: makes the random numbers of a mutant in the running test.
        activation: how the mutant becomes active; None for the original.
        fatal: what the fatal control raised as the running test began: its setup is to fail with it.
    """

    context: FaultContext
    random_of: Callable[[Mutant], Random]
    activation: Activation | None = None
    fatal: FatalFault | None = None
    _mutant: Mutant | None = None
    _fault: ActiveFault | None = None
    _failure: str | None = None
    _is_in_test: bool = False
    _refusals: tuple[Refusal, ...] = ()
    _is_unknown: bool = False

    def take_on(self, mutant: Mutant, activation: Activation) -> None:
        """Become this mutant, possibly within a test that has begun."""
        self._mutant, self.activation = mutant, activation
        self._is_in_test = bool(self.context.test)
        awaited, is_of_test = activation.awaits, activation.awaits in _OF_TEST
        if awaited == Activation.AT_ONCE or (is_of_test and self._is_in_test):
            self._make()
        elif not is_of_test:
            is_later = awaited not in sys.modules
            wrapt.register_post_import_hook(lambda module: self._imported(is_later=is_later), awaited)

    @property
    def activity(self) -> Activity:
        """What the fault did in the running test."""
        found = Activity()
        if self._fault is not None:
            with self._guarded("asked what it did"):
                found = _checked(self._fault.activity)
                if self._fault.is_of_text:
                    refusals, unknown = self._refusals, self._is_unknown
                    found = replace(found, is_of_text=True, refusals=refusals, is_unknown=unknown)
        return found if self._failure is None else replace(found, failure=self._failure)

    def _imported(self, *, is_later: bool) -> None:
        """Make the fault, whose awaited module was imported; the fatal control fails inside a test."""
        self._make()
        if is_later and self.fatal is not None:
            raise self.fatal

    def start_test(self) -> None:
        """Begin a test."""
        self.fatal, self._is_in_test = None, True
        self._refusals, self._is_unknown = (), False
        if self._fault is None and self._awaits(Activation.FIRST_TEST):
            self._make()
        elif self._fault is not None:
            self._start(self._fault)

    def tick(self) -> None:
        """Make the fault if it awaits the program's clock, which has begun."""
        if self._fault is None and self._awaits(Activation.FIRST_TICK):
            self._make()

    def _awaits(self, awaited: str) -> bool:
        return self.activation is not None and self.activation.awaits == awaited

    def reach(self, key: Key) -> None:
        """Pass on a key that the running test has reached. Raises FatalFault for the fatal control."""
        fault = self._fault
        if fault is None or key not in fault.keys:
            return
        if isinstance(fault, FatalControl):
            fault.reach(key)
            return
        with self._guarded("put in place"), self.context.untracked():
            fault.reach(key)

    def refused(self, error: BaseException, call: Call) -> None:
        """Note that the robot refuses a call, and not in the original: a changed program may cause that."""
        if self._fault is not None and self._fault.is_of_text and self.activity.acted:
            self._refusals = with_refusal(self._refusals, error)
            # the vocabulary says what commands there are; this is none of them
            self._is_unknown = call.operation.message is not None and call.pattern is None

    def end_test(self) -> None:
        """End a test and its fixtures; the fault's activity is read after this."""
        self._is_in_test = False
        if self._fault is not None:
            with self._guarded("taken away"), self.context.untracked():
                self._fault.end_test()

    def _make(self) -> None:
        """Make the fault, once; within a test, begin the test for it."""
        if self._fault is not None or self._failure is not None:
            return
        with self._guarded("put in place"), self.context.untracked():
            self._fault = self._made()
            self._fault.prepare_process()
        if self._fault is not None and self._is_in_test:
            self._start(self._fault)

    def _start(self, fault: ActiveFault) -> None:
        with self._guarded("put in place"), self.context.untracked():
            fault.begin_count()
            fault.start_test(self.context.test, self.random_of(fault.mutant))

    @contextmanager
    def _guarded(self, what: str) -> Iterator[None]:
        """Turn exceptions of the fault's own code into errors of its mutant."""
        try:
            yield
        except BaseException as error:
            if isinstance(error, FatalFault) and isinstance(self._fault, FatalControl):
                self.fatal = error
                return
            operator = self._mutant.operator if self._mutant is not None else ""
            self._failure = self._failure or f"{operator} cannot be {what}: {error_text(error)}"

    def failure_in(self, error: BaseException, robots: Collection[str], locator: Locator) -> str | None:
        """Return how the fault's own code failed, if it is the source of an exception; None if it is not.

        Args:
            error: the exception.
            robots: the modules of the operations that are mutated.
            locator: knows the files of the program and its tests.
        """
        fault = self._fault
        if fault is None or not fault.is_checked:
            return None
        meant = {*map(id, fault.meant)}
        for part in everything(error):
            frames = (frame for frame, _ in reversed(list(walk_tb(part.__traceback__))))
            owners = (_is_own(frame, type(fault).__module__, robots, locator) for frame in frames)
            # the nearest to the raise decides that is the fault's, the robot's, the program's or a test's
            if id(part) not in meant and next((is_own for is_own in owners if is_own is not None), False):
                return f"{fault.mutant.operator} fails at work: {error_text(part)}"
        return None

    def _made(self) -> ActiveFault:
        assert self._mutant is not None
        assert self.activation is not None
        module, _, name = self.activation.reference.partition(":")
        made: Any = getattr(import_module(module), name)(self._mutant, self.activation.data, self.context)
        if not isinstance(made, ActiveFault):
            raise TypeError(f"{self.activation.reference} is not a mutabot.runtime.active_fault.ActiveFault")
        made.keys = self.activation.keys
        return made


def _is_own(frame: FrameType, module: str, robots: Collection[str], locator: Locator) -> bool | None:
    """Return whether a frame is of the fault's code or package; None for frames that do not show it."""
    name = str(frame.f_globals.get("__name__", ""))
    if name in robots:
        return False
    if _is_within(name, module.rpartition(".")[0] or module):
        return True
    if name.startswith(_MOCKS) or any(_is_within(name, robot.partition(".")[0]) for robot in robots):
        return False
    file = file_of(frame.f_code)
    return False if locator.is_of_project(file) or locator.role(file) is not None else None


def _is_within(name: str, package: str) -> bool:
    return name == package or name.startswith(f"{package}.")


def _checked(activity: Any) -> Activity:
    if not isinstance(activity, Activity) or {type(activity.hits), type(activity.acted)} != {int}:
        raise TypeError(f"its activity is {type(activity).__name__}, not as ActiveFault keeps it")
    return activity
