"""Operations that share a site, and have quantities of the same name."""

from __future__ import annotations

from pathlib import Path

from mutabot.model import Verdict
from tests.campaign.project import by_forks, write_project

ROBOT = """
    class Left:
        def see(self): return "red"

    class Right:
        def see(self): return "blue"
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Left.see"
    result = { kind = "label", values = ["red", "green", "blue"] }

    [[operation]]
    call = "robot:Right.see"
    result = { kind = "label", values = ["red", "green", "blue"] }
"""
MISSION = "def look(camera):\n    return camera.see()\n"
TESTS = """
    from mission import look
    from robot import Left, Right

    def test_both_see_their_colour():
        assert look(Left()) == "red"
        assert look(Right()) == "blue"
"""


def test_an_operator_sees_its_own_variant_where_the_id_holds_the_operation_as_well(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, vocabulary=VOCABULARY, robot=ROBOT)
    found = by_forks(tmp_path)
    site = "mission.py:look:camera.see#1:result:misread"
    assert {mutant: outcome.verdict for (mutant, _), outcome in found.items()} == {
        f"{site}={variant}": Verdict.KILLED for variant in ("+1", "+2", "+1+Right.see", "+2+Right.see")
    }
