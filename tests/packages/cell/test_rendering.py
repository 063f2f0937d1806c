from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("backend", ["egl", pytest.param("osmesa", marks=pytest.mark.whole)])
def test_cell_can_be_drawn_without_a_screen(tmp_path: Path, backend: str) -> None:
    picture = tmp_path / "cell.png"
    drawing = f"render(Cell(1), {str(picture)!r}, width=160, height=120)"
    code = f"from mutabot_cell import Cell, render; {drawing}"
    environment = {**os.environ, "MUJOCO_GL": backend}
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    if result.returncode != 0 and "GL" in result.stderr.upper():
        pytest.skip(f"no {backend} on this machine")
    assert result.returncode == 0, result.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert picture.stat().st_size > 2000
