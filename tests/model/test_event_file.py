"""Files of events: what is written whole is read equal, and nothing else is ever taken for an event."""

from __future__ import annotations

import fcntl
import json
import os
import random
import resource
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mutabot.execution.processes import EventStream, Home
from mutabot.model import Span, event_file
from mutabot.model.codec import MOST_CHARACTERS, MOST_DEPTH
from mutabot.model.event_file import SESSION, SUFFIX, UNWRITTEN, EventReader, seal, sealed, unsealed
from mutabot.model.events import (
    Event,
    ForkDied,
    ForkEnded,
    ForkTestEnd,
    SessionEnd,
    SiteSeen,
    TestEnd,
    TestStart,
    TextsSeen,
    TokensHeld,
    Untrusted,
)
from mutabot.model.outcome import By
from mutabot.runtime.event_file import EventFile, json_stand_in

KEY = "0123456789abcdef"
END = TestEnd(
    "tests/t.py::test", "failed", By.CHECK, message="off by 0.25", hits=2, acted=1, probes={"arm.x": 0.25}
)
EVENTS: list[Event] = [
    TestStart("tests/t.py::test"),
    SiteSeen(0, Span("mission.py", 3, 4, 3, 20, "approach"), "robot:Arm.move_by", None, oracle=False),
    END,
    ForkTestEnd("robot/mission.py:3", END),
    TokensHeld(2),
    SessionEnd(0, ("tests/t.py::test",)),
]
NAME = "1-2"


def line_of(event: Event, number: int = 1, key: str = KEY, name: str = NAME) -> bytes:
    return sealed(event, number, name, key, json_stand_in)


def line_with(text: bytes) -> bytes:
    """A line with the right seal for whatever stands in it."""
    return b"%s 1 %s" % (seal(text, 1, NAME, KEY), text)


def through(event: Event) -> Any:
    return unsealed(line_of(event).rstrip(b"\n"), NAME, KEY)[1]


class Written:
    """A file of events in the making, and its reader."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / f"{NAME}{SUFFIX}"
        self.path.touch()
        self.reader = EventReader(str(self.path), KEY)

    def add(self, *data: bytes) -> list[Event]:
        """Write this; what is read then."""
        with self.path.open("ab") as file:
            file.write(b"".join(data))
        return self.reader.read()


@pytest.fixture
def written(tmp_path: Path) -> Written:
    return Written(tmp_path)


@pytest.mark.parametrize("event", EVENTS)
def test_an_event_comes_out_as_it_went_in(event: Event) -> None:
    assert through(event) == event


def noise(number: int) -> bytes:
    """Bytes that look more or less like a line: random ones, and lines of which something was changed."""
    chance = random.Random(number)
    if number % 2:
        return chance.randbytes(chance.randrange(1, 200)).replace(b"\n", b" ")
    data = bytearray(line_of(chance.choice(EVENTS)).rstrip(b"\n"))
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


def test_of_1000_random_texts_and_changed_lines_none_is_taken_for_an_event() -> None:
    real = {line_of(event).rstrip(b"\n") for event in EVENTS}
    for number in range(1000):
        garbage = noise(number)
        if garbage not in real:
            with pytest.raises(ValueError, match="reported something unreadable"):
                unsealed(garbage, NAME, KEY)


@pytest.mark.parametrize(
    "line", [line_of(END, key="another key"), line_of(END, name="1-3"), line_of(END).replace(b" 1 ", b" 2 ")]
)
def test_the_line_of_another_process_or_place_is_none(written: Written, line: bytes) -> None:
    (found,) = written.add(line)
    assert isinstance(found, Untrusted)
    assert "reported something unreadable" in found.reason


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
    with pytest.raises(ValueError, match="reported something unreadable"):
        unsealed(line_with(json.dumps(data).encode()), NAME, KEY)


@pytest.mark.parametrize("depth", [MOST_DEPTH + 2, 900, 100_000])
def test_json_that_is_nested_too_deeply_is_no_event(depth: int) -> None:
    text = b'{"type":"TestEnd","test":"t","outcome":"passed","trace":' + b"[" * depth + b"]" * depth + b"}"
    with pytest.raises(ValueError, match="reported something unreadable"):
        unsealed(line_with(text), NAME, KEY)


def test_an_endless_line_is_not_kept(written: Written, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(event_file, "MOST_BYTES", 100_000)
    found = [event for _ in range(15) for event in written.add(b"x" * 10_000)]
    found += written.add(b"\n", line_of(END))
    lost, event = found
    assert event == END
    assert isinstance(lost, Untrusted)
    assert "99940 more bytes" in lost.reason


def test_a_flood_of_damage_is_reported_once(written: Written) -> None:
    (found,) = written.add(b"x\n" * 100_000)
    assert isinstance(found, Untrusted)


def damaged(written: Written, *numbers: int) -> tuple[list[int], str | None]:
    """The events that are read of a file with these lines, by number, and what is said of it in the end."""
    found = written.add(*(line_of(TokensHeld(number), number) for number in numbers))
    found += written.reader.read(is_last=True)
    return [event.held for event in found if isinstance(event, TokensHeld)], written.reader.damage


@pytest.mark.parametrize(
    ("numbers", "found", "damage"),
    [
        pytest.param((1, 2, 4, 5), [1, 2, 4, 5], "what is missing in 1-2: event 3", id="one removed"),
        pytest.param((1, 5, 6), [1, 5, 6], "what is missing in 1-2: event 2 to 4", id="several removed"),
        pytest.param((2, 3), [2, 3], "what is missing in 1-2: event 1", id="the first removed"),
        pytest.param((1, 2, 2, 3), [1, 2, 3], "event 2 comes twice in 1-2", id="one twice"),
        pytest.param((1, 3, 2, 4), [1, 3, 4], "what is missing in 1-2: event 2", id="in another order"),
    ],
)
def test_a_number_that_is_missing_or_comes_twice_is_damage(
    written: Written, numbers: tuple[int, ...], found: list[int], damage: str
) -> None:
    assert damaged(written, *numbers) == (found, damage)


@pytest.mark.parametrize("kept", [1, 20, -1], ids=["a letter", "a part", "all but the line break"])
def test_a_process_killed_while_it_wrote_leaves_damage(written: Written, kept: int) -> None:
    assert written.add(line_of(EVENTS[0]), line_of(END, 2)[:kept]) == EVENTS[:1]
    assert written.reader.damage is None  # it may be writing still
    (lost,) = written.reader.read(is_last=True)
    assert isinstance(lost, Untrusted)
    assert lost.reason == "1-2 ends in the midst of event 2"


def test_a_file_that_was_shortened_is_damage(written: Written) -> None:
    written.add(line_of(EVENTS[0]))
    os.truncate(written.path, 5)
    (lost,) = written.add()
    assert lost == Untrusted("1-2 is shorter than it was")


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
        (Strange(), f"<{__name__}:Strange>"),
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
def test_what_cannot_be_reported_whole_loses_nothing_else(value: Any) -> None:
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


def test_a_process_writes_events_that_a_reader_takes(tmp_path: Path) -> None:
    file = EventFile(str(tmp_path), NAME, KEY)
    for event in EVENTS:
        file.send(event)
    assert EventReader(str(tmp_path / f"{NAME}{SUFFIX}"), KEY).read(is_last=True) == EVENTS
    file.close()


def test_a_handler_of_signals_may_write_in_the_midst_of_an_event(tmp_path: Path) -> None:
    file = EventFile(str(tmp_path), NAME, KEY)
    before = signal.signal(signal.SIGALRM, lambda *_: file.send(TokensHeld(-1)))
    signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
    try:
        for number in range(3000):
            file.send(TokensHeld(number))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    reader = EventReader(str(tmp_path / f"{NAME}{SUFFIX}"), KEY)
    found = reader.read(is_last=True)
    assert reader.damage is None
    assert len(found) > 3000
    file.close()


def test_threads_that_write_side_by_side_lose_nothing(tmp_path: Path) -> None:
    file = EventFile(str(tmp_path), NAME, KEY)

    def write() -> None:
        for number in range(200):
            file.send(TokensHeld(number))

    threads = [threading.Thread(target=write) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    reader = EventReader(str(tmp_path / f"{NAME}{SUFFIX}"), KEY)
    found = reader.read(is_last=True)
    assert reader.damage is None
    assert sorted(event.held for event in found if isinstance(event, TokensHeld)) == sorted([*range(200)] * 4)
    file.close()


def test_one_that_closes_what_it_finds_open_goes_on_in_its_file(tmp_path: Path) -> None:
    file = EventFile(str(tmp_path), NAME, KEY)
    file.send(EVENTS[0])
    os.close(file._file)
    with (tmp_path / "other").open("wb") as other:  # it gets the number
        file.send(EVENTS[1])
    assert EventReader(str(tmp_path / f"{NAME}{SUFFIX}"), KEY).read() == EVENTS[:2]
    assert Path(other.name).read_bytes() == b""
    file.close()


@contextmanager
def a_stream(folder: Path) -> Iterator[tuple[EventStream, EventFile]]:
    """The controller's side of a test process, and that process's own file."""
    home = Home(folder, KEY)
    home.processes.mkdir()
    Path(home.events(SESSION)).touch()
    stream = EventStream(home)
    file = EventFile.of_session(str(folder), KEY, os.dup(stream.writing))
    try:
        yield stream, file
    finally:
        stream.close()
        file.close()


def in_fork(file: EventFile, work: Callable[[], object], died: ForkDied | None = None) -> int:
    """Do this in a fork, as a fork parent has it done for a mutant; its exit code."""
    file.forks += 1
    pid = os.fork()
    if pid == 0:
        try:
            file.continue_separately()
            work()
            os._exit(0)
        finally:
            os._exit(1)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    file.send(ForkEnded(file.forks, code, died))
    return code


def test_what_two_forks_report_side_by_side_comes_when_each_has_ended(tmp_path: Path) -> None:
    with a_stream(tmp_path) as (stream, file):
        file.send(EVENTS[0])
        pipes = [os.pipe(), os.pipe()]
        pids = []
        for number, (reading, _) in enumerate(pipes):
            file.forks += 1
            pid = os.fork()
            if pid == 0:
                file.continue_separately()
                for count in range(5):
                    file.send(TokensHeld(10 * number + count))
                    os.read(reading, 1)  # until the other one has written, too
                os._exit(0)
            pids.append(pid)
        assert stream.read() == EVENTS[:1]
        for _ in range(5):
            for _, writing in pipes:
                os.write(writing, b".")
        for fork in (2, 1):
            os.waitpid(pids[fork - 1], 0)
            file.send(ForkEnded(fork, 0))
        first, second = ([TokensHeld(10 * number + count) for count in range(5)] for number in range(2))
        assert stream.read(is_last=True) == [*second, *first]
        for ends in pipes:
            for end in ends:
                os.close(end)


def test_a_fork_of_a_fork_is_read_with_it(tmp_path: Path) -> None:
    with a_stream(tmp_path) as (stream, file):

        def part() -> None:
            file.send(TokensHeld(1))
            in_fork(file, lambda: file.send(TokensHeld(2)))
            file.send(TokensHeld(3))

        in_fork(file, part)
        assert stream.read(is_last=True) == [TokensHeld(1), TokensHeld(2), TokensHeld(3)]
        assert [path.name for path in (tmp_path / "processes").iterdir()] == [f"{SESSION}{SUFFIX}"]


def test_a_fork_whose_events_are_damaged_is_as_if_it_had_not_run_and_touches_no_other(tmp_path: Path) -> None:
    with a_stream(tmp_path) as (stream, file):

        def torn() -> None:
            file.send(TokensHeld(1))
            os.write(file._file, b"half of an ev")

        in_fork(file, torn, ForkDied("mutant", "test", 1))
        in_fork(file, lambda: file.send(TokensHeld(2)), ForkDied("another", "test", 1))
        assert stream.read(is_last=True) == [TokensHeld(2), ForkDied("another", "test", 1)]


def test_what_is_in_the_pipe_means_nothing(tmp_path: Path) -> None:
    with a_stream(tmp_path) as (stream, file):
        assert file._bell is not None
        os.write(file._bell, line_of(END) * 10)
        assert stream.read() == []
        for _ in range(100_000):
            file._ring(file._bell)  # more than it holds
        file.send(EVENTS[0])
        assert stream.read() == EVENTS[:1]
        assert stream.read() == []


def limited(size: int) -> None:
    """Let no file of this process grow beyond so many bytes, as if the disk were full."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def test_a_process_that_cannot_write_ends_and_says_so_by_its_exit_code(tmp_path: Path) -> None:
    with a_stream(tmp_path) as (stream, file):

        def fill() -> None:
            limited(1000)
            for number in range(1000):
                file.send(TokensHeld(number))

        assert in_fork(file, fill) == UNWRITTEN
        file.send(EVENTS[0])
        assert stream.read(is_last=True) == EVENTS[:1]


def test_the_bell_takes_the_lowest_descriptor_that_is_free(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    high = fcntl.fcntl(writing, fcntl.F_DUPFD, 200)
    os.close(writing)
    file = EventFile(str(tmp_path), NAME, KEY, bell=high)
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(high)
    file.send(ForkEnded(1, 0))
    assert os.read(reading, 1)
    file.close()
    assert os.read(reading, 1) == b""  # nobody else has it open
    os.close(reading)


@pytest.mark.parametrize("name", ["write", "fstat"])
def test_functions_that_a_test_replaces_are_not_those_that_write_events(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    file = EventFile(str(tmp_path), NAME, KEY)
    with monkeypatch.context() as patch:
        patch.setattr(os, name, lambda *_: 0)
        for event in EVENTS:
            file.send(event)
    assert EventReader(str(tmp_path / f"{NAME}{SUFFIX}"), KEY).read(is_last=True) == EVENTS
    file.close()
