"""One branch is several mutants while they behave alike; their outcomes are those of replay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.execution.workers import Workers
from mutabot.model import Outcome, Verdict
from mutabot.model.events import BranchEnd
from tests.campaign.engines.test_branching import facts
from tests.campaign.project import Quiet, outcomes, request_for, run, write_project

pytestmark = pytest.mark.needs("source")

#: alternatives of the comparison are alike at first, and part when it is evaluated again
MISSION = """
    def is_far(distance):
        return distance > 0.5

    def run(arm):
        for step in (0.75, -0.25, -0.25, 0.125):
            arm.move_by(step)
            if is_far(arm.x):
                arm.move_by(-0.125)
        return arm.position()
"""
CHECK = """
    import mission
    from robot import Arm

    def test_it_stops_near():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25

    def test_it_keeps_near():
        arm = Arm(-0.75)
        mission.run(arm)
        assert arm.x == -0.375
"""
#: one of two that are alike at first ends its process later on
DEADLY = """
    import os

    def is_far(distance):
        return distance > 0.5

    def run(arm):
        arm.move_by(0.75)
        for distance in (0.25, 0.5, 0.25):
            if is_far(distance) and distance == 0.5:
                os._exit(3)
"""
DEADLY_CHECK = """
    import mission
    from robot import Arm

    def test_it_goes_there():
        mission.run(Arm())
"""


def both(folder: Path, **changes: Any) -> dict[str, Outcome]:
    """Outcomes by engine ``auto``, after comparing each with replay's."""
    found = {}
    for engine in ("auto", "replay"):
        path = run_campaign(
            request_for(folder, engine=engine, families=("classical",), rounds=1, **changes), Quiet()
        )
        found[engine] = {outcome.mutant: outcome for outcome in outcomes(path)}
    assert found["auto"].keys() == found["replay"].keys()
    for key, outcome in found["auto"].items():
        assert facts(outcome) == facts(found["replay"][key]), key
    return found["auto"]


@pytest.fixture
def alike(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Is told how many mutants report equal ends of equal branches, one after the other."""
    sizes: list[int] = []
    events = Workers.events

    def noted(self: Workers, tasks: Any) -> Any:
        before: list[BranchEnd] = []
        for event in events(self, tasks):
            if isinstance(event, tuple) and isinstance(event[1], BranchEnd):
                line = event[1]
                if before and before[-1].end == line.end:
                    before.append(line)
                    sizes.append(len(before))
                else:
                    before = [line]
            yield event

    monkeypatch.setattr(Workers, "events", noted)
    return sizes


def test_mutants_that_are_alike_share_a_branch_until_they_differ(tmp_path: Path, alike: list[int]) -> None:
    write_project(tmp_path, MISSION, CHECK)
    found = run(tmp_path, engine="branch", families=("classical",), only=("*:is_far:*",))
    assert {one.verdict for one in found.values()} == {Verdict.KILLED, Verdict.SURVIVED, Verdict.NO_EFFECT}
    assert alike, "no branch was several mutants"


@pytest.mark.whole
def test_mutants_that_share_a_branch_end_as_by_replay(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, CHECK)
    assert {one.verdict for one in both(tmp_path).values()} >= {Verdict.KILLED}


@pytest.mark.whole
def test_all_are_run_in_every_test_if_that_is_asked_for(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, CHECK)
    assert all(one.complete for one in both(tmp_path, every_test=True).values() if one.tests)


@pytest.mark.whole
def test_a_branch_of_several_that_dies_says_nothing_about_any_of_them(tmp_path: Path) -> None:
    write_project(tmp_path, DEADLY, DEADLY_CHECK)
    found = {engine: run(tmp_path, engine=engine, families=("classical",)) for engine in ("auto", "replay")}
    verdicts = {engine: {key: one.verdict for key, one in ends.items()} for engine, ends in found.items()}
    assert verdicts["auto"] == verdicts["replay"]
    ended = {one.engine for one in found["auto"].values() if one.tests or one.test}
    assert ended == {"branch", "replay"}
