"""What is executed is recorded: by test, for all tests after it, or for all files where that is not known."""

from __future__ import annotations

import pytest

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.preparation import begin, locked_executor
from mutabot.execution.task import Result
from mutabot.model.source_units import ALL_FILES, ExecutedByTests, File
from tests.campaign.project import Quiet, request_for, write_project

NAMES = ("mission.py", "robot.py", "tests/test_mission.py")
MISSION = """
    from functools import cache

    def left(arm):
        arm.move_by(0.2)

    def right(arm):
        arm.move_by(far())
        return arm.position()

    @cache
    def far():
        return half(0.6)

    def half(x):
        return x / 2

    def unused():
        pass
"""
TESTS = """
    import subprocess
    import sys
    from pathlib import Path
    sys.path.append(str(Path(__file__).parents[1] / "lib" / "site-packages"))
    import asks_its_system
    import mission
    import pytest
    from robot import Arm

    def made():
        return Arm()

    @pytest.fixture(scope="module")
    def shared():
        return made()

    def test_left():
        mission.left(Arm())

    def test_right():
        assert mission.right(Arm()) > 0

    def test_shared(shared):
        mission.left(shared)

    def test_reads():
        assert Path(__file__).with_name("goals.txt").read_text()

    def test_shared_again(shared):
        assert shared.x > 0

    def test_starts():
        subprocess.run([sys.executable, "-c", ""], check=True)

    def test_reads_the_program():
        assert "def far" in Path(mission.__file__).read_text()

    def test_left_again():
        mission.left(Arm())
"""

#: an installed package that starts a process while it is imported, as glfw does to know a version
ASKS = """
    import subprocess
    import sys
    subprocess.run([sys.executable, "-c", "print(3)"], check=True, capture_output=True)
"""


@pytest.fixture(scope="module")
def told() -> Quiet:
    """What the user is told of the campaign."""
    return Quiet()


@pytest.fixture(scope="module")
def taken(tmp_path_factory: pytest.TempPathFactory, told: Quiet) -> tuple[Campaign, list[Result]]:
    """A project's campaign with its baseline."""
    folder = write_project(
        tmp_path_factory.mktemp("executed"),
        MISSION,
        TESTS,
        more={"tests/goals.txt": "0.5\n", "lib/site-packages/asks_its_system.py": ASKS},
    )
    request = request_for(folder, engine="replay")
    with locked_executor(request, told) as opened:
        return begin(request, opened, told)


@pytest.fixture(scope="module")
def executed(taken: tuple[Campaign, list[Result]]) -> dict[str, set[str]]:
    """What tests of the project execute in the baseline, in the order of the file."""
    campaign, _ = taken
    files = {name: File(name, (campaign.request.root / name).read_bytes()) for name in NAMES}
    found: dict[str, set[str]] = {}
    for _, test in campaign.baseline.ends:
        executed = campaign.baseline.executed[0].by([test])
        assert executed is not None
        units = found.setdefault(test.rpartition("::")[2], set())
        for name, lines in executed.items():
            known = files[name].names_at(lines) if name in files else {""}
            units |= {f"{name}:{unit}" for unit in (known if known is not None else {"whole"})}
    return found


def of(test: set[str], file: str = "mission.py") -> set[str]:
    return {unit.partition(":")[2] for unit in test if unit.startswith(f"{file}:")}


def test_a_test_depends_on_what_it_executes_and_on_what_runs_at_import(executed: dict[str, set[str]]) -> None:
    assert of(executed["test_left"]) == {"", "left"}
    assert of(executed["test_left"], "robot.py") == {"", "Arm.__init__", "Arm.move_by"}
    assert of(executed["test_left"], NAMES[2]) == {"", "test_left"}


def test_what_a_test_executes_counts_for_all_tests_after_it(executed: dict[str, set[str]]) -> None:
    assert of(executed["test_right"]) == {"", "left", "right", "far", "half"}
    assert {"test_left", "test_right", "test_shared", "made", "shared"} <= of(
        executed["test_shared"], NAMES[2]
    )
    assert "test_shared" not in of(executed["test_right"], NAMES[2])


def test_each_test_reports_only_what_none_before_it_has_reported(
    taken: tuple[Campaign, list[Result]],
) -> None:
    ends = taken[1][0].ends
    told = [(name, line) for end in ends for name, lines in (end.executed or {}).items() for line in lines]
    assert len(ends) > 3
    assert len(told) == len(set(told)) > 5


def test_what_is_reported_before_a_test_counts_for_it_and_what_is_not_known_for_all_after_it() -> None:
    found = ExecutedByTests([("a", {"f.py": (1,)}), ("b", {}), ("c", {"f.py": (2,)}), ("d", None), ("e", {})])
    assert found.by(["b"]) == found.by(["b", "a"]) == {"f.py": (1,)}
    assert found.by(["c"]) == {"f.py": (1, 2)}
    assert found.by(["e"]) is None
    assert found.by(["unknown"]) == {}


def test_a_file_that_is_opened_counts(executed: dict[str, set[str]]) -> None:
    assert "tests/goals.txt:" in executed["test_reads"]
    assert "tests/goals.txt:" not in executed["test_shared"]


def test_tests_from_the_first_on_that_reads_the_program_may_have_its_text(
    taken: tuple[Campaign, list[Result]], told: Quiet
) -> None:
    baseline = taken[0].baseline
    names = [test.rpartition("::")[2] for test in baseline.readers(0, "mission.py")]
    assert names == ["test_reads_the_program", "test_left_again"]
    assert not baseline.is_read("robot.py")
    (note,) = (line for line in told.lines if "may read mission.py as text" in line)
    assert "from tests/test_mission.py::test_reads_the_program on" in note
    assert note.endswith(": mutants of calls act in it only where they run it unchanged")


def test_of_tests_that_start_processes_nothing_is_known(executed: dict[str, set[str]]) -> None:
    assert f"{ALL_FILES}:" in executed["test_starts"]
    assert f"{ALL_FILES}:" not in executed["test_shared_again"]


def test_a_process_that_an_installed_package_starts_at_import_is_none_of_the_program(
    executed: dict[str, set[str]],
) -> None:
    assert f"{ALL_FILES}:" not in executed["test_left"]
