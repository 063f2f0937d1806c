"""Checks at the ends of the tests that there are, in every style: pytest runs them."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.request import Request
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot_suggest.checks import CheckAtEnd
from mutabot_suggest.project import OTHER, SuiteFiles, place_of
from mutabot_suggest.proof import texts_with
from mutabot_suggest.readings import ORACLE, PROBE, ReadExpression, readings_at

from .projects import STYLES, make, passes, patched

NODES = {
    "pytest": "tests/test_functions.py::test_goes_along_the_rail[True]",
    "unittest": "tests/test_cases.py::MissionTest::test_goes_along_the_rail",
    OTHER: "tests/test_steps.py::test_it_goes_along_the_rail",
}


@pytest.fixture
def project(tmp_path: Path) -> SuiteFiles:
    """The project with tests in three styles."""
    folder = make(tmp_path)
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, folder)
    return SuiteFiles(Request(configuration, vocabulary, rounds=1, seed=1, jobs=1))


def checks(project: SuiteFiles, style: str) -> list[CheckAtEnd]:
    """That the arm is where it is to be at the end."""
    place = place_of(project, NODES[style])
    assert place is not None
    assert place.style == style
    at_end = "self.arm.z" if style == "unittest" else "arm.z"
    reading = ReadExpression(at_end, PROBE, 0.01)
    return [CheckAtEnd(place=place, reading=reading, value=0.4, runs=3, spread=0.002, tolerance=0.02)]


def test_added_checks_pass_on_the_original_and_notice_a_fault(project: SuiteFiles) -> None:
    found = [check for style in STYLES.values() for check in checks(project, style)]
    texts = texts_with(project, found)
    patched(project.root, project.diff(texts))
    assert {file: (project.root / file).read_text() for file in texts} == texts
    assert passes(project.root) == (0, len(NODES) + 3)

    program = project.root / "mission.py"
    program.write_text(program.read_text().replace("z=-0.1", "z=-0.2"))
    failed, _ = passes(project.root)
    assert failed == len(NODES) + 1, "each test with a check fails, with both of its parameters"


def test_a_check_leaves_the_rest_of_the_file_as_it_is(project: SuiteFiles) -> None:
    file = project.root / "tests" / "test_functions.py"
    file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n") + "# ü".encode())
    before = file.read_bytes().decode().splitlines(keepends=True)
    (text,) = texts_with(project, checks(project, "pytest")[:1]).values()
    after = text.splitlines(keepends=True)
    assert [line for line in after if line in before] == before
    assert all(line.endswith("\r\n") for line in after[:-1])


def test_readings_of_what_the_tests_compare_have_the_quotes_of_all_others(project: SuiteFiles) -> None:
    place = place_of(project, NODES["pytest"])
    assert place is not None
    file = project.root / place.file
    compared = """assert arm.seen["x"] > 0 and arm.seen['y'] > 0 and arm.seen["it's"] > 0"""
    file.write_text(f"{file.read_text()}\n\ndef test_more(arm):\n    {compared}\n")
    texts = {reading.text for reading in readings_at(SuiteFiles(project.request), place)}
    assert {'arm.seen["x"]', 'arm.seen["y"]', """arm.seen["it's"]"""} <= texts


def test_what_the_tests_compare_is_read_where_its_names_are_at_hand(project: SuiteFiles) -> None:
    place = place_of(project, NODES["pytest"])
    assert place is not None
    file = project.root / place.file
    compared = "arm.z > 0 and cup.z > 0 and arm.state()['x'] > len(arm.log)"
    file.write_text(f"{file.read_text()}\n\ndef test_more(arm, cup):\n    assert {compared}\n")
    texts = {
        reading.text for reading in readings_at(SuiteFiles(project.request), place) if reading.way == ORACLE
    }
    assert texts == {"arm.x", "arm.z", "arm.log", "len(arm.log)"}
