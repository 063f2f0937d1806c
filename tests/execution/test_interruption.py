"""Ctrl-C takes effect while a campaign waits, and leaves nothing open wherever it comes."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from contextlib import nullcontext
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.execution import workers
from mutabot.execution import workers as waiting
from mutabot.execution.interruption import (
    Interruption,
    OutOfTimeError,
    interrupt,
    interruptible,
    interruptions_kept,
    limited,
)
from mutabot.journal.journal import Journal
from tests.campaign.project import REPLAY, Quiet, request_for, write_project
from tests.forked_processes import Interpreter

#: what happened in the present test
passed: list[str] = []


def press() -> None:
    """Ctrl-C."""
    signal.raise_signal(signal.SIGINT)


def descriptors() -> set[str]:
    """The open descriptors, and where they lead."""
    return {str(path.readlink()) for path in Path("/proc/self/fd").iterdir() if path.exists()}


def children() -> list[str]:
    """The processes that this one has started and not yet waited for."""
    return Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split()


def kept(work: Callable[[], None]) -> list[str]:
    """What happens of a piece of work that is interrupted."""
    passed.clear()
    with pytest.raises(KeyboardInterrupt), interruptions_kept():
        work()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    return passed


def go_on() -> None:
    passed.append("went on")


def wait() -> None:
    with interruptible():
        passed.append("waited")


def test_an_interruption_is_kept_until_the_campaign_waits() -> None:
    def work() -> None:
        press()
        go_on()
        wait()

    assert kept(work) == ["went on"]


def test_an_interruption_while_the_campaign_waits_takes_effect_at_once() -> None:
    def work() -> None:
        with interruptible():
            press()
            go_on()

    assert kept(work) == []


def test_an_interruption_of_a_campaign_that_waits_no_more_takes_effect_at_its_end() -> None:
    def work() -> None:
        wait()
        press()
        go_on()

    assert kept(work) == ["waited", "went on"]


def test_a_second_interruption_takes_effect_at_once() -> None:
    def work() -> None:
        press()
        go_on()
        press()
        go_on()

    assert kept(work) == ["went on"]


def test_where_ctrl_c_is_ignored_other_ends_of_a_campaign_are_kept_likewise() -> None:
    passed.clear()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interruptions_kept():
            press()
            wait()
            interrupt()
            go_on()
            with pytest.raises(Interruption):
                wait()
            with pytest.raises(OutOfTimeError), limited(0.0, lambda: 1.0), interruptible():
                signal.pause()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    assert passed == ["waited", "went on"]


def test_an_error_is_not_hidden_by_an_interruption_that_was_kept() -> None:
    def work() -> None:
        with interruptions_kept():
            press()
            raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        work()


def test_other_threads_and_handlers_of_others_are_left_alone() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: heard.append(number))
    try:
        with interruptions_kept(), interruptible():
            press()
    finally:
        signal.signal(signal.SIGINT, before)
    assert heard == [signal.SIGINT]

    def keep() -> None:
        with interruptions_kept(), interruptible():
            heard.append(0)

    thread = threading.Thread(target=keep)
    thread.start()
    thread.join()
    assert heard == [signal.SIGINT, 0]


def after(original: Callable[..., Any]) -> Callable[..., Any]:
    """The same, and then Ctrl-C the first time."""
    calls = count()

    def pressed(*arguments: Any, **options: Any) -> Any:
        result = original(*arguments, **options)
        if next(calls) == 0:
            press()
        return result

    return pressed


#: moments at which something is open that nobody looks after yet, or not any more
MOMENTS = {
    "the pool has been made": (waiting.TokenPool, "__init__"),
    "a worker's folder has been made": (workers.Home, "make"),
    "a worker has been started": (workers.Spawned, "__init__"),
    "a fork server has been started": (workers.ForkServerProcess, "__init__"),
    "a copy has been made": (workers.ForkServerProcess, "copy"),
    "a worker is being looked after for the last time": (workers._Worker, "finish"),
    "the journal has been opened": (Journal, "__init__"),
}


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize("moment", MOMENTS)
def test_an_interruption_at_any_moment_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, interpreter: Interpreter | None, moment: str, engine: str
) -> None:
    mission = "def run(arm):\n    arm.move_by(0.25)\n"
    tests = "import mission\nfrom robot import Arm\n\ndef test_run():\n    mission.run(Arm())\n"
    write_project(tmp_path, mission, tests)
    request = request_for(tmp_path, engine=engine)
    if interpreter is not None:
        interpreter.start()
    before = descriptors(), children()
    owner, name = MOMENTS[moment]
    monkeypatch.setattr(owner, name, after(getattr(owner, name)))
    is_there = engine == "fork" or ("fork server" not in moment and "copy" not in moment)
    with pytest.raises(KeyboardInterrupt) if is_there else nullcontext():
        run_campaign(request, Quiet())
    assert (descriptors(), children()) == before
    assert not list((tmp_path / ".mutabot").glob("work-*"))
