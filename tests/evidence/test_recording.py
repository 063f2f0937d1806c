"""Recordings on their way: what is written is read back."""

from __future__ import annotations

from array import array
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from mutabot.evidence.recording import (
    Block,
    RecordedCall,
    RecordedMoment,
    Recording,
    Track,
    TrackKind,
    bytes_of,
    from_bytes,
    to_bytes,
    to_text,
)
from mutabot.model import Role

NUMBERS = some.floats(-100.0, 100.0, width=32)
NAMES = some.text(max_size=8)


@some.composite
def recordings(draw: some.DrawFn) -> Recording:
    count = draw(some.integers(0, 5))
    tracks = {}
    for name in draw(some.lists(NAMES, max_size=3, unique=True)):
        kind = draw(some.sampled_from(TrackKind))
        size = draw(some.none() | some.just((0.5, 0.25, 0.125)))
        radii = (0.5, 0.25) if kind is TrackKind.LINE else ()
        track = tracks[name] = Track(name, kind, array("f"), draw(NAMES), size, radii)
        many = count * track.width
        track.values.extend(draw(some.lists(NUMBERS, min_size=many, max_size=many)))
    told = some.builds(
        RecordedCall,
        some.none() | some.floats(0, 10),
        some.none() | some.floats(0, 10),
        NAMES,
        NAMES,
        some.none() | NAMES,
        some.dictionaries(NAMES, NUMBERS, max_size=2),
        some.just({}),
        some.sampled_from(Role),
    )
    return Recording(
        array("d", sorted(draw(some.lists(some.floats(0, 10), min_size=count, max_size=count)))),
        tracks,
        (
            Block(
                draw(NAMES),
                (0.0, 0.0, 0.0),
                (1.0, 1.0, 1.0),
                draw(some.none() | some.just((1.0, 0.0, 0.0, 1.0))),
            ),
        ),
        draw(some.lists(some.builds(RecordedMoment, some.floats(0, 10), NAMES, NAMES), max_size=2)),
        draw(some.lists(told, max_size=2)),
        draw(some.none() | some.floats(0, 10)),
        draw(some.none() | some.integers(0, 9)),
        draw(some.booleans()),
        draw(some.lists(NAMES, max_size=2)),
    )


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(recordings())
def test_what_is_written_is_read_back(recording: Recording) -> None:
    assert from_bytes(to_bytes(recording)) == recording
    assert bytes_of(to_text(recording)) == to_bytes(recording)
    assert to_text(recording).isascii()


@pytest.mark.parametrize("data", [b"", b"no recording", to_bytes(Recording())[:-4]])
def test_what_is_no_recording_is_refused(data: Any) -> None:
    with pytest.raises(ValueError, match="no recording"):
        from_bytes(data)


def test_values_that_json_does_not_know_are_described_in_words() -> None:
    odd = RecordedCall(0.0, 1.0, "arm:move", "mission.py:1", None, {"to": {1, 2}}, {})
    (read,) = from_bytes(to_bytes(Recording(calls=[odd]))).calls
    assert read.written == {"to": "{1, 2}"}
