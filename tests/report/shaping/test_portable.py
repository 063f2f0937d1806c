"""What leaves the machine is fit for any format, and still fits together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.journal.records import Disagreement, Reaching, Verification
from mutabot.report.texts import portable
from report.material import HOSTILE, stored, with_text
from results import samples


@pytest.mark.parametrize("text", [*HOSTILE, "'/home/me/arm.urdf'", "\x1b[1mbold"])
def test_outcomes_and_reaching_tests_still_belong_to_their_mutants(tmp_path: Path, text: str) -> None:
    campaign = with_text(stored(tmp_path), text)
    sites = {stored_result.mutant.site.id: (0,) for stored_result in campaign.mutants}
    campaign = replace(campaign, reaching=Reaching((samples.TEST,), sites))
    for result in portable(campaign).mutants:
        assert {outcome.mutant for outcome in result.outcomes} == {result.mutant.id}
        assert portable(campaign).reached_by(result.mutant) == (samples.TEST,)


def test_a_program_s_own_text_and_its_columns_stay(tmp_path: Path) -> None:
    source = "\ufeffopen('/home/me/x')  # \x0c\x1b[1m"
    campaign = portable(replace(stored(tmp_path), sources={"mission.py": source}))
    assert campaign.source("mission.py") == "open('/home/me/x')  # ��[1m"


def test_what_is_fit_already_is_left_alone(tmp_path: Path) -> None:
    campaign = stored(tmp_path, draws=["noise"])
    made = portable(campaign)
    assert made.draws == ("noise",)
    assert (made.mutants, made.scores, made.sources) == (campaign.mutants, campaign.scores, campaign.sources)
    assert "root" not in made.meta


def test_what_came_out_otherwise_afresh_shows_nothing_of_the_machine(tmp_path: Path) -> None:
    campaign = stored(tmp_path)
    mutant = campaign.mutants[0].mutant
    root = campaign.meta["root"]
    other = Disagreement(mutant.id, 1, 0, "survived", f"killed: FileNotFoundError: '{root}/arm.urdf'")
    found = portable(replace(campaign, verification=Verification(1, 1, (other,)))).verification
    assert found is not None
    assert found.disagreements[0].mutant == mutant.id
    assert str(root) not in found.disagreements[0].second
    assert "arm.urdf" in found.disagreements[0].second
