"""An interpreter that has imported what pytest and our plug-in import before they read anything of a project.

It forks processes of campaigns, which are children of the process that began this one: ``forked_processes``.
"""

from __future__ import annotations

import ctypes
import json
import os
import runpy
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from _pytest.assertion.rewrite import AssertionRewritingHook
from _pytest.config import default_plugins

from mutabot.frozen import compile_all
from mutabot.model.job import JOB_VARIABLE
from mutabot.operators.registry import preload
from mutabot.runtime.interception import call_faults

#: bytes of a request at most
MESSAGE_BYTES = 1 << 17
#: <linux/sched.h>; the number of this system call is that on all architectures
_CLONE3, _CLONE_PARENT = 435, 0x00008000


def serve(descriptor: int, controller: int) -> None:
    """Fork for each request, until there can be none; return in no fork."""
    _import_ahead()
    with socket.socket(fileno=descriptor) as requests:
        while True:
            message, descriptors, _, _ = socket.recv_fds(requests, MESSAGE_BYTES, 8)
            if not message:
                return
            command, folder, env, numbers = json.loads(message)
            pid = _fork_beside()
            if pid == 0:
                requests.close()
                # a process may lock what it has open: not even /dev/null is opened once for several
                _place([os.open(os.devnull, os.O_RDWR), *descriptors], [0, 1, *numbers])
                os.setsid()
                os.chdir(folder)
                _find_packages(os.environ.get("PYTHONPATH", ""), env.get("PYTHONPATH", ""))
                os.environ.clear()
                os.environ.update(env)
                _run(command, controller)
            requests.send(str(pid).encode())
            for number in descriptors:
                os.close(number)


def _import_ahead() -> None:
    """Import what every process of a campaign does, but for the plug-in, which acts when it is imported."""
    for name in default_plugins:
        import_module(f"_pytest.{name}")
    for name in ("plugins", "session_hooks", "isolation.collector", "isolation.fork_server"):
        import_module(f"mutabot.runtime.{name}")
    for name in ("evidence.recorder", "languages.python"):
        import_module(f"mutabot.{name}")
    preload()
    compile_all()
    warn = AssertionRewritingHook._warn_already_imported

    def warn_of_others(self: AssertionRewritingHook, name: str) -> None:
        if name != "mutabot":
            warn(self, name)

    AssertionRewritingHook._warn_already_imported = warn_of_others  # type: ignore[method-assign]


def _know_the_process() -> None:
    """Let what is imported know of this process what it would know if it were imported here."""
    now = time.time_ns()
    for name, module in list(sys.modules.items()):
        if name.startswith("mutabot.runtime.") and hasattr(module, "BEGAN"):
            module.BEGAN = now  # type: ignore[attr-defined]
    call_faults._FOLDER = str(Path.cwd())


def _find_packages(before: str, now: str) -> None:
    """Find packages in the places of ``PYTHONPATH`` as it is now."""
    gone, come = ([place for place in places.split(os.pathsep) if place] for places in (before, now))
    sys.path[1 : 1 + len(gone)] = [str(Path(place).absolute()) for place in come]


def _fork_beside() -> int:
    """Fork a process with the parent of this one. Return 0 in it, as ``os.fork`` does."""
    arguments = (ctypes.c_uint64 * 11)(_CLONE_PARENT)
    libc = ctypes.PyDLL(None, use_errno=True)
    ctypes.pythonapi.PyOS_BeforeFork()
    found: int = libc.syscall(_CLONE3, arguments, ctypes.sizeof(arguments))
    (ctypes.pythonapi.PyOS_AfterFork_Child if found == 0 else ctypes.pythonapi.PyOS_AfterFork_Parent)()
    if found < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return found


def _place(descriptors: Sequence[int], numbers: Sequence[int]) -> None:
    """Give these open files these numbers, and close all others."""
    above = max(*numbers, *descriptors) + 1
    for index, descriptor in enumerate(descriptors):
        os.dup2(descriptor, above + index)
    for index, number in enumerate(numbers):
        os.dup2(above + index, number, inheritable=True)
    os.dup2(1, 2)
    for number in [int(file.name) for file in Path("/proc/self/fd").iterdir()]:
        if number not in (2, *numbers):
            with suppress(OSError):  # that of the listing
                os.close(number)


def _run(command: Sequence[str], controller: int) -> None:
    """Do what the interpreters of this command line would do: the supervisor, and pytest below it."""
    at = command.index("-m")
    supervisor = runpy.run_path(command[3])
    supervisor["supervise"](str(Path(os.environ[JOB_VARIABLE]).parents[1]), controller)
    os.setsid()
    sys.orig_argv[:] = command[at - 1 :]
    sys.argv[:] = ["-m", *command[at + 2 :]]
    sys.path[0] = str(Path.cwd())
    vars(sys.modules["__main__"]).pop("runpy", None)
    _know_the_process()
    runpy._run_module_as_main(command[at + 1])  # type: ignore[attr-defined]  # as `python -m` does
