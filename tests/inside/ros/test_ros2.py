"""What a node does through rclpy is seen and mutated by its name.

rclpy leaves threads in its process. So the tests themselves are in ``ros2_cases.py``, which runs in one of
its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from ros2_domain import domain

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(find_spec("rclpy") is None, reason="no ROS 2: pip install -r requirements-ros2.lock")
def test_every_case_holds_over_a_real_middleware() -> None:
    asked = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "default"]
    with domain() as number:
        ours = {
            "ROS_DOMAIN_ID": str(number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        }
        done = subprocess.run(
            [*asked, "tests/inside/ros/ros2_cases.py"],
            cwd=ROOT,
            env={**os.environ, **ours},
            capture_output=True,
            text=True,
            timeout=200,
            check=False,
        )
    assert done.returncode == 0, done.stdout + done.stderr
