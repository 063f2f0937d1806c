"""Memory that processes share."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from mutabot import shared_memory
from mutabot.runtime.session_hooks import _tests_us
from mutabot.shared_memory import SharedMemory


def key(number: int) -> bytes:
    return number.to_bytes(8, "little").ljust(SharedMemory.key_size, b"k")


def test_what_was_put_is_there() -> None:
    memory = SharedMemory()
    memory.put(key(1), b"one")
    memory.put(key(2), b"")
    assert (memory.get(key(1)), memory.get(key(2)), memory.get(key(3))) == (b"one", b"", None)


def test_a_key_that_falls_on_the_place_of_another_finds_nothing() -> None:
    memory = SharedMemory()
    memory.put(key(1), b"one")
    other = key(1)[:8] + b"another!"
    assert memory.get(other) is None


def test_the_oldest_make_room() -> None:
    memory, value = SharedMemory(), bytes(1 << 20)
    for number in range(200):
        memory.put(key(number), value)
    found = [number for number in range(200) if memory.get(key(number)) is not None]
    assert found == list(range(found[0], 200))
    assert 50 < len(found) < 64


def test_what_is_longer_than_the_memory_is_not_kept() -> None:
    memory = SharedMemory()
    memory.put(key(1), b"one")
    memory.put(key(2), bytes(1 << 27))
    assert (memory.get(key(1)), memory.get(key(2))) == (b"one", None)


def test_a_value_that_is_incomplete_is_not_given() -> None:
    """Two processes may write to the same place at once."""
    memory = SharedMemory()
    memory.put(key(1), b"a" * 1000)
    place = memory._bytes.find(b"a" * 1000)
    memory._bytes[place + 500 : place + 1000] = b"b" * 500
    assert memory.get(key(1)) is None


def test_a_length_that_is_wrong_is_no_error() -> None:
    memory = SharedMemory()
    memory.put(key(1), b"a" * 1000)
    place = memory._bytes.find(b"a" * 1000)
    memory._bytes[place - 8 : place - 4] = b"\xff" * 4
    assert memory.get(key(1)) is None


def test_where_there_is_no_memory_nothing_is_shared(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr(SharedMemory, "_current", None)
    monkeypatch.setattr("mmap.mmap", fail)
    SharedMemory.share()
    assert SharedMemory.current() is None


def test_processes_share_what_they_put(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SharedMemory, "_current", None)
    assert SharedMemory.current() is None
    SharedMemory.share()
    memory = SharedMemory.current()
    assert memory is not None
    child = os.fork()
    if not child:
        memory.put(key(1), b"by the child")
        os._exit(0)
    os.waitpid(child, 0)
    assert memory.get(key(1)) == b"by the child"


@pytest.mark.parametrize(
    ("program", "expected"),
    [("src/mutabot_cell/motion", True), ("src", True), ("examples/paper/mission.py", False)],
)
def test_nothing_is_shared_where_mutabot_itself_is_the_program(program: str, expected: bool) -> None:
    """What its mutants would compute, their original has computed."""
    if Path(shared_memory.__file__).parents[1].name != "src":
        pytest.skip("mutabot is not run from its repository")
    root = Path(shared_memory.__file__).parents[2]
    job = SimpleNamespace(root=str(root), program=(program,), oracle=("tests",))
    assert _tests_us(job) is expected
