"""What a test may look at is in a fork as in the original, or replay judges what the test does."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.model import Verdict
from tests.campaign.project import REPLAY, run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)
        arm.move_by(-0.5)
"""
TESTS = """
    import gc
    import os
    import weakref

    import pytest

    import mission
    from robot import Arm

    def numbers():
        return sorted(os.listdir("/proc/self/fd"))

    @pytest.fixture(autouse=True)
    def leaves_nothing_open():
        before = numbers()
        yield
        assert numbers() == before

    def test_run():
        arm = Arm()
        arm.itself, known, count = arm, weakref.ref(arm), len(gc.get_referrers(os))
        mission.run(arm)
        assert len(gc.get_referrers(os)) == count
        del arm
        gc.collect()
        assert known() is None

    def test_runs_again():
        mission.run(Arm())
"""
ASKS = """
    import gc
    import weakref
    from gc import collect, get_freeze_count

    import mission
    from robot import Arm

    def test_count_of_frozen_objects():
        mission.run(Arm())
        assert gc.get_freeze_count() == get_freeze_count() == 0

    def test_freezing():
        gc.freeze()
        mission.run(Arm())
        assert gc.get_freeze_count()
        gc.unfreeze()
        assert not gc.get_freeze_count()

    def test_objects_of_a_generation():
        mission.run(Arm())
        assert any(one is mission.__dict__ for one in gc.get_objects(generation=2))

    def test_what_was_made_while_the_program_was_imported_is_collected():
        known = weakref.ref(mission.TOOL)
        mission.run(Arm())
        del mission.TOOL
        collect()
        assert known() is None
"""
COLLECTS = "test_what_was_made_while_the_program_was_imported_is_collected"
OTHERS = [test for test in re.findall(r"def (test_\w+)", ASKS) if test != COLLECTS]
TOOL = """
    class Tool:
        def __init__(self):
            self.itself = self

    TOOL = Tool()
"""


def test_a_fork_has_the_descriptors_of_its_parent_and_what_the_collector_sees(tmp_path: Path) -> None:
    found = run(write_project(tmp_path, MISSION, TESTS), engine="fork", only=("skip", "repeat"))
    assert len(found) == 4
    assert {outcome.verdict for outcome in found.values()} == {Verdict.SURVIVED}


OPENS = """
    import os

    import mission
    from robot import Arm

    FILE = open(__file__)

    def test_what_is_opened_gets_one_number_after_the_other():
        numbers = [os.open(os.devnull, os.O_RDONLY) for _ in range(50)]
        assert numbers == list(range(numbers[0], numbers[0] + 50))
        mission.run(Arm())
        for number in numbers:
            os.close(number)
"""


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_descriptors_of_ours_leave_no_holes_in_the_numbers_of_the_tests(tmp_path: Path, engine: str) -> None:
    found = run(write_project(tmp_path, MISSION, OPENS), engine=engine, only=("skip",))
    assert {outcome.verdict for outcome in found.values()} == {Verdict.SURVIVED}


@pytest.mark.parametrize(
    "test", [COLLECTS, *(pytest.param(other, marks=pytest.mark.whole) for other in OTHERS)]
)
def test_whoever_asks_the_collector_first_finds_nothing_frozen(tmp_path: Path, test: str) -> None:
    first, *tests = re.split(r"(?=    def test_)", ASKS)
    (asks,) = (text for text in tests if text.startswith(f"    def {test}("))
    found = run(write_project(tmp_path, TOOL + MISSION, first + asks), engine="fork", only=("skip", "repeat"))
    assert {outcome.verdict for outcome in found.values()} == {Verdict.SURVIVED}


COLLECTS_FROZEN = """
import gc

if {is_frozen}:
    gc.freeze()
from mutabot.runtime.isolation import collector

collector.watch()
collector.freeze()
gc.collect()
print(gc.get_freeze_count() > 0)
"""


@pytest.mark.parametrize("is_frozen", [True, False])
def test_objects_that_the_program_has_frozen_and_no_others_stay_frozen(is_frozen: bool) -> None:
    script = [sys.executable, "-c", COLLECTS_FROZEN.format(is_frozen=is_frozen)]
    found = subprocess.run(script, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == str(is_frozen)


LEAVES = """
    from robot import Arm

    class Held(Arm):
        def __del__(self):
            if self.x:
                raise RuntimeError("it is not at home")

    ARM = Held()
    ARM.itself = ARM
"""
THROWS_AWAY = """
    import mission

    def test_run():
        mission.run(mission.ARM)
        del mission.ARM
"""


#: warnings are errors until pytest's clean-up begins
FOR_A_TIME = """
import contextlib
import warnings

def pytest_configure(config):
    stack = contextlib.ExitStack()
    stack.enter_context(warnings.catch_warnings())
    warnings.simplefilter("error")
    config.add_cleanup(stack.close)
"""


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("pytest.ini", "[pytest]\nfilterwarnings = error\n"),
        pytest.param("conftest.py", FOR_A_TIME, marks=pytest.mark.whole),
    ],
)
def test_a_finalizer_that_raises_at_the_end_kills_where_warnings_are_errors(
    file: str, text: str, tmp_path: Path
) -> None:
    folder = write_project(tmp_path, LEAVES + MISSION, THROWS_AWAY)
    (folder / file).write_text(text)
    found = run(folder, engine="fork", only=("skip",))
    assert [outcome.verdict for outcome in found.values()] == [Verdict.KILLED, Verdict.KILLED]


UNLIKE = """
    import os
    import time

    import mission
    from robot import Arm

    def test_alike():
        mission.forgets(Arm())

    def test_time():
        before = time.process_time()
        mission.moves(Arm())
        assert time.process_time() >= before

    def test_parent():
        assert os.getppid() != 0
"""
FUNCTIONS = """
    def forgets(arm):
        arm.move_by(0.5)

    def moves(arm):
        arm.move_by(0.5)
"""


def test_where_an_identity_fails_in_a_fork_replay_judges(tmp_path: Path) -> None:
    if os.geteuid():
        pytest.skip("only root's forks have a parent of another namespace")
    found = run(write_project(tmp_path, FUNCTIONS, UNLIKE), engine="auto", only=("reverse",))
    assert {result.mutant.split(":")[1]: (result.verdict, result.engine) for result in found.values()} == {
        "forgets": (Verdict.SURVIVED, "replay"),
        "moves": (Verdict.SURVIVED, "replay"),
    }
