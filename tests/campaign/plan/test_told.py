"""What reports are told of a plan: what operators do, and which tests reach the sites."""

from __future__ import annotations

import pytest

from mutabot import operators
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.run import run_campaign
from mutabot.families import ROBOT
from mutabot.report.document import document
from mutabot.results.stored import StoredCampaign
from mutabot.results.stored import open as open_campaign
from tests.campaign.project import Quiet, request_for, write_project

pytestmark = pytest.mark.needs("source")

MISSION = """
    def there(arm):
        arm.move_by(0.25 + 0.25)

    def back(arm):
        arm.move_by(-0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_there():
        arm = Arm()
        mission.there(arm)
        assert arm.x == 0.5

    def test_there_and_back():
        arm = Arm()
        mission.there(arm)
        mission.back(arm)
        assert arm.x == 0
"""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> StoredCampaign:
    folder = write_project(tmp_path_factory.mktemp("told"), MISSION, TESTS)
    run_campaign(request_for(folder, families=(ROBOT, "conventional"), rounds=2), Quiet())
    return open_campaign(folder)


def test_every_operator_of_the_plan_says_what_it_does(campaign: StoredCampaign) -> None:
    used = {result.mutant.operator for result in campaign.mutants}
    assert {"reverse", "AOR"} <= used
    assert set(campaign.operators) == used
    summaries = {rule.name: rule.summary for rule in provider("source").rules()}
    assert campaign.operators["reverse"] == operators.operator("reverse").summary
    assert campaign.operators["AOR"] == summaries["AOR"]


def test_the_tests_that_reach_a_site_are_known_for_calls_and_for_program_text(
    campaign: StoredCampaign,
) -> None:
    both = ("tests/test_mission.py::test_there", "tests/test_mission.py::test_there_and_back")
    for result in campaign.mutants:
        is_there = result.mutant.site.span.function == "there"
        assert sorted(campaign.reached_by(result.mutant)) == sorted(both if is_there else both[1:]), result


def test_results_as_json_do_not_repeat_it(campaign: StoredCampaign) -> None:
    assert not {"operators", "reaching"} & set(document(campaign)["meta"])
