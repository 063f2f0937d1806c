"""`mutabot suggest` finds checks for survivors in robot programs, as it does for those in Python programs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

#: each goes up by 50 mm and shuts the gripper; its mutant goes down
PROGRAMS = {
    "up.mod": "MODULE Up\nPROC main()\nMoveL Offs(CRobT(),0,0,50),v200,fine,tool0;\nSet doGrip;\n"
    "WaitTime 0.5;\nENDPROC\nENDMODULE\n",
    "up.src": "DEF up( )\n$VEL.CP=0.2\nLIN_REL {X 0,Y 0,Z 50}\n$OUT[1]=TRUE\nWAIT SEC 0.5\nEND\n",
    "up.script": "movel(pose_add(get_actual_tcp_pose(), p[0, 0, 0.05, 0, 0, 0]), v=0.2)\n"
    "set_standard_digital_out(0, True)\nsleep(0.5)\n",
}
SIGNALS = "".join(
    f"[out.'{name}']\ngripper = [0, 1]\n" for name in ("doGrip", "$OUT[1]", "standard_digital_out[0]")
)
TESTS = """
import pytest
from mutabot_languages import load


@pytest.mark.parametrize("file", ["up.mod", "up.src", "up.script"])
def test_it_shuts_the_gripper(new_cell, mutabot_seed, file):
    cell = new_cell(mutabot_seed)
    load(file).run(cell)
    assert cell.gripper.opening() < 0.07
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name, text in PROGRAMS.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "cell_map.toml").write_text(SIGNALS)
    (tmp_path / "test_up.py").write_text(TESTS)
    (tmp_path / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (tmp_path / "mutabot.toml").write_text(
        f'program = {[*PROGRAMS]}\nvocabulary = ["cell"]\ntests = ["test_up.py"]\n'
        'families = ["program-text"]\n'
    )
    return tmp_path


def mutabot(folder: Path, *words: str) -> str:
    command = [sys.executable, "-m", "mutabot", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_check_is_found_that_notices_what_the_suite_does_not(project: Path) -> None:
    mutabot(project, "run", "--only", "reverse-offset", "--rounds", "2", "-o", "repeats=false")
    mutants = json.loads(mutabot(project, "results", "--json"))["mutants"]
    ends = {mutant["site"].partition(":")[0]: mutant["rounds"][0]["verdict"] for mutant in mutants}
    assert ends == dict.fromkeys(PROGRAMS, "survived")
    found = json.loads(mutabot(project, "suggest", "--json"))
    kills = [kill["mutant"]["id"] for suggestion in found["suggestions"] for kill in suggestion["kills"]]
    assert {name.partition(":")[0] for name in kills} == PROGRAMS.keys()
    assert found["unsolved"] == []
    assert ".z ==" in found["diff"]
