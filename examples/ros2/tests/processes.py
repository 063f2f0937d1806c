"""Programs of this example, each in a process of its own."""

from __future__ import annotations

import subprocess
import sys
from contextlib import suppress
from pathlib import Path

FOLDER = Path(__file__).parents[1]


def start(program: str, *arguments: str) -> subprocess.Popen[bytes]:
    """Start a program of this folder, by the Python that runs the tests."""
    return subprocess.Popen([sys.executable, str(FOLDER / program), *arguments])


def stop(process: subprocess.Popen[bytes]) -> None:
    """Let a program end, and wait until it has. A node that is about to wait may miss that it is to end."""
    while process.poll() is None:
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(0.5)
