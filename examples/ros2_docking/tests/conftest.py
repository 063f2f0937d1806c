"""One station and one robot per test, on a ROS domain of their own."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1]

# nobody else's nodes: of other machines, or of other tests that run beside these
os.environ.setdefault("ROS_DOMAIN_ID", str(os.getpid() % 101 + 1))
if "FASTDDS_DEFAULT_PROFILES_FILE" not in os.environ:
    os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = str(FOLDER / "discovery.xml")
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"  # as the file says

from scene import Scene  # noqa: E402  (imports rclpy, which reads the environment)


@pytest.fixture
def scene() -> Iterator[Scene]:
    """The station, and the program's node in this process, configured and active."""
    with Scene() as made:
        made.start()
        yield made


@pytest.fixture
def empty_scene() -> Iterator[Scene]:
    """The station alone."""
    with Scene() as made:
        yield made
