"""No worker shares a domain of ROS 2 with nodes that are running, whoever has left them over."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from mutabot_ros import _domain


def test_a_domain_of_a_running_node_is_left_alone() -> None:
    free = _domain._claim(None)
    environment = {**os.environ, _domain.DOMAIN: str(free)}
    with subprocess.Popen(["sleep", "60"], env=environment) as left_over:
        try:
            while _domain.DOMAIN not in _environment(left_over.pid):  # until it is what it shall be
                pass
            assert _domain._claim(None) != free
        finally:
            left_over.kill()
            _domain._held.pop().close()


def _environment(pid: int) -> str:
    return Path(f"/proc/{pid}/environ").read_text(encoding="utf-8", errors="replace")
