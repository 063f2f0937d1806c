"""Simulated processes: nodes that tests start run in this process, with their own modules and arguments.

When a thread of another process goes on, what belongs to a process is changed: its modules of the project,
its arguments, environment and folder, its output, and the globals of rclpy. All other modules are shared.
"""

from __future__ import annotations

import io
import os
import signal
import sys
import traceback
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from typing import Any

from ros_in_process.errors import NeedsRealRos
from ros_in_process.machine.imports import is_decided, is_of_project, simulated_module
from ros_in_process.machine.scheduler import SCHEDULER, SECOND, SimulatedThread
from ros_in_process.middleware import signals
from ros_in_process.middleware.graph import WORLD, Destroyable, Participant

#: globals of rclpy that each process has of its own, with what they are at first
_GLOBALS: list[tuple[str, str, Any]] = [
    ("rclpy.utilities", "g_default_context", None),
    ("rclpy", "__executor", None),
    ("rclpy.context", "g_logging_ref_count", 0),
]
#: after which time others notice that a killed process is gone (ns), as with Fast DDS
_LEASE = 20 * SECOND
_pids = count(1_000_001)


class Process:
    """The state of one simulated process."""

    def __init__(
        self, name: str, argv: list[str], folder: str, environ: dict[bytes, bytes], path: list[str]
    ) -> None:
        self.name = name
        self.pid = next(_pids)
        self.argv, self.folder, self.environ, self.path = argv, folder, environ, path
        self.modules: dict[str, Any] = {}
        self.globals: dict[tuple[str, str], Any] = {(module, name): first for module, name, first in _GLOBALS}
        self.contexts: list[Participant] = []
        self.handlers: dict[int, Any] = {}
        self.at_exit: list[Callable[[], object]] = []
        self.streams: dict[str, Any] = {}  # of `sys`, those that are not its parent's
        self.main_task: SimulatedThread | None = None
        self.main_thread: Any = None
        self.returncode: int | None = None
        self.parent: Process | None = None
        self._run: Callable[[], object] | None = None
        self._waiting: list[SimulatedThread] = []
        self._number_of_modules = 0
        self._outer_streams: dict[str, Any] = {}

    def __repr__(self) -> str:
        return f"<process {self.pid} {self.name}>"

    # --- being the one that runs ---

    def enter(self) -> None:
        """Make this process's state current."""
        sys.modules.update(self.modules)
        self._number_of_modules = len(sys.modules)
        sys.argv, sys.path = self.argv, self.path
        os.environ._data = self.environ  # type: ignore[attr-defined]  # others hold on to os.environ itself
        if os.getcwd() != self.folder:
            os.chdir(self.folder)
        for (module, name), value in self.globals.items():
            if module in sys.modules:
                setattr(sys.modules[module], name, value)
        for name, stream in self.streams.items():
            self._outer_streams[name] = getattr(sys, name)
            setattr(sys, name, stream)

    def leave(self) -> None:
        """Save this process's state, and remove it."""
        if len(sys.modules) != self._number_of_modules:
            self.modules = {
                name: module for name, module in list(sys.modules.items()) if _is_own(name, module)
            }
        for name in self.modules:
            sys.modules.pop(name, None)
        self.argv, self.path = sys.argv, sys.path
        self.environ = os.environ._data  # type: ignore[attr-defined]
        self.folder = os.getcwd()
        for module, name in self.globals:
            if module in sys.modules:
                self.globals[module, name] = getattr(sys.modules[module], name, None)
        for name, stream in self._outer_streams.items():
            setattr(sys, name, stream)
        self._outer_streams.clear()

    # --- its life ---

    def start(self, run: Callable[[], object]) -> None:
        """Start its main thread, which runs when the schedule chooses it."""
        self.parent = self.parent or current()
        self._run = run
        self.main_task = SCHEDULER.spawn(lambda: self._live(run), self)

    def _live(self, run: Callable[[], object]) -> None:
        threading = simulated_module("threading")
        self.main_thread = threading._DummyThread()
        self.main_thread._name = "MainThread"
        status = self._status_of(run)
        for thread in threading.enumerate():
            is_own = getattr(thread, "process", None) is self
            if is_own and not thread.daemon:
                thread.join()
        for function in reversed(self.at_exit):
            self._status_of(function)
        self.finish(status)

    @staticmethod
    def _status_of(run: Callable[[], object]) -> int:
        try:
            run()
        except SystemExit as error:
            if error.code is None or isinstance(error.code, int):
                return error.code or 0
            print(error.code, file=sys.stderr)
            return 1
        except KeyboardInterrupt:
            traceback.print_exc()
            return -signal.SIGINT
        except BaseException:  # whatever it is, it ends the process
            traceback.print_exc()
            return 1
        return 0

    def finish(self, status: int) -> None:
        """End in an orderly way: others see at once that its nodes are gone."""
        for context in self.contexts:
            context.close()
        self._end(status)
        _remove_from_graph(self.contexts)

    def kill(self, signum: int) -> None:
        """End at once: others see that its nodes are gone when their leases expire."""
        self._leave_graph_later()
        self._end(-signum)

    def _leave_graph_later(self) -> None:
        contexts = tuple(self.contexts)
        for end in WORLD.ends:
            if end.node.context in contexts and end.role == "publisher":
                lease = min(getattr(end.profile, "lease", _LEASE), _LEASE)
                SCHEDULER.call_at(SCHEDULER.now + lease, end.lose_liveliness)  # type: ignore[attr-defined]
        SCHEDULER.call_at(SCHEDULER.now + _LEASE, partial(_remove_from_graph, contexts))

    def end_from_thread(self, anew: bool) -> None:
        """Kill the process from one of its threads; with `anew`, restart it with the same process id."""
        if not anew or self._run is None:
            self.kill(signal.SIGKILL)
        else:
            self._leave_graph_later()
            signals.forget(self)
            SCHEDULER.drop_process(self)
            self.contexts, self.at_exit, self.handlers = [], [], {}
            for name in [name for name, module in list(sys.modules.items()) if _is_own(name, module)]:
                del sys.modules[name]
            self.globals = {(module, name): first for module, name, first in _GLOBALS}
            for (module, name), value in self.globals.items():
                if module in sys.modules:
                    setattr(sys.modules[module], name, value)
            self.start(self._run)
        SCHEDULER.end_thread()

    def _end(self, status: int) -> None:
        self.returncode = status
        signals.forget(self)
        for stream in self.streams.values():
            if isinstance(stream, Pipe):
                stream.close()
        for task in self._waiting:
            SCHEDULER.wake(task)
        if self.parent is not None:
            self.parent.send_signal(signal.SIGCHLD)
        SCHEDULER.drop_process(self)

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until it has ended, for at most `timeout` seconds; return False if it has not."""
        end = None if timeout is None else SCHEDULER.now + round(timeout * SECOND)
        task = SCHEDULER.current
        self._waiting.append(task)
        try:
            while self.returncode is None and (end is None or SCHEDULER.now < end):
                SCHEDULER.park(end, f"waits for the end of {self.name}")
        finally:
            self._waiting.remove(task)
        return self.returncode is not None

    # --- signals ---

    def send_signal(self, signum: int) -> None:
        """Send a signal."""
        if self.returncode is not None:
            return
        signum = int(signum)
        if signum in {signal.SIGSTOP, signal.SIGCONT, signal.SIGTSTP}:
            raise NeedsRealRos("a process is stopped and continued by signals")
        handler = self.handlers.get(signum, signal.SIG_DFL)
        has_handler = signals.handles(self, signum)
        if has_handler:
            signals.shut_down(self)
        if handler is signal.SIG_IGN or signum == 0:
            return
        if callable(handler) and self.main_task is not None:
            SCHEDULER.run_in(self.main_task, lambda: handler(signum, None))
        elif signum == signal.SIGINT and self.main_task is not None:
            SCHEDULER.interrupt(self.main_task, KeyboardInterrupt())
        elif not has_handler and signum != signal.SIGCHLD:
            self.kill(signum)


class Pipe(io.RawIOBase):
    """A pipe between two processes, whose reader waits in simulated time."""

    def __init__(self, is_text: bool) -> None:
        super().__init__()
        self._is_text = is_text
        self._data = bytearray()
        self._is_ended = False
        self._waiting: list[SimulatedThread] = []

    encoding = "utf-8"
    errors = "replace"

    def isatty(self) -> bool:
        return False

    def write(self, data: Any) -> int:
        self._data += data.encode() if isinstance(data, str) else bytes(data)
        self._wake()
        return len(data)

    @property
    def buffer(self) -> Any:
        return self

    def close(self) -> None:
        self._is_ended = True
        self._wake()

    def _wake(self) -> None:
        for task in self._waiting:
            SCHEDULER.wake(task)

    def _wait_for(self, is_there: Callable[[], bool]) -> None:
        task = SCHEDULER.current
        self._waiting.append(task)
        try:
            while not is_there() and not self._is_ended:
                SCHEDULER.park(None, "waits for a process's output")
        finally:
            self._waiting.remove(task)

    def _taken(self, size: int) -> Any:
        taken = bytes(self._data[:size])
        del self._data[:size]
        return taken.decode(errors="replace") if self._is_text else taken

    def read(self, size: int | None = -1) -> Any:
        wanted = -1 if size is None else size
        self._wait_for(lambda: 0 <= wanted <= len(self._data))
        return self._taken(len(self._data) if wanted < 0 else wanted)

    def readline(self, size: int | None = -1) -> Any:
        self._wait_for(lambda: b"\n" in self._data)
        end = self._data.find(b"\n")
        return self._taken(len(self._data) if end < 0 else end + 1)

    def __iter__(self) -> Any:
        return iter(self.readline, "" if self._is_text else b"")

    def readlines(self, hint: int = -1) -> Any:
        return list(self)


def _remove_from_graph(contexts: Sequence[Participant]) -> None:
    handles: list[Any] = [*WORLD.ends, *WORLD.nodes]
    for handle in handles:
        if getattr(handle, "node", handle).context in contexts and not handle.is_destroyed:
            handle.is_destroyed = True
            Destroyable.destroyed += 1
            handle._release()


def current() -> Process:
    """Return the process of the running thread."""
    return _of(SCHEDULER.current)


def _of(thread: SimulatedThread) -> Process:
    return thread.process if isinstance(thread.process, Process) else MAIN


def end_of_current() -> Callable[[bool], object] | None:
    """Return a function that ends the process of the running thread; None for the tests' process."""
    process = current()
    return None if process is MAIN else process.end_from_thread


def _is_own(name: str, module: Any) -> bool:
    if name == "__main__":
        return True
    if is_decided(name):  # a package may be checked out below a root
        return False
    file = getattr(module, "__file__", None)
    return isinstance(file, str) and is_of_project(file)


def _change(old: SimulatedThread, new: SimulatedThread) -> None:
    if old.process is not new.process:
        _of(old).leave()
        _of(new).enter()


#: the process of the tests
MAIN = Process("the tests", sys.argv, os.getcwd(), os.environ._data, sys.path)  # type: ignore[attr-defined]
MAIN.pid = os.getpid()


def process_of(pid: int) -> Process | None:
    """Return the simulated process with an id; None if there is none."""
    return next((process for process in STARTED if process.pid == pid), None)


#: all that were started, the ended ones too
STARTED: list[Process] = [MAIN]


def install() -> None:
    """Make the running thread the main thread of the tests' process."""
    MAIN.main_task = SCHEDULER.main
    SCHEDULER.main.process = MAIN
    MAIN.enter()
    SCHEDULER.on_switch.append(_change)
