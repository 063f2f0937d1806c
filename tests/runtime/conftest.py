from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.runtime.stage import Make, Stage


@pytest.fixture
def make_stage(tmp_path: Path) -> Iterator[Make]:
    """Makes stages, and takes their wrappers and modules away afterwards."""
    stages: list[Stage] = []

    def make(robot: str, program: str, vocabulary: str) -> Stage:
        folder = tmp_path / str(len(stages))
        folder.mkdir()
        stages.append(Stage(folder, robot, program, vocabulary))
        return stages[-1]

    yield make
    for stage in stages:
        stage.close()
