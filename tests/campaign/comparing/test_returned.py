"""What the program returns to its tests is part of what indistinguishable says."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Outcome, Verdict
from tests.campaign.project import VOCABULARY, by_forks, write_project

PROBED = VOCABULARY + '\n    [[probe]]\n    call = "robot:Arm.x"\n'
MISSION = """
    import time

    class Lost(Exception):
        pass

    def run(arm):
        arm.move_by(0.25)
        return {"moved": 1, "seen": [arm.position(), "m"]}

    def check(arm):
        place = arm.position()
        if place != 0.25:
            raise Lost(f"at {place}")

    def when(arm):
        str(arm.position())
        return time.perf_counter()
"""


def survivors(folder: Path, tests: str) -> dict[str, Outcome]:
    """Survivors of the first round by their ids, equal for both engines."""
    found = by_forks(write_project(folder, MISSION, tests, vocabulary=PROBED))
    return {mutant: outcome for (mutant, _), outcome in found.items() if outcome.verdict is Verdict.SURVIVED}


def test_a_mutant_that_changes_what_the_program_returns_can_be_distinguished(tmp_path: Path) -> None:
    tests = """
        import mission
        import pytest
        from robot import Arm

        def test_it_runs():
            arm = Arm()
            arm.x = 0.0
            mission.run(arm)
            try:
                mission.check(arm)
            except mission.Lost:
                pass
    """
    found = survivors(tmp_path, tests)
    negated = {mutant: value for mutant, value in found.items() if mutant.endswith(":negate")}
    (read,), (checked,) = (
        [negated[key] for key in negated if f":{name}:" in key] for name in ("run", "check")
    )
    assert (read.indistinguishable, read.distance) == (False, 0.0)
    assert read.divergence == ("run returned ['seen'][0] -0.25 instead of 0.25 (off by 0.5)",)
    assert checked.indistinguishable is False
    assert checked.divergence == ("check raised mission:Lost: at -0.25 only with the mutant",)


@pytest.mark.whole
def test_a_value_returned_to_a_fixture_is_compared(tmp_path: Path) -> None:
    """Also where the fixture is shared, so that in other runs another test sets it up."""
    tests = """
        import mission
        import pytest
        from robot import Arm

        @pytest.fixture(scope="module")
        def first():
            return mission.run(Arm())

        @pytest.fixture
        def second(first):
            return mission.run(Arm(0.5))

        def test_a_looks_at_something_else(first):
            assert first["moved"] == 1

        def test_b_looks_at_nothing(second):
            mission.when(Arm())
    """
    found = survivors(tmp_path, tests)
    negated = [value for mutant, value in found.items() if "run" in mutant and mutant.endswith(":negate")]
    assert [outcome.indistinguishable for outcome in negated] == [False]


@pytest.mark.needs("source")
@pytest.mark.whole
def test_notes_and_mutants_of_the_text_stand_in_the_same_functions(tmp_path: Path) -> None:
    """What is never twice the same is not compared, and the rest is."""
    tests = """
        import mission
        from robot import Arm

        def test_it_runs():
            mission.run(Arm())

        def test_when():
            mission.when(Arm(0.5))
    """
    folder = write_project(tmp_path, MISSION, tests, vocabulary=PROBED)
    found = by_forks(folder, families=("robot", "conventional"))
    returned = [outcome.divergence for (mutant, _), outcome in found.items() if "arm" not in mutant]
    assert any("run returned" in line for lines in returned for line in lines)
    negate = next(value for (mutant, _), value in found.items() if ":when:" in mutant and "negate" in mutant)
    assert negate.indistinguishable
    assert negate.compared is not None
    assert (negate.compared.calls, negate.compared.returned) == (1, 0)
