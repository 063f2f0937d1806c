"""Programs that write to what a reading returns: where that is the robot's own memory, that is a command."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import plan_only
from mutabot.model import Outcome, Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

pytestmark = pytest.mark.needs("catalogue")

ROBOT = """
    import numpy as np

    class Sim:
        def __init__(self):
            self._qpos = np.array([0.5, 0.5, 0.5])
            self.went = None

        @property
        def qpos(self):
            return self._qpos

        def joints(self):
            return self._qpos[:2]

        def pose(self):
            return [0.1, 0.2, 0.3]

        def go(self, pose):
            self.went = list(pose)
"""
#: writes to a view here, and where nobody can see it in the text
MISSION = """
    import tools

    def set_at_once(sim):
        sim.qpos[0] = 0.25

    def set_by_name(sim):
        view = sim.joints()
        view += 0.125

    def set_elsewhere(sim):
        tools.poke(sim.qpos)

    def set_first(sim):
        for number in range(2):
            view = sim.joints()
            if number == 0:
                tools.poke(view)

    def look(sim):
        return sim.qpos[0] > 0.0

    def lift(sim):
        pose = sim.pose()
        pose[2] += 0.5
        sim.go(pose)
"""
TOOLS = """
    def poke(view):
        view[1] = 0.75
"""
TESTS = """
    import mission
    import pytest
    from robot import Sim

    def test_set_at_once():
        sim = Sim()
        mission.set_at_once(sim)
        assert list(sim._qpos) == [0.25, 0.5, 0.5]

    def test_set_by_name():
        sim = Sim()
        mission.set_by_name(sim)
        assert list(sim._qpos) == [0.625, 0.625, 0.5]

    def test_set_elsewhere():
        sim = Sim()
        mission.set_elsewhere(sim)
        assert list(sim._qpos) == [0.5, 0.75, 0.5]

    def test_set_first():
        sim = Sim()
        mission.set_first(sim)
        assert list(sim._qpos) == [0.5, 0.75, 0.5]

    def test_look():
        assert mission.look(Sim())

    def test_lift():
        sim = Sim()
        mission.lift(sim)
        assert sim.went == pytest.approx([0.1, 0.2, 0.8])
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Sim.qpos"
    result."[0]" = { kind = "angle", axis = "j1", unit = "rad" }

    [[operation]]
    call = "robot:Sim.joints"
    result."[0:2]" = { kind = "angle", axis = "j1", unit = "rad" }

    [[operation]]
    call = "robot:Sim.pose"
    result."[2]" = { kind = "position", axis = "z", unit = "m" }
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("views")
    return write_project(
        folder, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY,
        more={"tools.py": TOOLS},
    )  # fmt: skip


@pytest.fixture(scope="module")
def outcomes(project: Path) -> dict[str, Outcome]:
    found = by_forks(project, families=("robot", "catalogue"))
    return {id.split(":", 1)[1]: value for (id, _), value in found.items()}


def test_readings_that_are_written_through_are_left_out_with_the_reason(project: Path) -> None:
    planned = plan_only(request_for(project, families=("robot", "catalogue", "graded")), Quiet())
    mutants, left_out = planned.mutants, planned.left_out
    functions = {mutant.site.span.function for mutant in mutants}
    assert functions == {"set_elsewhere", "set_first", "look", "lift"}
    for function in ("set_at_once", "set_by_name"):
        reasons = {
            omission.reason for omission in left_out if omission.id.startswith(f"mission.py:{function}:")
        }
        assert any("the robot's own memory" in reason for reason in reasons)


def test_a_write_to_a_copy_that_the_text_does_not_show_is_never_a_kill(outcomes: dict[str, Outcome]) -> None:
    found = {id: outcome for id, outcome in outcomes.items() if id.startswith("set_elsewhere:")}
    assert {outcome.verdict for outcome in found.values() if outcome.acted} == {Verdict.ERROR}
    negate = found["set_elsewhere:sim.qpos#1:[0]:negate"]
    assert "it wrote to a copy" in (negate.message or "")


def test_what_only_reads_is_judged_as_ever(outcomes: dict[str, Outcome]) -> None:
    assert outcomes["look:sim.qpos#1:[0]:negate"].verdict is Verdict.KILLED


def test_a_program_may_write_to_what_was_made_for_it(outcomes: dict[str, Outcome]) -> None:
    negate = outcomes["lift:sim.pose#1:[2]:negate"]
    assert (negate.verdict, negate.example) == (Verdict.KILLED, (0.3, -0.3))


def test_an_operator_that_remembers_hands_out_the_robots_own_where_it_changes_nothing(
    outcomes: dict[str, Outcome],
) -> None:
    """It remembers a copy; the program writes to what it gets at the first call, which is not mutated."""
    old = outcomes["set_first:sim.joints#1:[0:2]:old-reading=1"]
    assert (old.verdict, old.hits, old.acted) == (Verdict.SURVIVED, 2, 1)
