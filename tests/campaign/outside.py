"""Somebody outside of a campaign who kills a process of its tests."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest


@contextlib.contextmanager
def killer() -> Iterator[None]:
    """Kill the process that writes its number to the file that ``VICTIM`` in the environment names."""
    victim = Path(f"/var/tmp/mutabot-victim-{uuid.uuid4()}")  # a folder that no run keeps to itself
    is_over = threading.Event()

    def kill() -> None:
        while not is_over.wait(0.05):
            if victim.exists() and (pid := victim.read_text()):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(int(pid), signal.SIGKILL)
                victim.unlink()

    thread = threading.Thread(target=kill)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VICTIM", str(victim))
        thread.start()
        try:
            yield
        finally:
            is_over.set()
            thread.join()
            victim.unlink(missing_ok=True)
