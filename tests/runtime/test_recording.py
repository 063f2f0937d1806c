"""The recording of a test that makes calls: whatever their values are, the test goes on."""

from __future__ import annotations

from contextlib import nullcontext
from typing import Any

import pytest

from mutabot.evidence.recording import RecordedCall, bytes_of, from_bytes
from mutabot.model import Role
from mutabot.runtime.observation.probes import TestRecording


def endless() -> dict[str, Any]:
    found: dict[str, Any] = {}
    found["self"] = found
    return found


@pytest.mark.parametrize("value", [{(1, 2): 3}, endless()], ids=["keys that are no texts", "in a circle"])
def test_values_that_cannot_be_written_cost_the_calls_alone(value: Any) -> None:
    recording = TestRecording(lambda: 1.0, nullcontext, True)
    recording.start("tests/test_it.py::test_it", is_wanted=True)
    recording.note_fault(1, 0.5)
    recording.stop()
    text = recording.text(
        [RecordedCall(0.0, 1.0, "arm:move", "m.py:1", None, {"to": value}, {}, Role.PROGRAM)]
    )
    assert text is not None
    found = from_bytes(bytes_of(text))
    assert (found.calls, found.fault) == ([], 0.5)
    assert found.problems[0].startswith("the calls of a test cannot be recorded: ")
