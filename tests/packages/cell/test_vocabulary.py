"""The vocabulary makes mutants of what a program says to suction cup, force sensor and light barriers."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
from mutabot_cell import current

def run():
    cell = current()
    if cell.sensors.light_barriers.is_interrupted("gate"):
        cell.force_sensor.zero()
        cell.suction.on()
        cell.wait(0.1)
        if cell.suction.vacuum() < 20e3 and not cell.suction.holding():
            cell.suction.off()
    return cell.force_sensor.wrench().fz
"""
TEST = """
import program
from mutabot_cell import Box, LightBarrier, Scene, gen3, suction_cup

def test_run(new_cell):
    gate = LightBarrier("gate", (0.55, -0.5, 1.02), (0.55, 0.5, 1.02))
    new_cell(1, scene=Scene(light_barriers=(gate,)), robot=gen3().with_tool(suction_cup()))
    assert program.run() is not None
"""
CONFIGURATION = """
[tool.pytest.ini_options]
pythonpath = ["."]
[tool.mutabot]
program = ["program.py"]
tests = ["tests"]
vocabulary = ["cell"]
families = ["robot", "graded"]
"""


@pytest.mark.usefixtures("plugins")
@pytest.mark.whole
def test_mutants_are_made_of_suction_force_and_light_barriers(tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "pyproject.toml").write_text(CONFIGURATION)
    (tmp_path / "tests" / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (tmp_path / "tests" / "test_program.py").write_text(TEST)
    command = [sys.executable, "-m", "mutabot", "-C", str(tmp_path), "list", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = {(mutant["call"], mutant["operator"]) for mutant in json.loads(done.stdout)["mutants"]}
    assert found >= {
        ("cell.suction.on", "skip"),
        ("cell.suction.on", "opposite"),
        ("cell.suction.off", "opposite"),
        ("cell.suction.holding", "misread"),
        ("cell.suction.vacuum", "offset"),
        ("cell.force_sensor.zero", "skip"),
        ("cell.force_sensor.wrench", "offset"),
        ("cell.sensors.light_barriers.is_interrupted", "misread"),
    }
