"""Lines on a pipe: what is written whole is read equal, and nothing else is ever taken for a line."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from mutabot.border import frame
from mutabot.border.frame import framed, unframed
from mutabot.border.lines import (
    BranchEnd,
    Line,
    SessionEnd,
    SiteSeen,
    TestStart,
    TextsSeen,
    TokensHeld,
    Untrusted,
)
from mutabot.border.storable import MOST_CHARACTERS, MOST_DEPTH
from mutabot.border.test_end import TestEnd
from mutabot.campaign.workers.processes import LineReader
from mutabot.inside.pipe import Pipe, plain
from mutabot.model import Span
from mutabot.model.verdict import By

KEY = "0123456789abcdef"
END = TestEnd(
    "tests/t.py::test", "failed", By.CHECK, message="off by 0.25", hits=2, acted=1, probes={"arm.x": 0.25}
)
LINES: list[Line] = [
    TestStart("tests/t.py::test"),
    SiteSeen(0, Span("mission.py", 3, 4, 3, 20, "approach"), "robot:Arm.move_by", None, oracle=False),
    END,
    BranchEnd("robot/mission.py:3", END),
    TokensHeld(2),
    SessionEnd(0, ("tests/t.py::test",)),
]


@contextmanager
def a_pipe() -> Iterator[tuple[LineReader, int]]:
    reading, writing = os.pipe()
    try:
        yield LineReader(reading, KEY), writing
    finally:
        os.close(reading)
        os.close(writing)


def text_of(line: Line) -> bytes:
    return framed(line, KEY, plain).strip(b"\n")


def through(line: Line) -> Any:
    return unframed(text_of(line), KEY)


@pytest.mark.parametrize("line", LINES)
def test_a_line_comes_out_as_it_went_in(line: Line) -> None:
    assert through(line) == line


def noise(number: int) -> bytes:
    """Bytes that look more or less like a line: random ones, and lines of which something was changed."""
    chance = random.Random(number)
    if number % 2:
        return chance.randbytes(chance.randrange(200)).replace(b"\n", b" ")
    data = bytearray(text_of(chance.choice(LINES)))
    for _ in range(chance.randrange(1, 4)):
        place = chance.randrange(len(data))
        match chance.randrange(4):
            case 0:
                data[place] ^= 1 << chance.randrange(8)
            case 1:
                del data[place]
            case 2:
                data[place:place] = chance.randbytes(3)
            case _:
                del data[place:]
        if not data:
            break
    return bytes(data).replace(b"\n", b" ")


def test_of_1000_random_texts_and_changed_lines_none_is_taken_for_a_line() -> None:
    real = {text_of(line) for line in LINES}
    with a_pipe() as (reader, writing):
        for number in range(1000):
            garbage = noise(number)
            # the sender's line break ends whatever was written before
            os.write(writing, garbage + framed(TestStart(str(number)), KEY, plain))
            lines = reader.read()
            assert lines[-1] == TestStart(str(number))
            if garbage and garbage not in real:
                assert [type(line) for line in lines] == [Untrusted, TestStart], garbage
                assert "reported something unreadable" in lines[0].reason  # type: ignore[union-attr]


def test_the_line_of_another_process_is_none() -> None:
    assert isinstance(unframed(framed(END, "another key", plain).strip(b"\n"), KEY), Untrusted)


@pytest.mark.parametrize(
    "data",
    [
        [],
        "TestEnd",
        {"type": "Gossip"},
        {"type": ["TestEnd"]},
        {"type": "TestEnd"},
        {"type": "TestEnd", "test": 5, "outcome": "passed"},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "hits": "many"},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "trace": "abc"},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "probes": [1]},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "by": "magic"},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "wall": 1 << 2000},
        {"type": "TestEnd", "test": "t", "outcome": "passed", "unknown": 1},
        {"type": "SiteSeen", "index": 0, "span": ["mission.py"], "operation": "x", "oracle": False},
        {"type": "TokensHeld", "held": True},
    ],
)
def test_a_line_of_the_wrong_shape_is_none_although_its_seal_is_right(data: Any) -> None:
    text = json.dumps(data).encode()
    assert isinstance(unframed(frame._seal(text, KEY) + b" " + text, KEY), Untrusted)


@pytest.mark.parametrize("depth", [MOST_DEPTH + 2, 900, 100_000])
def test_json_that_is_nested_too_deeply_is_no_line(depth: int) -> None:
    text = b'{"type":"TestEnd","test":"t","outcome":"passed","trace":' + b"[" * depth + b"]" * depth + b"}"
    assert isinstance(unframed(frame._seal(text, KEY) + b" " + text, KEY), Untrusted)


def test_a_line_break_in_the_midst_of_a_line_loses_no_other() -> None:
    first, second = text_of(LINES[0]), framed(LINES[1], KEY, plain)
    with a_pipe() as (reader, writing):
        os.write(writing, first[:20] + b"\n" + first[20:] + second)
        assert [type(line) for line in reader.read()] == [Untrusted, SiteSeen]


def test_an_endless_line_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mutabot.campaign.workers.processes.MOST_BYTES", 100_000)
    with a_pipe() as (reader, writing):
        found: list[Line] = []
        for _ in range(50):
            os.write(writing, b"x" * 10_000)
            found += reader.read()
        assert found == []
        assert sum(map(len, reader._parts)) <= 100_000
        os.write(writing, framed(END, KEY, plain))
        lost, line = reader.read()
        assert line == END
        assert isinstance(lost, Untrusted)
        assert "499940 more bytes" in lost.reason


def test_a_flood_of_lines_is_told_once_and_leaves_time_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mutabot.campaign.workers.processes._AT_ONCE", 1 << 16)
    with a_pipe() as (reader, writing):
        os.set_blocking(writing, False)
        read = os.read

        def read_beside_a_writer(*arguments: Any) -> bytes:
            os.write(writing, b"x\n" * 1000)
            return read(*arguments)

        monkeypatch.setattr(os, "read", read_beside_a_writer)
        assert 1 <= len(reader.read()) < 100


def test_a_pipe_that_nobody_can_write_to_is_over() -> None:
    reading, writing = os.pipe()
    reader = LineReader(reading, KEY)
    try:
        assert not reader.read()
        assert not reader.is_over
        os.close(writing)
        assert not reader.read()
        assert reader.is_over
    finally:
        os.close(reading)


class Strange:
    """What JSON does not know."""

    def __repr__(self) -> str:
        return "<strange \udcff>"


ITSELF: list[Any] = []
ITSELF.append(ITSELF)
DEEP: Any = 0
for _ in range(5000):
    DEEP = [DEEP]


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("off by \udcff", "off by \\udcff"),
        ("\ud83d\ude00", "\\ud83d\\ude00"),
        ("😀 is a character", "😀 is a character"),
        ("NUL \0", "NUL \0"),
        ({"\udcff": 1, "\\udcff": 2}, {"\\udcff": 1, "\\udcff'": 2}),
        (10**3000, 10**3000),
        (10**6000, f"{10**6000:#x}"),
        (-(10**6000), f"{-(10**6000):#x}"),
        (b"\xff", "\\xff"),
        (Strange(), "<strange \\udcff>"),
        (float("inf"), float("inf")),
        (2**70, 2**70),
    ],
    ids=lambda value: type(value).__name__,
)
def test_whatever_a_test_says_arrives_and_can_be_stored(value: Any, told: Any) -> None:
    found = through(replace(END, example=(value, 1)))
    assert found == replace(END, example=(told, 1))
    json.dumps(found.example, ensure_ascii=False).encode()


@pytest.mark.parametrize("value", [ITSELF, DEEP, float("nan")], ids=["itself", "deep", "nan"])
def test_what_cannot_be_told_whole_loses_nothing_else(value: Any) -> None:
    found = through(replace(END, example=(value, 1)))
    assert isinstance(found, TestEnd)
    assert replace(found, example=None) == END


def test_an_endless_text_is_cut_and_that_is_said() -> None:
    found = through(replace(END, message="no! " * 25_000_000))
    assert found.message.endswith("… (cut: it has 100000000 characters)")
    assert len(found.message) < MOST_CHARACTERS + 100
    assert replace(found, message=END.message) == END


def test_a_long_recording_is_not_cut() -> None:
    recording = "A" * (2 * MOST_CHARACTERS)
    found = through(replace(END, recording=recording, message="\udcff"))
    assert found == replace(END, recording=recording, message="\\udcff")


def test_many_sightings_are_not_taken_for_deep_ones() -> None:
    line = TextsSeen(tuple(f"file{number}[{{.py" for number in range(1000)), ())
    assert through(line) == line


def test_a_pipe_writes_lines_that_its_reader_takes() -> None:
    with a_pipe() as (reader, writing):
        pipe = Pipe(writing, KEY)
        for line in LINES:
            pipe.send(line)
        assert reader.read() == LINES
