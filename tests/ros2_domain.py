"""A ROS 2 domain for a test that nothing else on this machine uses."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def domain() -> Iterator[int]:
    """The number of a domain, until the block ends."""
    for number in range(101, 0, -1):
        held = socket.socket(socket.AF_UNIX)
        with suppress(OSError):
            held.bind(f"\0mutabot-ros-domain-{number}")
            with held:
                yield number
                return
        held.close()
    raise RuntimeError("all domains are in use")
