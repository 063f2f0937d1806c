"""Mutants in a program whose values have operators of their own: none of these runs but by the program.

What a mutant changes is told by comparing its value with the original's. Neither to have the original's nor
to compare them may run anything of the program: what its operators do, or count, would be done twice.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

MISSION = """
    class Task:
        def __init__(self, name):
            self.name, self.compared, self.added = name, 0, 0

        def __eq__(self, other):
            self.compared += 1
            return True

        def __add__(self, other):
            self.added += 1
            return 7.0

        def __sub__(self, other):
            return 8.0

    def total(first, second):
        return first + second

    def chosen(first, second):
        return first

    def mirrored(height):
        return -height

    def sorted_out(number):
        good = []
        bad = []
        good.append(number)
        return good, bad

    def pair(whole, broken):
        return whole
"""
TESTS = """
    import math

    import mission
    from mission import Task

    def test_total():
        first, second = Task("first"), Task("second")
        assert mission.total(first, second)
        assert first.added == {added}

    def test_chosen():
        first, second = Task("first"), Task("second")
        mission.chosen(first, second)
        assert first.compared == second.compared == 0

    def test_mirrored():
        assert math.copysign(1, mission.mirrored(0.0)) {sign} 0

    def test_sorted_out():
        good, bad = mission.sorted_out(4)
        assert good + bad == [4]
        {sorted_out}

    def test_pair():
        assert mission.pair((1, 2), (1.0, 2.0)) == (1, 2)
        {pair}
"""
#: what a suite looks at that is strict, and one that is not
STRICT = {
    "added": "1", "sign": "<", "sorted_out": "assert good == [4]",
    "pair": "assert str(mission.pair((1, 2), (1.0, 2.0))) == '(1, 2)'",
}  # fmt: skip
LAX = {"added": "first.added", "sign": "!=", "sorted_out": "pass", "pair": "pass"}
#: mutants by which suites notice them: the text of each was edited by hand for plain pytest
BY_STRICT = (
    "*total:first + second*AOR=sub",
    "*mirrored:-height*UOD",
    "*:good#1*SVR=bad",
    "*:whole*SVR=broken",
)
BY_NONE = ("*chosen:first*SVR=second",)


@pytest.mark.parametrize("engine", ["fork", REPLAY])
@pytest.mark.parametrize(("suite", "noticed"), [(STRICT, Verdict.KILLED), (LAX, Verdict.SURVIVED)])
def test_what_a_mutant_changes_is_described_without_the_programs_operators(
    tmp_path: Path, suite: dict[str, str], noticed: Verdict, engine: str
) -> None:
    folder = write_project(tmp_path, dedent(MISSION), dedent(TESTS).format_map(suite))
    found = run(folder, families=("conventional",), only=(*BY_STRICT, *BY_NONE), engine=engine)
    verdicts = {mutant: outcome.verdict for mutant, outcome in found.items()}
    assert len(verdicts) == len(BY_STRICT) + len(BY_NONE)
    of_chosen = verdicts.pop(next(mutant for mutant in verdicts if ":chosen:" in mutant))
    assert set(verdicts.values()) == {noticed}
    assert of_chosen is Verdict.SURVIVED
