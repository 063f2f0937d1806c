"""What ROS 2 brings along does not keep a process from being forked."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

from .test_forkable import ASK


@pytest.mark.skipif(find_spec("rclpy") is None, reason="no ROS 2: pip install -r requirements-ros2.lock")
def test_threads_that_wait_for_a_tracer_are_no_reason() -> None:
    code = "import os, rclpy, std_msgs.msg; assert len(os.listdir('/proc/self/task')) > 1"
    result = subprocess.run(
        [sys.executable, "-c", ASK.format(code)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    assert result.stdout.strip() == "None"
