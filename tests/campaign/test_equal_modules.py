"""Modules of equal text: each has its own mutants, which act in their own file alone."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.checking import plan_only
from mutabot.model import Mutant, Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

STATIONS = ("left", "right", "top")
STATION = """
    def approach(arm):
        arm.move_by(0.25)
        if arm.position() > 0.5:
            return "far"
        return "near"
"""
#: only the station on the left is checked
TESTS = """
    from mission import left, right, top
    from robot import Arm

    def test_left():
        arm = Arm()
        assert left.approach(arm) == "near"
        assert arm.x == 0.25

    def test_right():
        right.approach(Arm())

    def test_top():
        top.approach(Arm())
"""
CONFIGURATION = """
    program = ["mission"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
"""


def project(folder: Path) -> Path:
    texts = {f"mission/{name}.py": dedent(STATION) for name in STATIONS}
    write_project(folder, "", TESTS, configuration=CONFIGURATION, more={"mission/__init__.py": "", **texts})
    (folder / "mission.py").unlink()
    return folder


def by_file(mutants: list[Mutant]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for mutant in mutants:
        file = mutant.site.span.file
        found.setdefault(file, set()).add(mutant.id.removeprefix(file))
    return found


@pytest.mark.parametrize(
    "families",
    [
        pytest.param(("robot", "graded", "catalogue"), marks=pytest.mark.needs("catalogue")),
        pytest.param(("conventional",), marks=pytest.mark.needs("source")),
        pytest.param(("robot", "conventional"), marks=pytest.mark.needs("source")),
    ],
)
def test_modules_of_equal_text_have_the_same_mutants_each(tmp_path: Path, families: tuple[str, ...]) -> None:
    mutants = plan_only(request_for(project(tmp_path), families=families), Quiet()).mutants
    found = by_file(mutants)
    assert set(found) == {f"mission/{name}.py" for name in STATIONS}
    assert found["mission/left.py"] == found["mission/right.py"] == found["mission/top.py"]


def test_each_acts_in_its_own_file(tmp_path: Path) -> None:
    outcomes = by_forks(project(tmp_path), families=("robot",))
    for name in STATIONS:
        own = {id: outcome for (id, _), outcome in outcomes.items() if id.startswith(f"mission/{name}.py")}
        assert {outcome.test for outcome in own.values() if outcome.test} <= {
            f"tests/test_mission.py::test_{name}"
        }
        assert {outcome.verdict for outcome in own.values()} & {Verdict.KILLED, Verdict.SURVIVED}
        reverse = own[f"mission/{name}.py:approach:arm.move_by#1:dx:reverse"]
        assert reverse.verdict is (Verdict.KILLED if name == "left" else Verdict.SURVIVED)


@pytest.mark.whole
def test_calls_of_equal_text_on_one_line_are_distinguished(tmp_path: Path) -> None:
    """Python takes their code for equal: only the columns differ."""
    mission = """
        first, second = (lambda arm: arm.move_by(0.25)), (lambda arm: arm.move_by(0.25))
    """
    tests = """
        import mission
        from robot import Arm

        def test_first():
            arm = Arm()
            mission.first(arm)
            assert arm.x == 0.25

        def test_second():
            mission.second(Arm())
    """
    outcomes = by_forks(write_project(tmp_path, mission, tests), families=("robot",))
    verdicts = {
        (id.partition("#")[2][:1], outcome.verdict)
        for (id, _), outcome in outcomes.items()
        if id.endswith("reverse")
    }
    assert verdicts == {("1", Verdict.KILLED), ("2", Verdict.SURVIVED)}
