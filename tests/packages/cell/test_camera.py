"""The cell's camera: pictures of a film, where the machine can draw without a screen."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.evidence import recorder
from mutabot_cell import Cell
from mutabot_motion.pictures.film import Film

CODE = """
import sys
from mutabot_cell import Cell
from mutabot.evidence import recorder
from mutabot_motion.pictures.film import FilmWriter

cell = Cell(1)
before = cell.simulation.model.vis.quality.shadowsize, cell.simulation.model.vis.quality.offsamples
found = recorder.begin(FilmWriter(sys.argv[1]))
cell.wait(0.2)
print(found.recording.problems)
assert before == (cell.simulation.model.vis.quality.shadowsize, cell.simulation.model.vis.quality.offsamples)
"""


@pytest.mark.whole
def test_a_cell_is_filmed_while_it_moves(tmp_path: Path) -> None:
    file = tmp_path / "cell.film"
    environment = {**os.environ, "MUJOCO_GL": "egl"}
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(file)], capture_output=True, text=True, env=environment, check=False
    )
    if "GL" in f"{done.stdout}{done.stderr}".upper():
        pytest.skip("no egl on this machine")
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr
    pictures = list(Film(file).pictures())
    assert [picture.time for picture in pictures] == pytest.approx([0.0, 0.07, 0.15], abs=0.011)
    assert (pictures[0].width, pictures[0].height) == (600, 450)
    assert len(set(pictures[0].pixels)) > 50, "more than one colour"


def test_in_an_ordinary_recording_the_cell_draws_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    import mujoco  # noqa: PLC0415  # an extra

    monkeypatch.setattr(mujoco, "Renderer", lambda *_: pytest.fail("a picture was taken"))
    cell = Cell(1)
    found = recorder.begin()
    try:
        cell.wait(0.3)
    finally:
        recorder.stop()
    assert len(found.recording.times) > 1
    assert found.recording.problems == []
