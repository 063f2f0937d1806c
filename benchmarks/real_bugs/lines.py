"""A plug-in of pytest that writes which lines of the program each test reaches, in all of its threads.

The file is the one that the variable ``RECORD`` of the environment names: JSON, lines by node id.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

RECORD = "MUTABOT_LINES"
PROGRAM = "program.py"
_reached: dict[str, list[int]] = {}


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Watch a test, with its fixtures."""
    program = str(item.config.rootpath / PROGRAM)
    found: set[int] = set()

    def look(frame: FrameType, event: str, _: Any) -> Any:
        if frame.f_code.co_filename != program:
            return None
        if event == "line":
            found.add(frame.f_lineno)
        return look

    sys.settrace(look)
    threading.settrace(look)
    try:
        return (yield)
    finally:
        sys.settrace(None)
        threading.settrace(None)
        _reached[item.nodeid] = sorted(found)


def pytest_sessionfinish() -> None:
    """Write what was seen."""
    Path(os.environ[RECORD]).write_text(json.dumps(_reached), encoding="utf-8")
