"""Stops at random moments within running campaigns on hardware: is anything sent after them?

A program sends commands, as fast as it can, to a robot at the other end of a connection, which writes down
what reaches it. There are moments of two kinds, both drawn from a fixed seed:

- *held*: while a mutant of a campaign sends, the stop that every surprise calls comes at a random time. The
  program goes on trying; the moment lasts some milliseconds, and then the campaign may send again. It counts
  if the robot has received something since the moment before. In it no command gets leave, and the robot
  receives none that had no leave before.
- *ended*: a campaign is interrupted, as by Ctrl-C, at a random time after its first command, in the original,
  in a control, in a mutant or between two of them. The next one goes on where it was stopped. After the stop
  no command gets leave, and after the campaign's end the robot receives nothing.

Of all, the robot's log is compared with the campaign's: what the robot got is in the campaign's log.

Use: ``python benchmarks/hardware_stops.py [--held 1000] [--ended 30] [--seed 1]``. The exit code is 1 if one
fails.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).parents[1]))

from typing import Self
from unittest.mock import patch

from tests.packages.hardware.robot_server import GUARD, RobotServer, robot_server, write_project

from mutabot.cli.app import main as mutabot
from mutabot_hardware.permission import Permissions

#: it goes on whatever comes of a command
PROGRAM = """
    import time

    def go(arm, number):
        arm.move_by(dx=0.001 * (-1) ** number)

    def place(arm):
        number, until = 0, time.monotonic() + SECONDS
        while time.monotonic() < until:
            number += 1
            try:
                go(arm, number)
            except BaseException as error:
                if type(error).__name__ != "GuardedCall":
                    raise
                time.sleep(0.0001)
    """
TESTS = """
    import program
    from robot import Arm

    def test_it_is_placed():
        program.place(Arm())
    """
CELL_IO = """
    def retreat():
        pass

    def is_alive():
        pass
    """
HARDWARE = f"""
    {GUARD}
    [hardware]
    safe_state = "cell_io:retreat"
    heartbeat = "cell_io:is_alive"
    stop = []
    """
#: seconds that a test sends, for moments that are held and for those that end a campaign
_LONG, _SHORT = "3.0", "0.4"
#: seconds after a campaign's first command within which it is stopped
_WITHIN = 15.0
#: seconds between two stops, and that one of them lasts, at most
_BETWEEN, _LASTS = 0.01, 0.006
#: seconds that a campaign's end is waited for what may still come
_AFTER = 0.05


_HELD, _MOMENT = "held in a mutant", "a moment"


@dataclass
class Found:
    """What came of the moments: how many there were of each kind, and what was wrong."""

    kinds: Counter[str] = field(default_factory=Counter)
    commands: int = 0
    wrong: list[str] = field(default_factory=list)


def main() -> int:
    """Stop campaigns, and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--held", type=int, default=1000)
    parser.add_argument("--ended", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    began = os.times()
    found = stop_at(given.held, given.ended, given.seed)
    times = os.times()
    used = times.user + times.system + times.children_user + times.children_system
    used -= sum(began[:4])
    print(
        f"seed {given.seed}: {dict(found.kinds)}, {found.commands} commands, "
        f"{len(found.wrong)} wrong, {used:.0f} s of processor time"
    )
    for line in found.wrong:
        print(f"  {line}")
    return int(bool(found.wrong))


def stop_at(held: int, ended: int, seed: int) -> Found:
    """Stop campaigns at so many moments of each kind."""
    draw, found = Random(seed), Found()
    with tempfile.TemporaryDirectory() as name, robot_server() as server:
        os.environ["ROBOT_PORT"] = str(server.port)
        folder = Path(name)
        _write(folder, _LONG)
        while found.kinds[_HELD] < held:
            _hold(folder, server, draw, held, found)
        _write(folder, _SHORT)
        for number in range(ended):
            _stop_once(folder, server, draw.uniform(0.0, _WITHIN), number, found)
    return found


def _write(folder: Path, seconds: str) -> None:
    write_project(folder, PROGRAM.replace("SECONDS", seconds), TESTS, HARDWARE, CELL_IO)


@dataclass
class Tail:
    """What has been added to the log since it was made.

    Attributes:
        sent: how many commands had leave.
        in_mutant: whether the last run that began is a mutant's, and no control's.
    """

    file: Path
    sent: int = 0
    in_mutant: bool = False
    _at: int = 0

    def __post_init__(self) -> None:
        self._at = self.file.stat().st_size if self.file.exists() else 0

    def read(self) -> int:
        """Read on; returns how many commands had leave."""
        with self.file.open("rb") as file:
            file.seek(self._at)
            for line in file:
                if not line.endswith(b"\n"):
                    break
                self._at += len(line)
                self.sent += b'"sent"' in line
                if b'"begin"' in line:
                    self.in_mutant = b'"mutant"' in line and b"=" not in line
        return self.sent


def _hold(folder: Path, server: RobotServer, draw: Random, held: int, found: Found) -> None:
    """One campaign, with stops while its mutants run, each of which is taken back."""
    before, tail, is_over = len(server.received), Tail(_file(folder)), threading.Event()
    made: list[Permissions] = []

    class Kept(Permissions):
        def __enter__(self) -> Self:
            made.append(self)
            return super().__enter__()

    def hold() -> None:
        last = 0
        while not is_over.wait(draw.uniform(0.0, _BETWEEN)) and found.kinds[_HELD] < held:
            if made:
                tail.read()
            if tail.in_mutant and len(server.received) > last:
                _hold_once(made[-1], tail, draw, found, lambda: len(server.received) - before)
                last = len(server.received)

    holder = threading.Thread(target=hold)
    with patch("mutabot_hardware.executor.Permissions", Kept):
        holder.start()
        _quietly(folder, "--fresh", "--hardware", "repeat")
        is_over.set()
    holder.join()
    server.settle()
    got = len(server.received) - before
    found.commands += got
    if tail.read() != got:
        found.wrong.append(f"{got} received, {tail.sent} with leave")


def _hold_once(
    leave: Permissions, tail: Tail, draw: Random, found: Found, received: Callable[[], int]
) -> None:
    leave.stop(_MOMENT)
    allowed = tail.read()
    time.sleep(draw.uniform(0.002, _LASTS))
    got, more = received(), tail.read() - allowed
    if leave._stopped != _MOMENT:  # the campaign came to its end meanwhile
        return
    leave._stopped = ""  # nothing but this benchmark takes a stop back
    found.kinds[_HELD] += 1
    if more or got > allowed:
        found.wrong.append(f"{more} had leave while it was stopped; {got} received, {allowed} had leave")


def _quietly(folder: Path, *words: str) -> object:
    """Run a campaign; returns its exit code."""
    silence = io.StringIO()
    with contextlib.redirect_stdout(silence), contextlib.redirect_stderr(silence):
        try:
            return mutabot(["-C", str(folder), "run", *words])
        except KeyboardInterrupt:
            return "interrupted"


def _stop_once(folder: Path, server: RobotServer, seconds: float, number: int, found: Found) -> None:
    before, lines = len(server.received), len(_log(folder))
    is_over = threading.Event()
    killer = threading.Thread(target=_interrupt, args=(server, before, seconds, is_over))
    killer.start()
    try:
        code = _quietly(folder, "--hardware", "repeat")
    finally:
        is_over.set()
    ended = time.monotonic()
    killer.join()
    server.settle()
    time.sleep(_AFTER)
    log = _log(folder)[lines:]
    got = server.received[before:]
    sent = [entry for entry in log if "sent" in entry]
    stop = next((place for place, entry in enumerate(log) if "stop" in entry), len(log))
    found.kinds[_kind(log[:stop]) if stop < len(log) else "came too late"] += 1
    found.commands += len(got)
    after = sum("sent" in entry for entry in log[stop:])
    late = sum(moment > ended for moment, _ in got)
    # one command may have had leave when its process was killed
    if not 0 <= len(sent) - len(got) <= 1 or after or late:
        found.wrong.append(
            f"moment {number}, {seconds:.4f} s: {len(got)} received, {len(sent)} with leave, {after} of them "
            f"after the stop, {late} received after the end; {code}"
        )
    if stop == len(log):  # all is done: the next campaign begins anew
        (folder / ".mutabot" / "journal.sqlite").unlink()


def _interrupt(server: RobotServer, before: int, seconds: float, is_over: threading.Event) -> None:
    while len(server.received) == before:
        if is_over.wait(0.001):
            return
    if not is_over.wait(seconds):
        os.kill(os.getpid(), signal.SIGINT)


def _file(folder: Path) -> Path:
    return folder / ".mutabot" / "hardware.jsonl"


def _log(folder: Path) -> list[dict[str, object]]:
    file = _file(folder)
    return [json.loads(line) for line in file.read_text("utf-8").splitlines()] if file.exists() else []


def _kind(log: list[dict[str, object]]) -> str:
    """What was running last."""
    begun = [entry for entry in log if "begin" in entry]
    return "ended in a mutant" if begun and "mutant" in begun[-1] else "ended in the original"


if __name__ == "__main__":
    sys.exit(main())
