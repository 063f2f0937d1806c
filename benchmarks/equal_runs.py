"""Are runs over the simulation of ROS 2 equal to the bit, whatever the seed of Python's hashes?

Runs the suites of the ROS 2 examples again and again, each time with another ``PYTHONHASHSEED``. Each run
notes, with the simulated time in nanoseconds and the thread: every switch of threads, every message that is
sent and received, every request and answer, and how each test ended. All runs of an example must note the
same.

Use: ``python benchmarks/equal_runs.py [--count 200] [--first 0] [--examples ros2 ros2_docking] [--schedule
random]``. The exit code is 1 if two runs differ.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
#: a plug-in of pytest that notes what happens
_NOTES = """
import os
from functools import wraps

from ros_in_process.machine.scheduler import SCHEDULER, Scheduler
from ros_in_process.middleware import services, topics

FILE = open(os.environ["NOTES"], "w")

def noted(kind, name):
    plain = getattr(kind, name)

    @wraps(plain)
    def noting(self, *args):
        what = [repr(one) for one in args if not callable(one) and " at 0x" not in repr(one)]
        print(SCHEDULER.now, SCHEDULER.current.number, kind.__name__, name, *what, file=FILE)
        return plain(self, *args)

    setattr(kind, name, noting)

noted(Scheduler, "park")
noted(topics.Publisher, "_send")
noted(topics.Subscription, "_arrive")
noted(services.Client, "send_request")
noted(services.Service, "service_send_response")

def pytest_runtest_logreport(report):
    ended = report.when, report.outcome, report.longreprtext
    print(SCHEDULER.now, report.nodeid, *ended, file=FILE, flush=True)
"""


def main() -> int:
    """Run them, and tell how many were equal."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200, help="runs of each example")
    parser.add_argument("--first", type=int, default=0, help="the seed of hashes of the first run")
    parser.add_argument("--examples", nargs="+", default=["ros2", "ros2_docking"])
    parser.add_argument("--schedule", default="first-in", choices=("first-in", "random"))
    given = parser.parse_args()
    is_equal = True
    for name in given.examples:
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as place:
            digests: dict[str, list[int]] = {}
            for seed in range(given.first, given.first + given.count):
                digests.setdefault(_run(name, Path(place), seed, given.schedule), []).append(seed)
            lines = len((Path(place) / "notes").read_text().splitlines())
        equal = max(map(len, digests.values()))
        print(
            f"{name}: {equal} of {given.count} runs are equal in each of about {lines} notes "
            f"({time.monotonic() - began:.0f} s)",
            flush=True,
        )
        if len(digests) > 1:
            is_equal = False
            print(f"  seeds of hashes by notes: {list(digests.values())}")
    return int(not is_equal)


def _run(example: str, place: Path, seed: int, schedule: str) -> str:
    """The digest of what a run of an example's suite noted; a run that fails ends all."""
    (place / "_notes.py").write_text(_NOTES)
    notes = place / "notes"
    environment = {
        **os.environ,
        "PYTHONHASHSEED": str(seed),
        "NOTES": str(notes),
        "PYTHONPATH": os.pathsep.join([str(place), os.environ.get("PYTHONPATH", "")]),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    plugins = ("no:cacheprovider", "ros_in_process.plugin", "_notes")
    options = [word for one in plugins for word in ("-p", one)]
    command = [sys.executable, "-m", "pytest", "-q", *options, f"--ros-schedule={schedule}"]
    done = subprocess.run(
        command,
        cwd=ROOT / "examples" / example,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"{example} fails with PYTHONHASHSEED={seed}:\n{done.stdout}{done.stderr}")
    return hashlib.sha256(notes.read_bytes()).hexdigest()


if __name__ == "__main__":
    sys.exit(main())
