"""How long a suite that is only observed may take."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mutabot.execution import observation
from mutabot.execution.observation import _wait


class Used:
    """The time that the process is said to have left, at each question."""

    left: Iterator[float]

    @classmethod
    def from_now(cls) -> Used:
        return cls()

    def remaining(self, wall: float, processor: float | None, processes: Any) -> tuple[float, float | None]:
        return next(self.left), processor


@pytest.mark.parametrize(("left", "is_overdue"), [([0.01, 30.0], False), ([0.01, 0.0], True)])
def test_time_in_which_a_suite_waited_for_a_processor_is_given_to_it_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left: list[float], is_overdue: bool
) -> None:
    monkeypatch.setattr(Used, "left", iter(left), raising=False)
    monkeypatch.setattr(observation, "TimeUsed", Used)
    seconds = 60.0 if is_overdue else 0.2
    command = [sys.executable, "-c", f"import time; time.sleep({seconds})"]
    began = time.monotonic()
    assert _wait(command, tmp_path, {}, tmp_path / "log.txt", 1.0) is is_overdue
    assert time.monotonic() - began < seconds or not is_overdue
