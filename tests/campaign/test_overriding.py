"""Campaigns on programs that call methods which override the vocabulary's."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.model import Verdict
from tests.campaign.project import Quiet, by_forks, request_for, write_project

#: as in Gymnasium: what stands around an environment is an environment, and calls no method of its base
ROBOT = """
    class Env:
        def step(self, action):
            raise NotImplementedError

    def home():
        pass

    class Cell(Env):
        def __init__(self): self.x = 0.0
        def step(self, action):
            self.x += action[0]
            return self.x

    class TimeLimit(Env):
        def __init__(self, env): self.env = env
        def step(self, action):
            return self.env.step(action)

    class Other(Env):
        def step(self, action):
            return self.x
"""
MISSION = """
    import robot

    def run(env):
        robot.home()
        return [env.step([0.25]) for _ in range(3)][-1]

"""
TESTS = """
    import mission
    from robot import Cell, Env, TimeLimit

    def test_wrapped():
        assert mission.run(TimeLimit(Cell())) == 0.75

    def test_made_here():
        class Double(Cell):
            def step(self, action):
                self.x += 2 * action[0]
                return self.x

        assert mission.run(TimeLimit(Double())) == 1.5
        assert mission.run(Double()) == 1.5
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Env.step"
    arguments."action[0]" = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:home"
"""


@pytest.mark.whole
def test_check_names_the_overriding_method_that_is_called(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)
    (line,) = [line for line in check(request_for(tmp_path), Quiet()).lines if line.startswith("note")]
    assert "robot:Env.step · call: it is replaced by robot:TimeLimit in 2 tests" in line
    assert "Double in 1 test" in line
    assert "robot:Cell" not in line
    assert "robot:Other" not in line


def test_overrides_make_mutants_of_the_methods_of_subclasses(tmp_path: Path) -> None:
    vocabulary = VOCABULARY.replace("arguments", "overrides = true\n    arguments")
    write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=vocabulary)
    found = {mutant: outcome for (mutant, _), outcome in by_forks(tmp_path).items() if "env.step" in mutant}
    assert {mutant.rpartition(":")[2] for mutant in found} >= {"reverse", "repeat"}
    assert {outcome.verdict for outcome in found.values()} == {Verdict.KILLED}
    reverse = next(outcome for mutant, outcome in found.items() if mutant.endswith("action[0]:reverse"))
    assert reverse.example == (0.25, -0.25)
    assert (reverse.hits, reverse.acted) == (3, 3)
