"""What a node does through rclpy is seen and mutated by its name.

rclpy leaves threads in its process. So the tests themselves are in ``ros2_cases.py``, which runs in one of
its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from ros2_domain import domain

from .both import needs_ros2, run_cases


@needs_ros2
def test_every_case_holds_over_a_real_middleware() -> None:
    with domain() as number:
        environment = {
            "ROS_DOMAIN_ID": str(number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        }
        run_cases("ros2_cases.py", environment)


_NODE = """
import os, subprocess, sys
from mutabot_ros import _domain
_domain.take(sys.argv[1])
import rclpy
rclpy.init()
node = rclpy.create_node("mission")
with open("/proc/self/maps") as maps:
    shared = [line for line in maps if "/dev/shm/fastdds" in line]
print(os.environ["ROS_DOMAIN_ID"], len(shared), flush=True)
sys.stdin.read()
node.destroy_node()
rclpy.shutdown()
"""


@needs_ros2
def test_workers_have_domains_of_their_own_and_share_no_memory(tmp_path: Path) -> None:
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("ROS_", "FAST"))}
    nodes = [
        subprocess.Popen(
            [sys.executable, "-c", _NODE, str(tmp_path)],
            env={**environment, "ROS_DOMAIN_ID": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    said = [node.stdout.readline().split() for node in nodes if node.stdout is not None]
    for node in nodes:
        node.communicate(timeout=30)
    domains = {domain for domain, _ in said}
    assert len(domains) == 2
    assert "1" not in domains, "that is the user's own"
    assert [shared for _, shared in said] == ["0", "0"]
    assert [node.returncode for node in nodes] == [0, 0]
