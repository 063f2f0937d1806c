"""These tests need the extra `cells`."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot_cell import Box, Cell, Scene


@pytest.fixture
def cell() -> Cell:
    return Cell(seed=1)


@pytest.fixture
def project(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A copy of the example that the test's module is about."""
    example: Path = request.module.EXAMPLE
    return shutil.copytree(
        example, tmp_path / example.name, ignore=shutil.ignore_patterns(".*", "__pycache__")
    )


@pytest.fixture
def exact_cell() -> Cell:
    """Sensors without noise."""
    return Cell(seed=1, noise=False)


def _grip(cell: Cell) -> None:
    cell.arm.move_by(y=0.2)
    cell.arm.move_by(theta_x=80)
    cell.arm.move_by(z=-0.29)
    cell.gripper.command(1, wait=True)


@pytest.fixture
def grip() -> Callable[[Cell], None]:
    """Brings the robot to the box on the conveyor and closes the fingers on it."""
    return _grip


@pytest.fixture
def slippery_scene() -> Scene:
    """The box has no friction."""
    return Scene(parts=(Box(friction=0.0),))
