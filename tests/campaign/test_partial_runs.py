"""Parts of a campaign are run again: mutants as the program has them, the original, a changed project."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.campaign.partial_runs import CampaignRun
from mutabot.errors import SelectionError
from tests.campaign.project import Quiet, request_for, write_project

MISSION = """
    def go(arm):
        arm.move_by(0.1)
        arm.move_by(0.2)
        return arm.position()
"""
TESTS = """
    from robot import Arm
    import mission

    def test_goes():
        assert mission.go(Arm()) > 0.2

    def test_stands():
        assert Arm().position() == 1.0
"""
GOES = ("test_mission.py::test_goes",)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write_project(tmp_path, MISSION, TESTS)


def test_all_mutants_of_known_places_are_active_though_the_plan_has_them_no_longer(project: Path) -> None:
    tests = (f"{next(project.rglob('test_*.py')).relative_to(project)}::test_goes",)
    request = request_for(project, rounds=1).changed(tests=tests)
    with CampaignRun.open(request, Quiet()) as campaign:
        planned = [mutant for mutant in campaign.planned.values() if mutant.operator == "skip"]
        assert len(planned) == 2
        # as an earlier campaign had them, of a magnitude that is not asked for now
        earlier = [replace(mutant, variant="old", number=mutant.number + 100) for mutant in planned]
        now = [campaign.current(mutant) for mutant in earlier]
        assert now == earlier
        assert [campaign.task(mutant, 0, campaign.baseline.suite(0)).job.mutant for mutant in now] == earlier
        elsewhere = replace(planned[0].site, text="arm.away")
        with pytest.raises(SelectionError, match=r"no test reaches \S*arm.away"):
            campaign.current(replace(planned[0], site=elsewhere))


def test_a_mutant_of_a_call_is_replayed_with_its_controls_after_a_campaign_of_another_family(
    project: Path,
) -> None:
    request = request_for(project).changed(tests=(f"tests/{GOES[0]}",))
    with CampaignRun.open(request, Quiet()) as campaign:
        earlier = next(mutant for mutant in campaign.planned.values() if mutant.operator == "skip")
    with CampaignRun.open(replace(request, families=("conventional",)), Quiet()) as campaign:
        assert earlier.id not in campaign.planned
        campaign.prove([campaign.current(earlier)])
        assert {(way, provider) for way, _, provider, _ in campaign.proven} == {("replay", "calls")}


def test_the_original_is_run_in_the_rounds_asked_for_also_if_tests_fail(project: Path) -> None:
    with CampaignRun.of_original(request_for(project), [0, 3], Quiet()) as results:
        found = {result.task.key: [end.outcome for end in result.ends] for result in results}
    assert found == {0: ["passed", "failed"], 3: ["passed", "failed"]}


def test_a_changed_request_has_other_tests_and_further_probes_and_leaves_the_first_alone(
    project: Path, tmp_path: Path
) -> None:
    request = request_for(project)
    before = request.vocabulary.probes
    changed = request.changed(root=tmp_path / "copy", tests=GOES, probes={"robot:place": 0.1})
    assert changed.root == tmp_path / "copy"
    assert changed.configuration.tests == GOES
    assert [(probe.target, probe.tolerance) for probe in changed.vocabulary.probes[len(before) :]] == [
        ("robot:place", 0.1)
    ]
    assert (request.root, request.vocabulary.probes) == (project, before)
