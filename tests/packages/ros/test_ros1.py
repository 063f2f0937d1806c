"""What a node does through rospy is seen and mutated by its name.

rospy's node cannot be taken down again within its process, and leaves threads. So the tests themselves are in
``ros1_cases.py``, which runs in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(
    find_spec("rospy") is None or find_spec("rosmaster") is None,
    reason="no rospy: install Debian's python3-rospy and python3-rosmaster",
)
def test_every_case_holds_with_a_real_master() -> None:
    asked = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "default"]
    done = subprocess.run(
        [*asked, "tests/packages/ros/ros1_cases.py"],
        cwd=ROOT,
        env={**os.environ, "ROS_NAMESPACE": "/cell", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
