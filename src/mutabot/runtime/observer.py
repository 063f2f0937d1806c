"""The contract of observers of a plain run, and their set-up in each process of the run.

``execution.observation.observe`` starts the run; ``runtime.observation_plugin`` is its way into pytest.
Nothing that the program can see changes.
"""

from __future__ import annotations

import atexit
import inspect
import json
import os
import signal
import sys
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from sys import _getframe
from types import FrameType
from typing import Any

from mutabot import extensions
from mutabot.frozen import frozen
from mutabot.model import Role
from mutabot.model.codec import to_data
from mutabot.model.observation import JOB, SEEN, ObservationJob
from mutabot.model.operation import MAIN, Form
from mutabot.runtime.interception.frames import border
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.processes.environment import export_folder, write_wake
from mutabot.runtime.program_text.call_sites import NOTHING, CallSite, CallSites
from mutabot.runtime.program_text.loading import hook_script
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import NOWHERE, CallPlace, Handler, Where

#: forms of what passes under a name; all others only set something up
_PASSING = MAIN | {Form.FEEDBACK, Form.RESULT}
#: calls at a site, and reads of an attribute, that are observed
_MOST_AT_A_SITE = 3000


@frozen
class CallOrigin:
    """The position of a call in the source.

    Attributes:
        file: relative to the project, with ``/``.
        line: 1-based.
        is_test: whether the file is on the tests' side.
    """

    file: str
    line: int
    is_test: bool


class Observer(ABC):
    """The base class of observers, which watch the calls in one process of a run.

    An object is made in each process before it imports the program. What its methods raise, the program
    would meet.

    Attributes:
        libraries: top-level names of client libraries of middlewares, with ``*`` for any text; what is done
            through them comes to ``used``, under its name.
        is_test: returns of an absolute path whether it is on the tests' side (True) or the program's (False);
            None for files of neither.
    """

    def __init__(self, libraries: Sequence[str], is_test: Callable[[str], bool | None]) -> None:
        self.libraries, self.is_test = libraries, is_test

    @abstractmethod
    def called(self, name: str, found: Any, receiver: Any, caller: CallOrigin) -> Any:
        """Return what is to be called in the place of ``found``.

        Args:
            name: by which it is called, without what stands before it.
            found: what the program is about to call.
            receiver: the object whose attribute it is; None if it was read from a name.
            caller: the call.
        """

    @abstractmethod
    def read(self, name: str, found: Any, receiver: Any, caller: CallOrigin) -> None:
        """Note that the attribute ``name`` of ``receiver``, which is ``found``, was read."""

    @abstractmethod
    def assigned(self, name: str, receiver: Any, values: Sequence[Any], caller: CallOrigin) -> None:
        """Note that an attribute or an item is about to be assigned.

        Args:
            name: the attribute's, or ``__setitem__``.
            receiver: the object that has it.
            values: the new value; of an item, its key and the new value.
            caller: the assignment.
        """

    @abstractmethod
    def used(
        self, form: Form, name: str, caller: CallOrigin | None, written: Sequence[Any], *, is_callback: bool
    ) -> Callable[[Any], None] | None:
        """Note a use of a resolved name of a middleware; return a function for its messages, or None.

        Args:
            form: what.
            name: under which name.
            caller: the call, or the definition of the callback; None if it is none of the project's.
            written: the message that is sent, if any.
            is_callback: whether it came to a callback, rather than to a call that waited for it.

        Returns a function to call with the answer, or with the message that came; None if it is not wanted.
        """

    @abstractmethod
    def data(self) -> Any:
        """Return what was seen so far: a dataclass of plain values."""


class ProcessObservation:
    """The observer of this process, and the hooks that pass calls to it.

    Args:
        folder: where all processes of the run find their job and write what they saw.
    """

    def __init__(self, folder: str) -> None:
        self.folder = folder
        with open(os.path.join(folder, JOB), encoding="utf-8") as file:
            self.job = job = ObservationJob(**json.load(file))
        extensions.use(job.extensions)
        self._locator = Locator(job.root, tuple(job.program), tuple(job.tests))
        module, _, name = job.observer.partition(":")
        self.observer: Observer = getattr(import_module(module), name)(job.libraries, self._is_test)

    def install(self) -> None:
        """Observe what is imported from now on, also in processes that are started from now on."""
        _Uses(self.observer, self._locator)
        questions(self.observer, self._locator).install()
        export_folder(self.folder)

    def wake(self) -> None:
        """Make processes below the tests join the observation."""
        program, module = self.job.program, self.job.observer.partition(":")[0]
        names = {part.removesuffix(".py") for path in program for part in path.split("/")}
        files = [os.path.realpath(os.path.join(self.job.root, path)) for path in program]
        write_wake(self.folder, __name__, "", names, files, [module.partition(".")[0]])

    def write(self, name: str, **more: Any) -> None:
        """Write all observations into the file of this name, or none."""
        path = os.path.join(self.folder, f"{name}{SEEN}")
        with open(f"{path}.new", "w", encoding="utf-8", errors="surrogateescape") as file:
            json.dump({"seen": to_data(self.observer.data()), **more}, file, default=str)
        os.replace(f"{path}.new", path)

    def _is_test(self, path: str) -> bool | None:
        role = self._locator.role(path)
        return None if role is None else role is Role.ORACLE


def questions(observer: Observer, locator: Locator) -> CallSites:
    """Return call sites that report each call and each attribute read to an observer, up to a limit."""
    times: Counter[int] = Counter()

    def is_enough(site: CallSite) -> bool:
        times[site.number] += 1
        if times[site.number] <= _MOST_AT_A_SITE:
            return False
        CallSites.leave(site)  # a loop that computes must not take minutes
        return True

    @cache
    def caller_of(site: CallSite) -> CallOrigin:
        return CallOrigin(locator.relative(site.path), site.extent[0], site.role is Role.ORACLE)

    def called(site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        if is_enough(site):
            return found
        given = None if receiver is NOTHING else receiver
        return observer.called(site.name, found, given, caller_of(site))

    def read(site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        if not is_enough(site):
            observer.read(site.name, found, receiver, caller_of(site))
        return found

    def stored(site: CallSite, holder: Any, values: list[Any]) -> None:
        observer.assigned(site.name, holder, values, caller_of(site))

    return CallSites(_PublicNames(), locator.role, called, hands=read, are_read=True, stored=stored)


class _PublicNames:
    """The set of all names that are not private."""

    def __contains__(self, name: object) -> bool:
        return not str(name).startswith("_")


@border
def _carried_out(wrapped: Callable[..., Any], args: Any, kwargs: Any) -> Any:
    """Call what is used, without counting calls that it makes itself, as in a campaign."""
    return wrapped(*args, **kwargs)


class _Uses(Messages):
    """Passes uses of names on to the observer."""

    def __init__(self, observer: Observer, locator: Locator) -> None:
        self._observer, self._locator = observer, locator
        super().__init__(lambda target, finding: None)

    def find(self, form: Form, name: str, node: str | None) -> Handler | None:
        """Return what carries a use out and reports it; None for a set-up, which is reported at once."""
        observer, locator = self._observer, self._locator
        if form not in _PASSING:
            caller = _caller(locator.locate(_getframe(1)))
            observer.used(form, name, caller, (), is_callback=False)
            return None

        def handle(wrapped: Any, instance: Any, args: Any, kwargs: Any, where: Where = NOWHERE) -> Any:
            code = where.code
            place = locator.locate(_getframe(1)) if code is None else locator.locate_definition(code)
            answered = observer.used(form, name, _caller(place), args[:1], is_callback=code is not None)
            if inspect.iscoroutinefunction(wrapped):
                return _awaited(wrapped(*args, **kwargs), answered)
            result = _carried_out(wrapped, args, kwargs)
            if answered is not None:
                answered(result)
            return result

        return handle


async def _awaited(waiting: Any, answered: Callable[[Any], None] | None) -> Any:
    result = await waiting
    if answered is not None:
        answered(result)
    return result


def _caller(place: CallPlace | None) -> CallOrigin | None:
    return None if place is None else CallOrigin(place[0].file, place[0].line, place[1] is Role.ORACLE)


def join(folder: str) -> None:
    """Observe this process below the tests, which writes its observations when it ends."""
    observation = ProcessObservation(folder)
    observation.install()
    hook_script()
    leave = os._exit

    def write_all() -> None:
        observation.write(str(os.getpid()))

    def leave_at_once(status: int) -> None:
        write_all()
        leave(status)

    def end(number: int, frame: FrameType | None) -> None:
        sys.exit(128 + number)

    atexit.register(write_all)
    os._exit = leave_at_once  # type: ignore[assignment]
    if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
        signal.signal(signal.SIGTERM, end)  # else nothing would be written
