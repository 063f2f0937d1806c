"""The program as a process of its own, as it is started on the robot."""

from __future__ import annotations

import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from readings import gap, is_charging, top_speed
from scene import Scene

PROGRAM = Path(__file__).parents[1] / "docking.py"


def end(process: subprocess.Popen[bytes]) -> int:
    """Let a program end, and wait until it has. A node that is about to wait may miss that it is to end."""
    while process.poll() is None:
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(5.0)  # a second signal while it ends would kill it
    return process.returncode


def test_it_docks_with_the_speed_it_was_given(empty_scene: Scene) -> None:
    process = subprocess.Popen([sys.executable, str(PROGRAM), "--ros-args", "-p", "approach_speed:=0.25"])
    try:
        assert empty_scene.dock()
        assert empty_scene.becomes("docked")
        assert gap(empty_scene.station) < 0.02
        assert is_charging(empty_scene.station)
        assert top_speed(empty_scene.station) < 0.26
    finally:
        code = end(process)
    assert code == 0
