"""What noticed a mutant, in campaigns: groups, doctests, subtests, tear-downs, limits of the suite's own."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import By, Outcome, Verdict
from tests.campaign.engines.test_forking import facts
from tests.campaign.project import Quiet, outcomes, request_for, run, write_project

MOVES = """
    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    refusals = ["robot:Refused"]
"""
MISSION = '''
    import asyncio
    import time

    def step(arm):
        arm.move_by(0.125)

    def parts(arm):
        arm.move_by(0.125)

    def grouped(arm):
        arm.move_by(0.375)

    async def in_tasks(arm):
        async def move():
            arm.move_by(0.25)

        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(move())

    def gathers(arm):
        errors = []
        for dx in (0.25, 0.125):
            try:
                arm.move_by(dx)
            except Exception as error:
                errors.append(error)
        if errors:
            raise ExceptionGroup("mission failed", errors)

    def stalls(arm):
        arm.move_by(0.25)
        while arm.x < 0:
            time.sleep(0.01)

    def stalls_too(arm):
        arm.move_by(0.25)
        while arm.x < 0:
            time.sleep(0.01)

    def documented():
        """Where the arm is in the end.

        >>> from robot import Arm
        >>> arm = Arm()
        >>> step(arm)
        >>> arm.x
        0.125
        """
'''
TESTS = """
    import asyncio
    import unittest

    import mission
    import numpy
    import pytest
    from robot import Arm

    def test_in_tasks():
        arm = Arm(0.7)
        asyncio.run(mission.in_tasks(arm))
        assert arm.x > 0.9

    def test_gathers():
        arm = Arm(0.125)
        mission.gathers(arm)
        numpy.testing.assert_allclose(arm.x, 0.5)

    def test_asserts_in_a_group():
        arm = Arm()
        mission.grouped(arm)
        errors = []
        for bound in (0.25, 0.375):
            try:
                assert arm.x >= bound, f"not at {bound}"
            except AssertionError as error:
                errors.append(error)
        if errors:
            raise ExceptionGroup("checks", errors)

    @pytest.mark.timeout(2, method="signal")
    def test_stalls():
        arm = Arm()
        mission.stalls(arm)
        assert arm.x == 0.25

    @pytest.mark.timeout(2, method="thread")
    def test_stalls_too():
        arm = Arm()
        mission.stalls_too(arm)
        assert arm.x == 0.25

    class TestParts(unittest.TestCase):
        def test_parts(self):
            arm = Arm()
            mission.parts(arm)
            with self.subTest("skipped"):
                self.skipTest("not now")
            for bound in (0.0, 0.1):
                with self.subTest(bound=bound):
                    self.assertGreater(arm.x, bound)
"""
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    tests = ["tests", "mission.py"]
    pytest_args = ["-o", "pythonpath=.", "--doctest-modules"]
"""
CHECK, TIMEOUT, REFUSED = (Verdict.KILLED, By.CHECK), (Verdict.TIMEOUT, None), (Verdict.REFUSED, None)
EXPECTED = {
    "in_tasks": {"repeat": REFUSED, "reverse": CHECK},
    "gathers": {"reverse": CHECK},
    "grouped": {"reverse": CHECK},
    "step": {"reverse": CHECK},
    "parts": {"reverse": CHECK},
    "stalls": {"reverse": TIMEOUT},
    "stalls_too": {"reverse": TIMEOUT},
}


def by_function(found: dict[str, Outcome]) -> dict[str, dict[str, Outcome]]:
    table: dict[str, dict[str, Outcome]] = {}
    for mutant, outcome in found.items():
        parts = mutant.split(":")
        table.setdefault(parts[1].partition(".")[0], {})[parts[-1]] = outcome
    return table


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_both_engines_agree_on_groups_doctests_subtests_and_limits_of_the_suite(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS, vocabulary=MOVES, configuration=CONFIGURATION)
    found = run(folder, engine="auto", only=("*:reverse", "*in_tasks*:repeat"))
    some = ("*gathers*:reverse", "*:step:*:reverse", "*:stalls:*:reverse")
    alone = run(folder, engine="replay", fresh=True, only=some)
    assert len(alone) == len(some)
    assert {key: facts(found[key]) for key in alone} == {key: facts(value) for key, value in alone.items()}
    table = by_function(found)
    ends = {
        name: {operator: (outcome.verdict, outcome.by) for operator, outcome in row.items()}
        for name, row in table.items()
    }
    assert ends == EXPECTED
    engines = {name: {outcome.engine for outcome in row.values()} for name, row in table.items()}
    by_replay = {name for name, used in engines.items() if used == {"replay"}}
    # what a limit of wall clock ended on a busy machine was run once more, by replay
    again = {name for name, row in table.items() if any(outcome.beside for outcome in row.values())}
    assert again <= {"stalls", "stalls_too"}
    assert by_replay - again == {"stalls_too"} - again  # a thread cannot be forked
    assert (table["step"]["reverse"].message or "").startswith("arm.x: expected 0.125, got -0.125")
    assert table["in_tasks"]["repeat"].message == "1.2 is out of reach"
    assert table["stalls"]["reverse"].message == "Timeout (>2.0s) from pytest-timeout."
    overdue = table["stalls_too"]["reverse"].message or ""
    assert overdue.startswith("no end after 2 s of wall clock (pytest-timeout) during ")


LIMITED_TESTS = """
    import mission
    import pytest
    from robot import Arm

    MARK
    def test_it():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25
"""
SLOW_FORKS = """
    import time

    def run(arm):
        for _ in range(1):
            arm.move_by(0.25)
        time.sleep(0.7)
"""


@pytest.mark.usefixtures("plugins")
def test_a_fork_parent_that_waits_for_its_forks_is_not_overdue(tmp_path: Path) -> None:
    """Three forks of 0.7 s each, one at a time, in a test that may take 2 s."""
    tests = LIMITED_TESTS.replace("MARK", "@pytest.mark.timeout(2)")
    folder = write_project(tmp_path, SLOW_FORKS, tests, vocabulary=MOVES)
    progress = Quiet()
    found = outcomes(run_campaign(request_for(folder, jobs=1, engine="fork"), progress))
    assert {(outcome.verdict, outcome.by) for outcome in found} == {CHECK}
    assert not [line for line in progress.lines if "other tests" in line or "flaky" in line]


def test_a_watchdog_that_only_prints_does_not_keep_a_fork_parent_from_forking(tmp_path: Path) -> None:
    configuration = CONFIGURATION.replace('"--doctest-modules"', '"-o", "faulthandler_timeout=60"')
    tests = LIMITED_TESTS.replace("MARK", "")
    folder = write_project(tmp_path, SLOW_FORKS, tests, vocabulary=MOVES, configuration=configuration)
    found = run(folder, engine="fork", only=("*:skip",))
    assert {(outcome.verdict, outcome.by) for outcome in found.values()} == {CHECK}


TEAR_DOWNS = """
    import unittest

    import mission
    import pytest
    from robot import Arm

    @pytest.fixture(scope="module")
    def module_arm():
        arm = Arm()
        yield arm
        assert arm.x == 0.25, "the module's arm is left elsewhere"

    @pytest.fixture(scope="class")
    def class_arm():
        arm = Arm()
        yield arm
        assert arm.x == 0.25, "the class's arm is left elsewhere"

    class TestClass:
        def test_moves(self, class_arm):
            mission.of_class(class_arm)

    class TestUnit(unittest.TestCase):
        @classmethod
        def setUpClass(cls):
            cls.arm = Arm()

        def test_moves(self):
            mission.of_unit(self.arm)

        @classmethod
        def tearDownClass(cls):
            assert cls.arm.x == 0.25, "the unit's arm is left elsewhere"

    def test_of_module(module_arm):
        mission.of_module(module_arm)

    def test_stalls():
        arm = Arm()
        mission.stalls(arm)
        assert arm.x == 0.25
"""


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_an_assertion_in_a_shared_tear_down_is_a_check_and_a_watchdog_ends_in_a_time_out(
    tmp_path: Path,
) -> None:
    kinds = ("class", "unit", "module")
    mission = "\n".join(f"def of_{kind}(arm):\n    arm.move_by(0.25)\n" for kind in kinds)
    mission += "\ndef stalls(arm):\n    arm.move_by(0.25)\n    while arm.x < 0:\n        pass\n"
    watchdog = '"-o", "faulthandler_timeout=2", "-o", "faulthandler_exit_on_timeout=true"'
    configuration = CONFIGURATION.replace('"--doctest-modules"', watchdog)
    folder = write_project(tmp_path, mission, TEAR_DOWNS, vocabulary=MOVES, configuration=configuration)
    found = by_function(run(folder, engine="replay", only=("*:reverse",)))
    for kind in kinds:
        outcome = found[f"of_{kind}"]["reverse"]
        assert (outcome.verdict, outcome.by) == CHECK
        assert (outcome.message or "").startswith(f"the {kind}'s arm is left elsewhere")
    overdue = found["stalls"]["reverse"]
    assert overdue.verdict is Verdict.TIMEOUT
    assert (overdue.message or "").startswith("no end after 2 s of wall clock (faulthandler_timeout) during ")


MUTE = """
    class Mute(Exception):
        def __str__(self):
            raise RuntimeError("no text")

    class Arm:
        def __init__(self):
            self.x = 0.0

        def move_by(self, dx):
            self.x += dx
            if self.x < 0:
                raise Mute
"""
MUTE_TESTS = """
    import mission
    from robot import Arm

    def test_moves():
        mission.moves(Arm())
"""


def test_a_cause_that_fails_to_give_its_text_kills(tmp_path: Path) -> None:
    """Its text is computed by the program, and the mutant makes that fail as well."""
    mission = """
        class Lost(Exception):
            def __str__(self):
                return "~" * self.args[0]

        class Failed(Exception):
            pass

        def moves(arm):
            try:
                raise Lost(3)
            except Lost as error:
                raise Failed(str(error)) from error
    """
    tests = """
        import mission
        import pytest

        def test_moves():
            with pytest.raises(mission.Failed, match="~~~"):
                mission.moves(None)
    """
    folder = write_project(tmp_path, dedent(mission), tests, vocabulary=MOVES)
    found = run(folder, families=("conventional",), only=("*__str__*BSR",))
    assert {(outcome.verdict, outcome.engine) for outcome in found.values()} == {(Verdict.KILLED, "fork")}


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_a_mutant_in_the_comparison_of_values_is_not_reached_by_comparing_them(
    tmp_path: Path, engine: str
) -> None:
    """Its value and the original's are parts, which the program compares: each time it would begin anew."""
    mission = """
        COMPARED = []

        class Part:
            def __init__(self, name):
                self.name = name

            def __eq__(self, other):
                COMPARED.append(other)
                return len(self.name) == len(other.name)
    """
    tests = """
        import mission

        def test_equal():
            assert mission.Part("a") == mission.Part("b")
            assert len(mission.COMPARED) < 10
    """
    folder = write_project(tmp_path, dedent(mission), tests, vocabulary=MOVES)
    found = run(folder, families=("conventional",), only=("*__eq__*SVR=self",), engine=engine)
    assert {outcome.verdict for outcome in found.values()} <= {Verdict.SURVIVED, Verdict.NO_EFFECT}
    assert found


def test_the_original_beside_a_mutant_is_evaluated_without_the_mutant(tmp_path: Path) -> None:
    """The place comes back to itself: with the mutant in both, each level would double the time."""
    mission = """
        class Level:
            def __init__(self, number):
                self.number = number

            def __lt__(self, other):
                if self.number == 0 or other.number == 0:
                    return self.number < other.number
                less, fewer = Level(self.number - 1), Level(other.number - 1)
                return less < fewer
    """
    tests = """
        import mission

        def test_less():
            assert not mission.Level(40) < mission.Level(39)
    """
    folder = write_project(tmp_path, dedent(mission), tests, vocabulary=MOVES)
    found = run(folder, families=("conventional",), only=("*less < fewer*ROR=gt",))
    assert [(outcome.verdict, outcome.by) for outcome in found.values()] == [CHECK]


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_an_exception_that_fails_to_give_its_text_kills(tmp_path: Path, engine: str) -> None:
    mission = "def moves(arm):\n    arm.move_by(0.5)\n"
    vocabulary = MOVES.replace('refusals = ["robot:Refused"]', "")
    folder = write_project(tmp_path, mission, MUTE_TESTS, robot=MUTE, vocabulary=vocabulary)
    (found,) = run(folder, engine=engine, only=("reverse",)).values()
    assert (found.verdict, found.exception, found.message) == (Verdict.KILLED, "robot:Mute", "Mute")
