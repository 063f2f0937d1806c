"""What was compared on the way, and what tests that have nothing to do with a mutant add to it: nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.comparison import Observation, TraceCall, compare
from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome, Probe, Verdict
from mutabot.runtime.program_text.switches import Alternatives
from tests.campaign.project import REPLAY, Quiet, outcomes, request_for, write_project

MISSION = """
    class Simulation:
        def __init__(self):
            self.q = 0.0

        def angle(self):
            return self.q * 1.0

        def move(self, q):
            self.q = q

    def visit(simulation):
        simulation.move(0.5)
        simulation.move(0.0)

    def plan(x):
        return x + 1
    """
TESTS = """
    from mission import Simulation, plan, visit

    def test_visit():
        simulation = Simulation()
        visit(simulation)
        assert abs(simulation.q) < 0.9

    def test_plan():
        assert plan(2) == 3
    """
VOCABULARY = """
    [[operation]]
    call = "mission:Simulation.move"
    arguments.q = { kind = "rotation", axis = "j1", unit = "rad", mode = "to" }

    [[probe]]
    call = "mission:Simulation.angle"
    tolerance = 0.001
    """


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_probes_of_the_programs_own_classes_are_read_on_the_way(engine: str, tmp_path: Path) -> None:
    project = write_project(tmp_path, MISSION, TESTS)
    (project / "robot.toml").write_text(VOCABULARY)
    asked = request_for(
        project, engine=engine, rounds=1, families=("robot", "conventional"),
        only=("*visit:simulation.move#1:call:*", "*angle:*AOR=add"),
    )  # fmt: skip
    found = {outcome.mutant.rpartition(":")[2]: outcome for outcome in outcomes(run_campaign(asked, Quiet()))}
    skipped, repeated = found["skip"], found["repeat"]
    assert "on the way, after call 1" in (skipped.divergence or ("",))[0]
    # the other test makes no such object, and is none of this mutant's business
    assert (repeated.indistinguishable, repeated.gaps, _moments(repeated)) == (True, (), 3)
    # what a mutant of the probe itself does is seen in the end alone: it is not waited for on the way
    assert found["AOR=add"].verdict is not Verdict.ERROR


def _moments(outcome: Outcome) -> int:
    return outcome.compared.moments if outcome.compared is not None else 0


def test_a_moment_at_which_nothing_could_be_read_is_none() -> None:
    calls = [TraceCall("a", {}, {}, ("a", None))]
    nothing = Observation(calls, {"m:A.x": 1.0}, moments=((1, {}, True),))
    found = compare(nothing, nothing, [Probe("m:A.x", 0.1)])
    assert found.compared is not None
    assert found.compared.moments == 1  # at the end


def test_places_that_are_paused_are_the_originals_and_count_nothing() -> None:
    places = Alternatives(2)
    places.activate(1, 0)
    with places.paused():
        assert not places.switches[1].chosen()
    assert places.hits == {}
    assert places.switches[1].chosen()
