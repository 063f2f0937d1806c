"""The process that checks the hardware's health and brings it into its safe state.

The controller imports nothing of the user's: it starts this module as a program, in the project's folder, and
asks it by lines of JSON, ``{"call": "module:function"}``. The answer is ``{}``, or ``{"error": text}``.
"""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any, Self

from mutabot.api.reports import UsageError

#: seconds that the process may take to begin, with the imports of the user's module
STARTUP = 30.0


class Attendant:
    """The controller's side of the process; use as a context manager.

    Args:
        root: the project's folder.
    """

    def __init__(self, root: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "mutabot_hardware.attendant"],
            cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
        self._waiting = selectors.DefaultSelector()
        assert self._process.stdout is not None
        self._waiting.register(self._process.stdout, selectors.EVENT_READ)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        self._waiting.close()

    def call(self, function: str, seconds: float) -> str | None:
        """Call a function; return a description of what went wrong, None if nothing did."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        try:
            stdin.write(json.dumps({"call": function}).encode() + b"\n")
            stdin.flush()
        except OSError:
            return f"{function}: the process that calls it has ended with code {self._process.poll()}"
        until = time.monotonic() + seconds
        line = b""
        while not line.endswith(b"\n"):
            if not self._waiting.select(max(0.0, until - time.monotonic())):
                self._process.kill()  # what answers late would answer the next question
                return f"{function} has not returned within {seconds:g} s"
            part = os.read(stdout.fileno(), 1 << 16)
            if not part:
                return f"{function}: the process that calls it has ended with code {self._process.wait()}"
            line += part
        answer = json.loads(line)
        return f"{function} raises {answer['error']}" if answer else None

    def check(self, functions: tuple[str, ...]) -> None:
        """Raise UsageError unless these functions exist."""
        for function in functions:
            if why := self.call(f"?{function}", STARTUP):
                raise UsageError(f"hardware: {why.replace('?', '', 1)}")


def _answer(asked: str) -> dict[str, Any]:
    try:
        module, _, name = asked.removeprefix("?").partition(":")
        found: Any = import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
        if not asked.startswith("?"):
            found()
        elif not callable(found):
            return {"error": f"TypeError: {asked.removeprefix('?')} is not a function"}
    except BaseException as error:  # the user's function may raise anything
        return {"error": f"{type(error).__name__}: {error}"}
    return {}


def main() -> None:
    """Answer requests until the controller has ended."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what the functions print is no answer
    sys.path.insert(0, str(Path.cwd()))
    for line in sys.stdin:
        print(json.dumps(_answer(json.loads(line)["call"])), file=answers, flush=True)


if __name__ == "__main__":
    main()
