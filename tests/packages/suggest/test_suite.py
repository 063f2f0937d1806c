"""A check that is suggested has the suite's own predicate, constants and tolerance."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.campaign.request import Request
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot_suggest.candidates import candidates
from mutabot_suggest.checks import CheckAtEnd, CheckOfSuite
from mutabot_suggest.forms import near_of
from mutabot_suggest.project import PlaceInTest, SuiteFiles, place_of
from mutabot_suggest.readings import PROBE, Measured, ReadExpression, readings_at
from mutabot_suggest.suite import SuiteChecks

from .projects import make

CHECKS = """
    HOME = 0.3
    WITHIN = 0.05


    def is_within(expected, seen, threshold):
        return abs(expected - seen) <= threshold


    def check_open(arm):
        assert not arm.closed
"""
TESTS = """
    import mission
    import pytest
    from checks import HOME, WITHIN, check_open, is_within
    from robot import Arm


    @pytest.fixture
    def arm():
        return Arm()


    def test_goes(arm):
        mission.by_function(arm)
        assert is_within(HOME, arm.x, 0.02)


    def test_opens(arm):
        arm.grip(False)
        check_open(arm)
        assert arm.z == pytest.approx(HOME, abs=WITHIN)


    def test_moves(arm):
        arm.move_by(x=0.3)
        assert mission.by_case(arm) is None
"""
GOES = "tests/test_it.py::test_goes"


@pytest.fixture
def suite(tmp_path: Path) -> SuiteChecks:
    """The checks of a project with a predicate, constants and a helper in a module of its own."""
    folder = make(tmp_path, {"test_it.py": TESTS, "checks.py": CHECKS})
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    request = Request(configuration, vocabulary, rounds=1, seed=1, jobs=1)
    return SuiteChecks.of(SuiteFiles(request, tests=("tests/test_it.py",)))


def place(suite: SuiteChecks, node: str = GOES) -> PlaceInTest:
    found = place_of(suite.project, node)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("assert a.x == pytest.approx(HOME.x, abs=T)", ("a.x", "HOME.x", "T")),
        ("assert pytest.approx(0.3, abs=0.1) == read()", ("read()", "0.3", "0.1")),
        ("assert abs(a.x - 0.3) < TOL", ("a.x", "0.3", "TOL")),
        ("assert abs(HOME.x - read().x) <= TOL", ("read().x", "HOME.x", "TOL")),
        ("assert is_within(HOME.x, read().x, threshold)", ("read().x", "HOME.x", "threshold")),
        ("assert math.isclose(arm.x, 0.3, abs_tol=0.01)", ("arm.x", "0.3", "0.01")),
        ("self.assertAlmostEqual(arm.x, 0.3, delta=0.05)", ("arm.x", "0.3", "0.05")),
        ("np.testing.assert_allclose(arm.pose, HOME, atol=0.01)", ("arm.pose", "HOME", "0.01")),
        ("assert is_within(a, b, c)", None),
        ("assert arm.x < 0.3", None),
        ("arm.move(0.1, 0.2, speed=0.3)", None),
    ],
)
def test_what_a_check_looks_at_and_how_near_it_must_be(text: str, parts: tuple[str, ...] | None) -> None:
    (node,) = ast.parse(text).body
    found = near_of(node)
    assert (None if found is None else tuple(map(ast.unparse, found))) == parts


def test_checks_note_what_they_compare_and_mean_the_same(suite: SuiteChecks) -> None:
    text = suite.with_recording("tests/test_it.py", suite.project.text("tests/test_it.py"))
    (check,) = [candidate for candidate in suite.checks if "is_within" in candidate.form]
    noted: list[Any] = []

    class Noted:
        @staticmethod
        def compared(key: str, role: str, value: object) -> object:
            noted.append((key, role, value))
            return value

    lines = [line.strip() for line in text.splitlines() if check.key in line]
    module: Any = type("module", (), {"recorder": Noted})
    arm: Any = type("arm", (), {"x": 0.31})
    names = {
        "__import__": lambda _: module,
        "HOME": 0.3,
        "arm": arm,
        "is_within": lambda a, b, c: abs(a - b) <= c,
    }
    exec("\n".join(lines), {"__builtins__": names} | names)
    assert noted == [
        (check.key, "expected", 0.3),
        (check.key, "actual", 0.31),
        (check.key, "tolerance", 0.02),
    ]


def test_checks_of_other_tests_are_asked_where_all_that_they_need_is_at_hand(suite: SuiteChecks) -> None:
    assert [check.statement for check in suite.reusable_checks(place(suite))] == [
        "check_open(arm)",
        "assert arm.z == pytest.approx(HOME, abs=WITHIN)",
    ]


def test_a_check_that_runs_the_program_or_commands_the_robot_is_not_asked_elsewhere(
    suite: SuiteChecks,
) -> None:
    statements = [
        check.statement for check in suite.reusable_checks(place(suite, "tests/test_it.py::test_opens"))
    ]
    assert statements == ["assert is_within(HOME, arm.x, 0.02)"]


@pytest.mark.parametrize(
    "check",
    [
        "assert arm.time < TIME",
        "assert arm.elapsed() < TIME",
        "assert is_within(TIME, arm.time, 0.5)",
        "in_time(arm)",
    ],
)
def test_a_deadline_of_another_test_is_not_asked_elsewhere(tmp_path: Path, check: str) -> None:
    text = f"""
        TIME = 3.0


        def is_within(expected, seen, threshold):
            return abs(expected - seen) <= threshold


        def in_time(arm):
            assert arm.time < TIME


        def test_goes(arm):
            assert arm.x


        def test_hurries(arm):
            {check}
            assert arm.z < TIME
    """
    folder = make(tmp_path, {"test_it.py": text})
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    request = Request(configuration, vocabulary, rounds=1, seed=1, jobs=1)
    suite = SuiteChecks.of(SuiteFiles(request, tests=("tests/test_it.py",)))
    assert [found.statement for found in suite.reusable_checks(place(suite))] == ["assert arm.z < TIME"]


@pytest.mark.parametrize("check", ["assert await arm.state() == 0", "assert (await arm.state()).x < 1.0"])
def test_what_must_be_awaited_is_read_and_asked_in_its_own_test_only(tmp_path: Path, check: str) -> None:
    text = f"""
        async def test_goes(arm):
            {check}
            assert arm.z < 1.0


        async def test_waits(arm):
            {check.replace("1.0", "0.5")}
            assert arm.z < 0.5
    """
    folder = make(tmp_path, {"test_it.py": text})
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    request = Request(configuration, vocabulary, rounds=1, seed=1, jobs=1)
    suite = SuiteChecks.of(SuiteFiles(request, tests=("tests/test_it.py",)))
    asked = [found.statement for found in suite.reusable_checks(place(suite))]
    assert asked == ["assert arm.z < 0.5"]
    assert "arm.z" in {reading.text for reading in readings_at(suite.project, place(suite))}
    assert not [
        reading.text for reading in readings_at(suite.project, place(suite)) if "await" in reading.text
    ]


def test_a_check_of_another_test_that_a_survivor_breaks_is_suggested_as_it_stands(suite: SuiteChecks) -> None:
    at = place(suite)
    opened, _ = suite.reusable_checks(at)
    found = Measured(
        originals={at: {(0, GOES): {opened.key: True}, (1, GOES): {opened.key: True}}},
        mutants={at: {"m": {(0, GOES): {opened.key: False}}}},
        readings={at: []},
        reusable_checks={at: suite.reusable_checks(at)},
    )
    ((check,), _) = candidates(suite.project, suite, found)
    assert isinstance(check, CheckOfSuite)
    assert check.statement == "check_open(arm)"
    assert check.trials == frozenset({("m", 0)})


def test_a_check_of_another_test_that_the_original_breaks_is_not_suggested(suite: SuiteChecks) -> None:
    at = place(suite)
    opened, _ = suite.reusable_checks(at)
    found = Measured(
        originals={at: {(0, GOES): {opened.key: True}, (1, GOES): {opened.key: False}}},
        mutants={at: {"m": {(0, GOES): {opened.key: False}}}},
        readings={at: []},
        reusable_checks={at: suite.reusable_checks(at)},
    )
    assert candidates(suite.project, suite, found)[0] == []


def reads(suite: SuiteChecks, actual: float, text: str, value: float) -> dict[str, Any]:
    """What is noted where the check of ``arm.x`` ran and a reading was made."""
    (check,) = [candidate for candidate in suite.checks if "is_within" in candidate.form]
    parts = {"actual": actual, "expected": 0.3, "tolerance": 0.02}
    return {f"{check.key}.{role}": number for role, number in parts.items()} | {text: value}


def suggested(
    suite: SuiteChecks, text: str, mutant: float, *, actual: float = 0.301
) -> tuple[list[str], dict[str, str]]:
    """The checks of one reading, which is 0.3 in the original."""
    at = place(suite)
    found = Measured(
        originals={at: {(round, GOES): reads(suite, 0.301, text, 0.3) for round in range(3)}},
        mutants={at: {"m": {(0, GOES): reads(suite, actual, text, mutant)}}},
        readings={at: [ReadExpression(text, PROBE, 0.001)]},
    )
    checks, refused = candidates(suite.project, suite, found)
    return [check.statement for check in checks if isinstance(check, CheckAtEnd)], refused


def test_a_check_of_the_same_quantity_has_the_suites_form_constant_and_tolerance(suite: SuiteChecks) -> None:
    statements, _ = suggested(suite, "world()['arm.x']", 0.5)
    assert statements == ['assert is_within(HOME, world()["arm.x"], 0.02)']


def test_no_check_is_tighter_than_one_of_the_same_quantity_under_another_name(suite: SuiteChecks) -> None:
    statements, refused = suggested(suite, "world()['place']", 0.31, actual=0.309)
    assert statements == []
    assert refused == {"m": "world()['place'] differs by 0.01, within your tolerance of 0.02"}


@pytest.mark.parametrize("name", ["y", "z"])
def test_parts_of_a_place_that_no_check_looks_at_have_the_tolerance_of_the_others(
    suite: SuiteChecks, name: str
) -> None:
    statements, refused = suggested(suite, f"tool.{name}", 0.315, actual=0.301)
    assert statements == []
    assert "your tolerance of 0.0" in refused["m"]


@pytest.mark.parametrize(
    ("beside", "value"),
    [(0.25, "PALLET[0]"), (0.2500001, "PALLET[0]"), (0.7, "0.35")],  # the last is another place
)
def test_an_item_that_a_constant_of_the_tests_states_is_written_by_its_name(
    tmp_path: Path, beside: float, value: str
) -> None:
    text = "FEEDER, PALLET = (0.1, 0.9), (0.35, 0.25)\n\n\ndef test_goes(pose):\n    assert pose\n"
    statements = _of_pose(tmp_path, text, {"pose[0]": 0.35, "pose[1]": beside}, {})
    assert f"assert pose[0] == pytest.approx({value}" in statements


@pytest.mark.parametrize(("height", "value"), [(0.4, "HOME.tilt"), (0.9, "0.0")])
def test_a_part_of_a_place_is_written_by_its_name_only_at_that_place(
    tmp_path: Path, height: float, value: str
) -> None:
    check = "assert (pose.z, pose.tilt) == pytest.approx((HOME.z, HOME.tilt), abs=0.01)"
    text = f"import pytest\n\nHOME = object()\n\n\ndef test_goes(pose):\n    {check}\n"
    parts = {"actual[0]": 0.4, "actual[1]": 0.0, "expected[0]": 0.4, "expected[1]": 0.0, "tolerance": 0.01}
    statements = _of_pose(tmp_path, text, {"pose.z": height, "pose.tilt": 0.0}, parts)
    assert any(statement.startswith("assert pose.tilt") and value in statement for statement in statements)


def _of_pose(tmp_path: Path, text: str, reads: dict[str, float], parts: Mapping[str, float]) -> set[str]:
    """The beginnings of the checks of what a test reads, all of which the mutant changes.

    ``parts``: what a check of the test compares.
    """
    folder = make(tmp_path, {"test_it.py": text})
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    request = Request(configuration, vocabulary, rounds=1, seed=1, jobs=1)
    suite = SuiteChecks.of(SuiteFiles(request, tests=("tests/test_it.py",)))
    at = place(suite)
    compared = {f"{check.key}.{part}": value for check in suite.checks for part, value in parts.items()}
    found = Measured(
        originals={at: {(round, GOES): {**reads, **compared} for round in range(3)}},
        mutants={at: {"m": {(0, GOES): {name: value - 0.7 for name, value in reads.items()}}}},
        readings={at: [ReadExpression(name, PROBE, 1e-6) for name in reads]},
    )
    checks, _ = candidates(suite.project, suite, found)
    return {check.statement.partition(",")[0] for check in checks}


def test_tests_of_a_folder_find_helpers_beside_them(suite: SuiteChecks) -> None:
    assert {"tests/test_it.py", "tests/checks.py"} <= {*suite.project.suite_files}
    assert "mission.py" not in suite.project.suite_files


def test_a_helper_of_another_file_is_imported_where_it_is_asked(tmp_path: Path) -> None:
    other = "from checks import check_open\n\n\ndef test_more(arm):\n    assert arm\n    check_open(arm)\n"
    mine = "import mission\n\n\ndef test_goes(arm):\n    mission.by_function(arm)\n"
    folder = make(tmp_path, {"test_it.py": mine, "test_more.py": other, "checks.py": dedent(CHECKS)})
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    request = Request(configuration, vocabulary, rounds=1, seed=1, jobs=1)
    found = SuiteChecks.of(SuiteFiles(request, tests=("tests/test_it.py",)))
    asked = {check.statement: check.needs for check in found.reusable_checks(place(found))}
    assert asked["check_open(arm)"] == ("from checks import check_open",)
