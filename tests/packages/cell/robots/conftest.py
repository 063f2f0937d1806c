"""Robots of other packages, which requirements-reports.lock installs."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot_cell import BadModel, RobotModel, robots

NAMES = ("gen3", "ur5e", "panda", "xarm7")


def robot_named(name: str) -> RobotModel:
    """The robot of the catalogue; skips the test where its package is not installed."""
    try:
        found: RobotModel = getattr(robots, name)()
    except BadModel as error:
        pytest.skip(str(error))
    return found


@pytest.fixture(params=NAMES)
def robot(request: pytest.FixtureRequest) -> RobotModel:
    return robot_named(request.param)


@pytest.fixture
def ur5e() -> RobotModel:
    return robot_named("ur5e")


def file_of(package: str, name: str) -> Path:
    """A file that a package carries, without importing it."""
    found = pytest.importorskip("importlib.util").find_spec(package)
    if found is None:
        pytest.skip(f"{package} is not installed")
    return Path(found.submodule_search_locations[0], name)
