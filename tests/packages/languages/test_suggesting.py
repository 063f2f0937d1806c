"""`mutabot suggest` finds checks for survivors in robot programs, as it does for those in Python programs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests import command

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


@pytest.mark.parametrize("file", FILES)
def test_it_shuts_the_gripper(new_cell, mutabot_seed, file):
    cell = new_cell(mutabot_seed)
    load(file).run(cell)
    assert cell.gripper.opening() < 0.07
"""


def write_project(folder: Path, files: list[str]) -> None:
    for name in files:
        (folder / name).write_text(PROGRAMS[name])
    (folder / "cell_map.toml").write_text(SIGNALS)
    (folder / "test_up.py").write_text(TESTS.replace("FILES", repr(files)))
    (folder / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (folder / "mutabot.toml").write_text(
        f'program = {files}\nvocabulary = ["cell"]\ntests = ["test_up.py"]\nfamilies = ["program-text"]\n'
    )


def mutabot(folder: Path, *words: str) -> str:
    done = command.mutabot(folder, *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.whole
@pytest.mark.parametrize("files", [["up.src"], [*PROGRAMS]], ids=["krl", "all"])
def test_a_check_is_found_that_notices_what_the_suite_does_not(tmp_path: Path, files: list[str]) -> None:
    write_project(tmp_path, files)
    mutabot(tmp_path, "run", "--only", "reverse-offset", "--rounds", "2", "-o", "repeats=false")
    mutants = json.loads(mutabot(tmp_path, "results", "--json"))["mutants"]
    ends = {mutant["site"].partition(":")[0]: mutant["rounds"][0]["verdict"] for mutant in mutants}
    assert ends == dict.fromkeys(files, "survived")
    found = json.loads(mutabot(tmp_path, "suggest", "--json"))
    kills = [kill["mutant"]["id"] for suggestion in found["suggestions"] for kill in suggestion["kills"]]
    assert {name.partition(":")[0] for name in kills} == {*files}
    assert found["unsolved"] == []
    assert ".z ==" in found["diff"]
