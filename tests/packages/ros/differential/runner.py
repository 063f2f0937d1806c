"""Records behaviours, each in a fresh process and on a domain that nobody else uses."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tests.ros2_domain import domain

ROOT = Path(__file__).parents[4]
#: what was recorded over Fast DDS with the pinned release of rclpy, the same in five recordings
KEPT = Path(__file__).with_name("recorded.jsonl")
#: what a behaviour can be recorded over
WAYS = ("dds", "simulation")


@dataclass(frozen=True)
class Outcome:
    """The record of a behaviour, or the reason why there is none."""

    name: str
    record: Any = None
    error: str = ""
    seconds: float = 0.0

    def line(self) -> str:
        """This outcome as a line of JSON."""
        return json.dumps(asdict(self))

    def told(self) -> str:
        """The record or the end of the error, for a reader."""
        return f"error: {self.error.strip().splitlines()[-1]}" if self.error else json.dumps(self.record)

    def equals(self, other: Outcome) -> bool:
        """Whether both have a record, and the same; time does not count."""
        return not self.error and not other.error and self.record == other.record


def read(path: Path) -> dict[str, Outcome]:
    """The outcomes of a file by their names."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return {outcome.name: outcome for outcome in (Outcome(**json.loads(line)) for line in lines)}


def names() -> list[str]:
    """The names of all behaviours, asked of a process that may import rclpy."""
    done = subprocess.run(_command("list"), cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.split()


def run(
    only: Iterable[str] = (), over: str = "dds", *, jobs: int = 2, seconds: float = 30.0
) -> Iterator[Outcome]:
    """Record behaviours, all or those named, in the order of their names' list."""
    chosen = list(only) or names()
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda name: _one(name, over, seconds), chosen)


def _one(name: str, over: str, seconds: float) -> Outcome:
    with tempfile.TemporaryDirectory() as folder, domain() as number:
        written = Path(folder) / "record.json"
        begin = time.monotonic()
        command = _command("one", name, "--over", over, "--to", str(written))
        try:
            done = subprocess.run(
                command,
                cwd=ROOT,
                env=_environment(number, folder),
                capture_output=True,
                text=True,
                timeout=seconds,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Outcome(name, error=f"no record in {seconds} s")
        took = round(time.monotonic() - begin, 2)
        if not written.exists():
            return Outcome(
                name, error=f"{done.stderr}\nno record, return code {done.returncode}", seconds=took
            )
        return Outcome(name, seconds=took, **json.loads(written.read_text(encoding="utf-8")))


def _command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "tests.packages.ros.differential", *arguments]


def _environment(number: int, folder: str) -> dict[str, str]:
    """The loopback device alone, and nothing of the user's own settings."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("ROS_", "RMW_", "FAST"))}
    path = [str(ROOT / "src"), kept.get("PYTHONPATH", "")]
    return {
        **kept,
        "PYTHONPATH": os.pathsep.join(part for part in path if part),
        "ROS_DOMAIN_ID": str(number),
        "FASTDDS_DEFAULT_PROFILES_FILE": str(ROOT / "examples" / "ros2" / "discovery.xml"),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",  # as the file says
        "ROS_LOG_DIR": folder,
    }
