"""Programs that the project starts: its Python programs become simulated processes, others run normally.

These are the `subprocess`, `os`, `signal` and `atexit` that modules of the project see.
"""

from __future__ import annotations

import importlib.util
import os
import signal as real_signal
import subprocess as real_subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from ros_in_process.errors import NeedsRealRos
from ros_in_process.machine.imports import add_root, is_of_project, provide, second_copy
from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.processes import real_processes
from ros_in_process.processes.process import STARTED, Pipe, Process

_FLAGS_WITH_VALUE = {"-W", "-X", "--check-hash-based-pycs"}
#: where Python looks for modules before pytest adds the tests' folders
_BASE_PATH = list(sys.path)


class _Program:
    """A Python program that a command names."""

    def __init__(
        self, code: Callable[[], CodeType], file: str, argv: list[str], first_path: str, spec: Any
    ) -> None:
        self.code, self.file, self.argv, self.first_path, self.spec = code, file, argv, first_path, spec

    def run(self) -> None:
        """Run the program as `__main__`."""
        module = ModuleType("__main__")
        module.__file__ = self.file
        if self.spec is not None:
            module.__spec__, module.__package__ = self.spec, self.spec.name.rpartition(".")[0]
        sys.modules["__main__"] = module
        exec(self.code(), module.__dict__)


def _program_of(words: list[str], folder: str) -> _Program | None:
    """Return the simulated program that a command starts; None for any other program."""
    if real_processes.starts_nodes(words[0]):
        raise real_processes.refused(words)
    if real_processes.is_python(words[0]):
        rest = words[1:]
        while rest and rest[0].startswith("-") and rest[0] not in {"-m", "-c"}:
            rest = rest[2:] if rest[0] in _FLAGS_WITH_VALUE else rest[1:]
    elif words[0].endswith(".py"):
        rest = words
    else:
        return None
    if not rest:
        return None
    if rest[0] == "-m":
        return _module_program(rest[1], rest[2:])
    if rest[0] == "-c":
        code = rest[1]
        return _Program(lambda: compile(code, "<string>", "exec"), "<string>", ["-c", *rest[2:]], "", None) \
            if "rclpy" in code else None  # fmt: skip
    return _file_program(os.path.join(folder, rest[0]), rest)


def _file_program(file: str, argv: list[str]) -> _Program | None:
    if not os.path.isfile(file):
        return None
    if not is_of_project(file):
        if "rclpy" not in Path(file).read_text(errors="replace"):
            return None
        add_root(os.path.dirname(file))
    return _Program(lambda: _compiled(file), file, argv, os.path.dirname(os.path.realpath(file)), None)


def _module_program(name: str, argv: list[str]) -> _Program | None:
    try:
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.submodule_search_locations is not None:
            spec = importlib.util.find_spec(f"{name}.__main__")
    except ImportError:
        return None
    if spec is None or spec.origin is None or not is_of_project(spec.origin):
        return None
    file = spec.origin
    return _Program(lambda: _compiled(file), file, [file, *argv], os.getcwd(), spec)


def _compiled(file: str) -> CodeType:
    return COMPILE(Path(file).read_bytes(), file)


def _compile_plainly(source: bytes, file: str) -> CodeType:
    return compile(source, file, "exec", dont_inherit=True)


#: how a program's text becomes code
COMPILE: Callable[[bytes, str], CodeType] = _compile_plainly


class Popen:
    """`subprocess.Popen`, by which a program of the project becomes a simulated process."""

    def __new__(cls, args: Any, *others: Any, **options: Any) -> Any:
        words = real_processes.words_of(args)
        folder = os.fspath(options.get("cwd") or os.getcwd())
        program = None if options.get("shell") or not words else _program_of(words, folder)
        if program is None:
            return real_subprocess.Popen(args, *others, **options)
        popen = super().__new__(cls)
        popen._start(args, program, folder, options)
        return popen

    def __init__(self, *_: Any, **__: Any) -> None:
        """Do nothing: `__new__` does everything, and may make a real process."""

    def __class_getitem__(cls, item: Any) -> Any:
        return cls

    def _start(self, args: Any, program: _Program, folder: str, options: dict[str, Any]) -> None:
        self.args = args
        given: Mapping[str, str] | None = options.get("env")
        environ = os.environ if given is None else given
        encoded = {os.fsencode(key): os.fsencode(value) for key, value in environ.items()}
        extra = [entry for entry in environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
        path = [program.first_path, *extra, *_BASE_PATH]
        self.process = Process(os.path.basename(program.argv[0]), program.argv, folder, encoded, path)
        is_text = any(options.get(key) for key in ("text", "universal_newlines", "encoding", "errors"))
        self.stdin = self._stream("stdin", options.get("stdin"), is_text)
        self.stdout = self._stream("stdout", options.get("stdout"), is_text)
        self.stderr = self._stream("stderr", options.get("stderr"), is_text)
        STARTED.append(self.process)
        self.process.start(program.run)

    def _stream(self, name: str, wanted: Any, is_text: bool) -> Any:
        streams = self.process.streams
        if wanted is None:
            return None
        if wanted == real_subprocess.STDOUT:
            streams[name] = streams["stdout"]
        elif wanted == real_subprocess.PIPE:
            streams[name] = Pipe(is_text)
            return streams[name]
        elif wanted == real_subprocess.DEVNULL:
            streams[name] = open(os.devnull, "r+")  # noqa: SIM115  (the process has it)
        elif hasattr(wanted, "write"):
            streams[name] = _ProcessFile(wanted)
        else:
            raise NeedsRealRos(f"a process's {name} is given as {wanted!r}")
        return None

    @property
    def pid(self) -> int:
        return self.process.pid

    @property
    def returncode(self) -> int | None:
        return self.process.returncode

    def poll(self) -> int | None:
        SCHEDULER.poll()
        return self.process.returncode

    def wait(self, timeout: float | None = None) -> int:
        if not self.process.wait(timeout):
            raise real_subprocess.TimeoutExpired(self.args, timeout or 0)
        return self.process.returncode or 0

    def communicate(self, input: Any = None, timeout: float | None = None) -> tuple[Any, Any]:
        if input is not None and self.stdin is not None:
            self.stdin.write(input)
        if self.stdin is not None:
            self.stdin.close()
        self.wait(timeout)
        return tuple(None if pipe is None else pipe.read() for pipe in (self.stdout, self.stderr))  # type: ignore[return-value]

    def send_signal(self, signum: int) -> None:
        self.process.send_signal(signum)

    def terminate(self) -> None:
        self.send_signal(real_signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(real_signal.SIGKILL)

    def __enter__(self) -> Popen:
        return self

    def __exit__(self, *_: object) -> None:
        self.wait()


class _ProcessFile:
    """Writes text to a file that another process has opened."""

    encoding = "utf-8"

    def __init__(self, file: Any) -> None:
        self._file = file
        self._is_text = hasattr(file, "encoding")

    def write(self, text: str) -> int:
        self._file.write(text if self._is_text else text.encode())
        self._file.flush()
        return len(text)

    def flush(self) -> None:
        self._file.flush()

    def isatty(self) -> bool:
        return False


def _subprocess() -> ModuleType:
    module = second_copy("subprocess")
    for name in ("CalledProcessError", "TimeoutExpired", "SubprocessError", "CompletedProcess"):
        setattr(module, name, getattr(real_subprocess, name))
    module.Popen = Popen  # type: ignore[attr-defined]
    return module


def install() -> None:
    """Provide `subprocess` to the modules that see the simulation."""
    provide("subprocess", _subprocess)
    real_processes.install(_program_of)
