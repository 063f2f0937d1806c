"""What tests check is noted with the values compared, and nothing of them runs more often or differently."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.model import Check, Verdict
from tests.campaign.project import run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        str(arm.position())
    """
#: the reading is that of a sensor: each look takes a number that the next one does not find
START = """
    import math
    import unittest
    from collections import namedtuple

    import numpy as np
    import pytest
    from mission import run
    from robot import Arm

    class Sensor:
        def __init__(self, arm):
            self.arm, self.reads = arm, 0

        @property
        def x(self):
            self.reads += 1
            return self.arm.x

        def __repr__(self):
            raise RuntimeError("nobody asked for words")

    def sensor():
        arm = Arm()
        run(arm)
        return Sensor(arm)

"""

HELPERS = """
    Pair = namedtuple("Pair", "one other")

    def is_near(value, wanted, by=0.1):
        return abs(value - wanted) <= by

"""
#: assertion, or statement of a TestCase, to the values that it compares and how far they are apart
ASSERTIONS: dict[str, tuple[str | None, float | None]] = {
    "sensor().x < 0.3": ("0.25 < 0.3", 0.05),
    "len('äß') * sensor().x < 0.8": ("0.5 < 0.8", 0.3),
    "0.2 <= sensor().x <= 0.3": ("0.2 <= 0.25", 0.05),
    "sensor().x == pytest.approx(0.26, abs=0.05)": ("0.25 == approx(0.26)", 0.04),
    "[sensor().x, 1.0] == pytest.approx([0.26, 1.0], abs=0.05)": ("[0.25, 1.0] == approx([0.26, 1.0])", 0.04),
    "{'x': sensor().x} == pytest.approx({'x': 0.26}, abs=0.05)": ("{'x': 0.25} == approx({'x': 0.26})", 0.04),
    "np.array([sensor().x]) == pytest.approx(np.array([0.26]), abs=0.05)": (None, 0.04),
    "abs(sensor().x - 0.26) <= 0.05": ("0.01 <= 0.05", 0.04),
    "math.isclose(sensor().x, 0.26, abs_tol=0.05)": ("0.25, 0.26, abs_tol=0.05", None),
    "is_near(sensor().x, 0.26, by=0.05)": ("0.25, 0.26, by=0.05", None),
    "sensor().x == 0.25": ("0.25 == 0.25", None),
    "(sensor().x, 2 / 3) != (sensor().x, 1 / 3)": ("(0.25, 0.666667) != (0.25, 0.333333)", None),
    "str(sensor().x) in ('0.25', 'a')": ("'0.25' in ('0.25', 'a')", None),
    "{'x': [sensor().x]} == {'x': [0.25]}": ("{'x': [0.25]} == {'x': [0.25]}", None),
    "Pair(1, 2) == Pair(1, 2)": ("", None),
    "isinstance(sensor(), Sensor)": ("", None),
    "hasattr(sensor(), 'x')": ("…, 'x'", None),
    "sensor() is not None": ("", None),
}
COMPARISONS: dict[str, tuple[str | None, float | None]] = {
    "self.assertAlmostEqual(sensor().x, 0.26, delta=0.05)": ("", None),
    "self.assertTrue(sensor().x)": ("", None),
    "self.assertRaises(ValueError, int, 'a')": ("…, …, 'a'", None),
    "np.testing.assert_allclose(sensor().x, 0.26, rtol=0, atol=0.05)": ("", None),
}


def looked_at(folder: Path, tests: str) -> dict[str, tuple[Check, ...]]:
    """The checks of each test of a mutant that nobody notices, by the test's name."""
    project = write_project(folder, MISSION, dedent(START) + dedent(HELPERS) + dedent(tests))
    (survivor,) = run(project, fresh=True, rounds=1, only=("*:negate",)).values()
    assert survivor.verdict is Verdict.SURVIVED
    assert all(test.acted for test in survivor.looked)
    return {test.test.rpartition(":")[2]: test.checks for test in survivor.looked}


def test_a_check_shows_what_it_compared(tmp_path: Path) -> None:
    asserted = "".join(f"    assert {assertion}\n" for assertion in ASSERTIONS)
    compared = "".join(f"        {comparison}\n" for comparison in COMPARISONS)
    tests = (
        f"def test_asserts():\n{asserted}\nclass TestIt(unittest.TestCase):\n    def test_compares(self):\n"
    )
    lines = (dedent(START) + dedent(HELPERS) + tests + compared).splitlines()
    found = looked_at(tmp_path, tests + compared)
    for name, wanted in (("test_asserts", ASSERTIONS), ("test_compares", COMPARISONS)):
        assert [noted.text for noted in found[name]] == list(wanted)
        for check in found[name]:
            seen, spare = wanted[check.text]
            assert seen is None or check.seen == seen, check.text
            assert check.spare == (pytest.approx(spare) if spare is not None else None), check.text
            file, line = check.place.split(":")
            assert file == "tests/test_mission.py"
            assert check.text in lines[int(line) - 1]


def test_parts_of_an_assertion_and_rounds_of_a_loop_are_reported_once(tmp_path: Path) -> None:
    found = looked_at(
        tmp_path,
        """
        def test_parts():
            assert not sensor().x > 1 and (sensor().x < 0.3 or sensor().x == 7)

        def test_loop():
            x = sensor().x
            for limit in (1.0, 0.3, 2.0):
                assert x < limit
        """,
    )
    assert [(check.text, check.seen) for check in found["test_parts"]] == [
        ("sensor().x > 1", "0.25 > 1"),
        ("sensor().x < 0.3", "0.25 < 0.3"),
    ]
    assert [(check.seen, check.times) for check in found["test_loop"]] == [("0.25 < 0.3", 3)]


def test_a_check_over_several_lines_reads_as_if_it_stood_on_one(tmp_path: Path) -> None:
    found = looked_at(
        tmp_path,
        """
        def test_lines():
            assert sensor().x == pytest.approx(
                0.25, abs=max(
                    [0.1]
                )
            )
        """,
    )
    assert [check.text for check in found["test_lines"]] == [
        "sensor().x == pytest.approx(0.25, abs=max([0.1]))"
    ]


def test_a_check_before_the_fault_is_reached_is_no_check_of_it(tmp_path: Path) -> None:
    found = looked_at(
        tmp_path,
        """
        def test_before_and_after():
            arm = Arm()
            for _ in range(2):
                assert arm.x < 0.3
                assert is_near(arm.x, 0.0, by=1.0)
                run(arm)
            assert arm.x < 0.6

        def test_before():
            arm = Arm()
            assert arm.x == 0
            run(arm)
        """,
    )
    assert [(check.text, check.seen, check.times) for check in found["test_before_and_after"]] == [
        ("arm.x < 0.3", "0.25 < 0.3", 1),
        ("is_near(arm.x, 0.0, by=1.0)", "0.25, 0, by=1", 1),
        ("arm.x < 0.6", "0.5 < 0.6", 1),
    ]
    assert found["test_before"] == ()


def test_nothing_is_worked_out_twice(tmp_path: Path) -> None:
    tests = """
        def test_reads():
            found = sensor()
            assert found.x < 0.3 and (found.x > 0.1 or found.x > 7)
            assert found.reads == 2
            assert (x := found.x) < 0.3 and (0.2 < (y := found.x) < 0.3) and is_near(z := found.x, y)
            assert (found.reads, x, y, z) == (5, 0.25, 0.25, 0.25)
            assert is_near(*[found.x, 0.25], **{"by": found.x})
            assert found.reads == 7
        """
    assert len(looked_at(tmp_path, tests)["test_reads"]) >= 3


def test_a_check_that_fails_says_what_it_ever_said(tmp_path: Path) -> None:
    tests = """
        def test_asserts():
            x = sensor().x
            assert x == 0.25, "too near"

        def test_compares():
            unittest.TestCase().assertEqual(sensor().x, 0.25)

        def test_numpy():
            np.testing.assert_allclose(sensor().x, 0.25)
        """
    text = dedent(START) + dedent(tests)
    project = write_project(tmp_path, MISSION, text)
    (found,) = run(project, fresh=True, rounds=1, only=("*:reverse",), every_test=True).values()
    wanted = ("too near\nassert -0.25 == 0.25", "-0.25 != 0.25", "Not equal to tolerance")
    assert [str(killing.by) for killing in found.kills] == ["check"] * 3
    for kill, message in zip(found.kills, wanted, strict=True):
        assert message in (kill.message or "")
    assert found.place is not None
    assert "assert x == 0.25" in text.splitlines()[int(found.place.rpartition(":")[2]) - 1]
