"""Becoming a fresh interpreter, and running a program as ``python`` runs it.

The program's first frame has none below it, as in any Python process: what is left to do is called by the
interpreter while it ends, when none of our own frames is there any more. The functions that run a program and
end the process are those of the interpreter itself.
"""

from __future__ import annotations

import atexit
import collections
import ctypes
import io
import operator
import os
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from importlib.machinery import BuiltinImporter
from types import ModuleType
from typing import Any

from mutabot.border.start import Start

from .shelf import Shelf

_SIGINT = 2
#: whether the environment asks for it, which is the same for all processes
_IS_UNBUFFERED = bool(getattr(sys.stdout, "write_through", False))


def make_streams() -> None:
    """The standard streams, for the descriptors that are there now."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        stream = _stream(number, f"<{name}>", getattr(sys, name))
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def _stream(number: int, name: str, like: io.TextIOWrapper) -> Any:
    is_written = number > 0
    is_raw = _IS_UNBUFFERED and is_written
    file: Any = io.open(number, "wb" if is_written else "rb", 0 if is_raw else -1, closefd=False)  # noqa: UP020, SIM115
    raw = file if is_raw else file.raw
    raw.name = name
    by_line = not is_raw and (raw.isatty() or number == 2)
    text: Any = io.TextIOWrapper(
        file, like.encoding, like.errors, newline="\n", line_buffering=by_line, write_through=_IS_UNBUFFERED
    )
    text.mode = "w" if is_written else "r"
    return text


def set_paths(base: Sequence[str], path: str) -> None:
    """The search path of modules; ``path``: what the environment adds to the ``base``."""
    entries = [os.path.abspath(entry) for entry in path.split(os.pathsep)] if path else []
    sys.path[:] = dict.fromkeys([*entries, *base])
    for entry in list(sys.path_importer_cache):
        if entry not in base:
            del sys.path_importer_cache[entry]


def forget(shelf: Shelf) -> None:
    """What a process must not have in common with another that was forked from the same one."""
    numbers = shelf.get("numpy.random")
    if numbers is not None:
        numbers.seed()  # Python's own are drawn anew by themselves
    for name, attribute, value in (
        ("logging", "_startTime", time.time()),
        ("tempfile", "tempdir", None),
    ):
        module = shelf.get(name)
        if module is not None and hasattr(module, attribute):
            setattr(module, attribute, value)
    processes = shelf.get("multiprocessing.process")
    if processes is not None:
        key = processes.AuthenticationString(os.urandom(32))
        processes._current_process._config["authkey"] = key


def run_at_exit(start: Start, ready: Callable[[], object]) -> None:
    """Run the program as soon as the caller has left all its frames; it calls ``ready`` first."""
    script = os.fsdecode(start.subject)
    first = {"script": script, "command": "-c", "module": "-m"}[start.kind]
    sys.argv[:] = [first, *map(os.fsdecode, start.rest)]
    sys.orig_argv[:] = map(os.fsdecode, start.arguments)
    sys.executable = start.executable
    main = ModuleType("__main__")
    main.__dict__.update(__annotations__={}, __builtins__=sys.modules["builtins"], __loader__=BuiltinImporter)
    sys.modules["__main__"] = main
    # the interpreter that ends would take its threads down if it knew of any
    threads = sys.modules.pop("threading", None)
    calls: Any = operator.call
    steps: list[Callable[[], object]] = []
    steps += [partial(atexit.unregister, _consume), partial(_put_back, threads), ready, _customize]
    steps.append(lambda: steps.append(_chain(_runner(start, script))))
    atexit.register(_consume, map(calls, steps), 0)


#: consumes an iterator without a frame
_consume = collections.deque


def _chain(run: Callable[[], int]) -> Callable[[], object]:
    """Run, then end with the exit code; again without a frame while the program runs."""
    calls: Any = operator.call
    return partial(_consume, map(ctypes.pythonapi.Py_Exit, map(_exit_code, map(calls, [run]))), 0)


def _runner(start: Start, script: str) -> Callable[[], int]:
    """What runs the program, with the first entry of the search path in place."""
    python = ctypes.pythonapi
    if start.kind == "command":
        _add_first_path("")
        python.PyRun_SimpleStringFlags.argtypes = [ctypes.c_char_p, ctypes.c_void_p]
        return partial(python.PyRun_SimpleStringFlags, start.subject + b"\n", None)
    if start.kind == "module":
        _add_first_path(os.getcwd())
        return partial(_run_module, os.fsdecode(start.subject), True)
    path = _absolute(start.subject)
    if _is_claimed(os.fsdecode(path)):
        sys.path.insert(0, os.fsdecode(path))
        return partial(_run_module, "__main__", False)
    _add_first_path(os.path.dirname(os.path.realpath(script)))
    libc = ctypes.CDLL(None)
    libc.fopen.restype = ctypes.c_void_p
    file = libc.fopen(path, b"rbe")
    if not file:
        return partial(_tell_missing, path)
    run = python.PyRun_SimpleFileExFlags
    run.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_void_p]
    return partial(run, file, path, 1, None)


def _tell_missing(path: bytes) -> int:
    """The script was there a moment ago."""
    print(f"{sys.executable}: can't open file {os.fsdecode(path)!r}", file=sys.stderr)
    return 2


def _is_claimed(path: str) -> bool:
    """Whether an importer says that a script is its business."""
    for hook in sys.path_hooks:
        try:
            return hook(path) is not None
        except ImportError:
            continue
    return False


def _absolute(path: bytes) -> bytes:
    """The path as the interpreter makes it: it does not tidy it up."""
    return path if path[:1] == b"/" else os.path.join(os.getcwdb(), path)


def _run_module(name: str, changes_arguments: bool) -> int:
    """``python -m``: 0 if it ran to its end, else -1."""
    import runpy  # noqa: PLC0415  # only now, as python does

    run: Any = runpy
    try:
        run._run_module_as_main(name, changes_arguments)
    except SystemExit as error:
        ctypes.pythonapi.Py_Exit(_code_of(error))
    except BaseException as error:  # it is what ends the process
        trace = error.__traceback__.tb_next if error.__traceback__ is not None else None
        error.__traceback__ = trace
        sys.last_type, sys.last_value, sys.last_traceback = type(error), error, trace
        if sys.version_info >= (3, 12):
            sys.last_exc = error
        sys.excepthook(type(error), error, trace)
        return -1
    return 0


def _code_of(error: SystemExit) -> int:
    """The exit code that an exit asks for; what is no number is printed."""
    if error.code is None or isinstance(error.code, int):
        return (error.code or 0) & 0xFFFFFFFF
    print(error.code, file=sys.stderr, flush=True)
    return 1


def _exit_code(result: int) -> int:
    """The exit code of a program that ran to its end; one that was interrupted dies of the signal."""
    if result >= 0:
        return result
    if getattr(sys, "last_type", None) is not KeyboardInterrupt:
        return 1
    libc = ctypes.CDLL(None)
    libc.on_exit(ctypes.cast(getattr(libc, "raise"), ctypes.c_void_p), None)  # raise(2), once all is done
    return _SIGINT


def _put_back(threads: ModuleType | None) -> None:
    if threads is not None:
        sys.modules["threading"] = threads


def _customize() -> None:
    """What ``site`` runs at last."""
    site: Any = sys.modules.get("site")
    if site is None:
        return
    site.execsitecustomize()
    if site.ENABLE_USER_SITE:
        site.execusercustomize()


def _add_first_path(entry: str) -> None:
    if not sys.flags.safe_path:
        sys.path.insert(0, entry)
