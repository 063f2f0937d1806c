"""A test that starts the program where no mutant acts is no judge: what it lets through is not survived."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.baseline.out_of_reach import files_out_of_reach
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.model.events import OutOfReach, TestEnd
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

MISSION = """
    from robot import Arm

    def go():
        arm = Arm()
        arm.move_by(0.5)
        return arm.x

    if __name__ == "__main__":
        print(go())
"""
TESTS = """
    import subprocess
    import sys

    import mission

    def test_here():
        assert mission.go() is not None

    def test_there():
        command = {command}
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
@pytest.mark.parametrize(
    ("command", "verdict"),
    [
        ('["env", "-i", sys.executable, "mission.py"]', Verdict.UNSTABLE),
        ('["sh", "-c", f"{sys.executable} -S -c \'import mission; mission.go()\'"]', Verdict.UNSTABLE),
        ('[sys.executable, "-S", "-c", "pass"]', Verdict.SURVIVED),  # it runs nothing of the program
        ('[sys.executable, "mission.py"]', Verdict.SURVIVED),  # the mutant acts there
    ],
)
def test_what_a_process_out_of_reach_may_notice_is_not_survived(
    tmp_path: Path, command: str, verdict: Verdict, engine: str
) -> None:
    folder = write_project(tmp_path, MISSION, TESTS.replace("{command}", command))
    path = run_campaign(request_for(folder, engine=engine, only=("skip",)), Quiet())
    with Journal.open(path) as journal:
        (outcome,) = journal.outcomes()
    assert outcome.verdict is verdict
    assert ("test_there starts" in (outcome.message or "")) is (verdict is Verdict.UNSTABLE)


@pytest.mark.parametrize(
    ("named", "found"),
    [
        (("run.py",), {"cell/__init__.py", "cell/arm.py"}),
        (("cell/arm.py",), {"cell/arm.py"}),
        (("other.py",), {"other.py"}),
        (("loads.py",), {"cell/__init__.py", "cell/arm.py", "other.py"}),
        ((), set()),
        (None, {"cell/__init__.py", "cell/arm.py", "other.py"}),
    ],
)
def test_a_process_may_run_the_files_that_those_it_names_import(
    tmp_path: Path, named: tuple[str, ...] | None, found: set[str]
) -> None:
    texts = {
        "run.py": "import cell.arm",
        "loads.py": "from importlib import import_module",
        "cell/__init__.py": "from .arm import go",
        "cell/arm.py": "import math",
        "other.py": "",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    files = None if named is None else tuple(str(tmp_path / name) for name in named)
    process = OutOfReach("env -i python", "env clears its environment", files)
    ends = {
        (0, "test_a"): TestEnd("test_a", "passed", out_of_reach=(process,)),
        (0, "b"): TestEnd("b", "passed"),
    }
    ran = files_out_of_reach(tmp_path, ["cell", "other.py"], ends)
    assert {*ran[0, "test_a"]} == found
    assert (0, "b") not in ran
