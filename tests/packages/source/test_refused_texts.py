"""Refusals of the robot are judged alike, whether a mutant is compiled in or really in its file."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Outcome, Verdict
from tests.campaign.project import ROBOT, VOCABULARY, no_private_files, run
from tests.plugins.test_faults import write

PROGRAM = """
    from contextlib import suppress

    from robot import Refused

    def near(arm):
        arm.move_by(0.5 * 0.75)

    def too_far(arm, tries):
        with suppress(Refused if tries < 3 else OSError): arm.move_by(5.0)

    def careful(arm):
        try:
            arm.move_by(0.25 + 0.5)
        except Refused:
            return False
        return True
"""
PROJECT = {
    "mutabot.toml": """
        program = ["imported.py", "read.py"]
        tests = ["tests"]
        families = ["conventional"]
        vocabulary = ["robot.toml"]
        """,
    "robot.toml": VOCABULARY,
    "robot.py": ROBOT,
    "imported.py": PROGRAM,
    "read.py": PROGRAM,
    "tests/test_it.py": """
        import inspect

        import imported
        import pytest
        import read
        from robot import Arm

        BOTH = pytest.mark.parametrize("program", [imported, read])

        def test_reads():
            assert inspect.getsource(read)

        @BOTH
        def test_near(program):
            program.near(Arm())

        @BOTH
        def test_too_far(program):
            program.too_far(Arm(), 2)

        @BOTH
        def test_careful(program):
            assert program.careful(Arm()) in (True, False)
        """,
}
ONLY = ("*:near:0.5 * 0.75#1:AOR=add", "*:too_far:tries < 3#1:ROR=*", "*:careful:0.25 + 0.5#1:AOR=div")


def test_a_refusal_is_outside_and_one_of_the_originals_is_judged(tmp_path: Path) -> None:
    if why := no_private_files():
        pytest.skip(why)
    found = run(write(tmp_path, PROJECT), families=("conventional",), only=ONLY, engine="auto")
    imported, read = (_of(found, file) for file in ("imported", "read"))
    assert {outcome.engine for outcome in read.values()} == {"replay"}
    # of a file that is really changed it is not known that this changes no value
    known = {
        name: Verdict.SURVIVED if outcome.verdict is Verdict.NO_EFFECT else outcome.verdict
        for name, outcome in imported.items()
    }
    assert {name: outcome.verdict for name, outcome in read.items()} == known
    assert read["near:0.5 * 0.75#1:AOR=add"].verdict is Verdict.REFUSED
    # the robot refuses that call in the original as well: what the program then does is for the tests
    of_original = read["too_far:tries < 3#1:ROR=gt"]
    assert (of_original.verdict, of_original.exception) == (Verdict.KILLED, "robot:Refused")


def _of(found: dict[str, Outcome], file: str) -> dict[str, Outcome]:
    return {name.partition(":")[2]: value for name, value in found.items() if name.startswith(file)}
