"""A mutant of a program's text is judged wherever the suite runs the program and looks at what came of it.

The program only computes: no call of the cell tells which tests run it. What each mutant does is worked out
by hand: 3 > 2, so that 3 + 4 = 7 is what the tests expect.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.command import mutabot

pytestmark = pytest.mark.usefixtures("forks")

PROGRAM = """MODULE Pick
  VAR num count := 0;
  PROC main()
    MoveL Offs(CRobT(),0,0,-20),v200,fine,tool0;
  ENDPROC
  PROC tally()
    count := 3;
    IF count > 2 THEN
      count := count + 4;
    ENDIF
  ENDPROC
ENDMODULE
"""
MOVES = """
def test_moves(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    load("pick.mod").run(cell)
    assert cell.time > 0
"""
HEAD = (
    "from mutabot_cell import Cell\nfrom mutabot_cell.fixtures import *\nfrom mutabot_languages import load\n"
)
CHILD = """
import sys
from mutabot_cell import Cell
from mutabot_languages import load
sys.exit(int(load("pick.mod").run(Cell(1), "tally").variables["count"]))
"""
#: where a suite runs the routine that only computes
SUITES = {
    "a test that calls nothing of the cell": """
def test_tally(new_cell, mutabot_seed):
    assert load("pick.mod").run(new_cell(mutabot_seed), "tally").variables["count"] == 7
""",
    "a fixture of the module, whose result a later test looks at": """
import pytest

@pytest.fixture(scope="module")
def counted():
    return load("pick.mod").run(Cell(1), "tally").variables["count"]

def test_of_the_fixture(counted):
    assert counted is not None

def test_tally(counted):
    assert counted == 7
""",
    "a process below a test": """
import subprocess, sys

def test_tally():
    assert subprocess.run([sys.executable, "child.py"]).returncode == 7
""",
    "the import of the tests": """
COUNTED = load("pick.mod").run(Cell(1), "tally").variables["count"]

def test_tally():
    assert COUNTED == 7
""",
}
VERDICTS = {
    "count := 3 deleted": "killed",
    "count := count + 4 deleted": "killed",
    "count > 2 → NOT (count > 2)": "killed",
    "count > 2 → count >= 2": "survived",
    "count > 2 → count <= 2": "killed",
    "count > 2 → count < 2": "killed",
    "count > 2 → count = 2": "killed",
    "count > 2 → count <> 2": "survived",
    "count > 2 → TRUE": "survived",
    "count > 2 → FALSE": "killed",
    "count → (-count)": "killed",
    "count + 4 → -(count + 4)": "killed",
    "2 → (-2)": "survived",
    "3 → -3": "killed",
    "4 → (-4)": "killed",
}


def verdicts(
    folder: Path, suite: str, engine: str, vocabulary: str, program: str = PROGRAM
) -> dict[str, tuple[str, str]]:
    """Verdict and message of each mutant of a project with this suite."""
    (folder / "pick.mod").write_text(program)
    (folder / "child.py").write_text(CHILD)
    (folder / "test_pick.py").write_text(HEAD + MOVES + suite)
    (folder / "pyproject.toml").write_text(
        f'[tool.mutabot]\nprogram = ["pick.mod"]\nvocabulary = {vocabulary}\ntests = ["test_pick.py"]\n'
        'families = ["program-conventional"]\n'
    )
    only = [word for name in ("drop-any", "insert-unary", "replace-relation") for word in ("--only", name)]
    done = mutabot(folder, "run", "--json", "--engine", engine, "-o", "repeats=false", *only)
    assert done.stdout, done.stderr
    found = {mutant["description"]: mutant["rounds"][0] for mutant in json.loads(done.stdout)["mutants"]}
    return {text: (end["verdict"], end.get("message") or "") for text, end in found.items()}


def ends(found: dict[str, tuple[str, str]]) -> dict[str, str]:
    """The verdicts alone: a mutant with no measured effect has survived."""
    return {text: "survived" if value[0] == "no effect" else value[0] for text, value in found.items()}


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
@pytest.mark.parametrize(
    "suite",
    [
        pytest.param(name, marks=() if not number else pytest.mark.whole)
        for number, name in enumerate(SUITES)
        if "import" not in name
    ],
)
def test_every_mutant_has_the_verdict_of_the_whole_suite(suite: str, engine: str, tmp_path: Path) -> None:
    assert ends(verdicts(tmp_path, SUITES[suite], engine, '["cell"]')) == VERDICTS


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_a_process_below_a_test_is_the_mutant_without_any_vocabulary_too(engine: str, tmp_path: Path) -> None:
    assert ends(verdicts(tmp_path, SUITES["a process below a test"], engine, "[]")) == VERDICTS


@pytest.mark.whole
def test_what_is_run_while_tests_are_imported_is_judged_by_replay(tmp_path: Path) -> None:
    assert ends(verdicts(tmp_path, SUITES["the import of the tests"], "replay", '["cell"]')) == VERDICTS


@pytest.mark.whole
def test_what_was_run_before_any_fork_is_no_verdict_of_a_fork(tmp_path: Path) -> None:
    found = verdicts(tmp_path, SUITES["the import of the tests"], "fork", '["cell"]')
    assert {verdict for verdict, _ in found.values()} == {"error"}
    assert all("was run before the first test" in text for _, text in found.values())


#: a program that goes out of reach where its condition does not hold
FAR = """MODULE Pick
  VAR num count := 0;
  PROC main()
    count := 3;
    IF count > 2 THEN
      MoveL Offs(CRobT(),0,0,-20),v200,fine,tool0;
    ELSE
      MoveL Offs(CRobT(),0,0,-9000),v200,fine,tool0;
    ENDIF
  ENDPROC
ENDMODULE
"""
CAUGHT = """
def test_it_does_not_come_that_far(new_cell, mutabot_seed):
    ends = False
    try:
        load("pick.mod").run(new_cell(mutabot_seed))
        ends = True
    except Exception:
        pass
    assert ends
"""


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
@pytest.mark.parametrize(
    ("motion", "suite", "verdict"),
    [
        ("MoveL FAR,v200", "", "refused"),
        pytest.param("MoveJ FAR,v200", "", "refused", marks=pytest.mark.whole),
        pytest.param("MoveL FAR,v200", CAUGHT, "killed", marks=pytest.mark.whole),
        # the function that asks for joint angles raises an error of the program: no motion was asked for
        pytest.param("MoveAbsJ CalcJointT(FAR,tool0),v200", "", "killed", marks=pytest.mark.whole),
    ],
)
def test_a_motion_that_the_mutants_text_asks_for_and_the_robot_refuses_is_no_kill(
    motion: str, suite: str, verdict: str, engine: str, tmp_path: Path
) -> None:
    far = motion.replace("FAR", "Offs(CRobT(),0,0,-9000)")
    program = FAR.replace("MoveL Offs(CRobT(),0,0,-9000),v200", far)
    found = ends(verdicts(tmp_path, suite, engine, '["cell"]', program))
    expected = {
        "count := 3 deleted": verdict,
        "count > 2 → NOT (count > 2)": verdict,
        "count > 2 → count >= 2": "survived",
        "count > 2 → count <= 2": verdict,
    }
    assert {text: found[text] for text in expected} == expected
