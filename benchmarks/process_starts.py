"""What does a Python process cost that begins warm, beside one that begins from nothing?

Each program is started in turn in both ways, after a few starts that are not counted, in which the zygote
learns what it imports. Processor time is that of the new process; wall time is from the start to its end.

Use: ``python benchmarks/process_starts.py [--count N] [--json]``. Programs whose modules are not installed
are left out.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from mutabot.border.starter import is_supported
from mutabot.campaign.workers.processes import usual_environment
from mutabot.campaign.workers.warm import WarmServer

#: program to the modules that it needs, and its text
PROGRAMS = {
    "nothing": ((), "pass"),
    "numpy": (("numpy",), "import numpy"),
    "a simulation": (("mujoco",), "import mujoco, numpy, json, logging, asyncio"),
    "pytest": (("pytest",), "import pytest; pytest.main(['--version'])"),
    "a ROS 2 node": (
        ("rclpy", "std_msgs"),
        "import rclpy, rclpy.node, std_msgs.msg; rclpy.init()\n"
        "node = rclpy.node.Node('one', enable_rosout=False, start_parameter_services=False)\n"
        "node.create_publisher(std_msgs.msg.String, '/word', 10); node.destroy_node(); rclpy.shutdown()",
    ),
    "a ROS 1 node's imports": (("rospy",), "import rospy, std_srvs.srv, geometry_msgs.msg"),
}
#: starts that are not counted
UNCOUNTED = 3


@dataclass(frozen=True, slots=True)
class Row:
    """What one program takes.

    Attributes:
        program: its name.
        plain, warm: seconds of wall clock, medians.
        plain_cpu, warm_cpu: seconds of processor time, medians.
    """

    program: str
    plain: float
    warm: float
    plain_cpu: float
    warm_cpu: float


def measure(program: str, count: int) -> Row:
    """Start a program in both ways in turn."""
    text = PROGRAMS[program][1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        script = folder / "program.py"
        script.write_text(text)
        server = WarmServer(folder, folder, usual_environment(), own_session=False)
        server.starter.may_start = False
        taken: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
        for number in range(UNCOUNTED + count):
            for is_warm, times in taken.items():
                found = start(script, server if is_warm else None)
                if number >= UNCOUNTED:
                    times.append(found)
        reason = server.why_not()
        server.close()
    if reason is not None:
        raise SystemExit(f"{program} does not begin warm: {reason}")
    plain, warm = ([statistics.median(part) for part in zip(*taken[one], strict=True)] for one in taken)
    return Row(program, plain[0], warm[0], plain[1], warm[1])


def start(script: Path, server: WarmServer | None) -> tuple[float, float]:
    """Seconds of wall clock and of processor time that one start takes."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, str(script)]
    options = {"env": usual_environment(), "stdout": subprocess.DEVNULL}
    if server is None:
        subprocess.run(command, check=True, **options)  # type: ignore[call-overload]
    else:
        with server.starter.at_work():
            subprocess.run(command, check=True, **options)  # type: ignore[call-overload]
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    given = parser.parse_args()
    reason = is_supported()
    if reason is not None:
        print(f"nothing begins warm here: {reason}")
        return 0
    os.environ.update(PYTHONHASHSEED="0", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_DOMAIN_ID="83")
    os.environ.setdefault("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
    there = [name for name, (needed, _) in PROGRAMS.items() if all(map(importlib.util.find_spec, needed))]
    rows = [measure(name, given.count) for name in there]
    if given.json:
        print(json.dumps([asdict(row) for row in rows], indent=2))
        return 0
    print(f"{'program':24} {'plain s':>9} {'warm s':>9} {'plain CPU s':>12} {'warm CPU s':>12}")
    for row in rows:
        times = f"{row.plain:9.3f} {row.warm:9.3f} {row.plain_cpu:12.3f} {row.warm_cpu:12.3f}"
        print(f"{row.program:24} {times}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
