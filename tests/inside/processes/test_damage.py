"""Files by which processes below the tests report, as the tests may leave them: damage is noticed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.border.processes import SUFFIX, Node
from mutabot.campaign.run import run_campaign
from mutabot.inside.processes.diary import Diary
from mutabot.inside.processes.host import Diaries
from mutabot.model import Verdict
from tests.campaign.project import Quiet, outcomes, request_for, write_project


def only_file(folder: Path) -> Path:
    (found,) = folder.glob(f"*{SUFFIX}")
    return found


def shorten(folder: Path) -> None:
    os.truncate(only_file(folder), 3)


def scribble(folder: Path) -> None:
    with only_file(folder).open("ab") as file:
        file.write(b"progress: 10 %\n")


def write_a_value(folder: Path) -> None:
    with only_file(folder).open("ab") as file:
        file.write(b'[{"type": "Node"}]\n')


def tear(folder: Path) -> None:
    with only_file(folder).open("ab") as file:
        file.write(b'{"type":"Node","na\n')


def forge(folder: Path) -> None:
    data = only_file(folder).read_bytes()
    (folder / f"1-1{SUFFIX}").write_bytes(data)


DAMAGE = {
    "deleted": lambda folder: only_file(folder).unlink(),
    "all deleted": shutil.rmtree,
    "shorter": shorten,
    "scribbled": scribble,
    "a value": write_a_value,
    "torn": tear,
    "of another": forge,
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_damage_is_noticed(tmp_path: Path, damage: Callable[[Path], object]) -> None:
    diary, diaries = Diary(str(tmp_path), 0), Diaries(str(tmp_path))
    diary.write(Node("a"))
    assert [len(entries) for _, entries in diaries.new()] == [2]
    assert diaries.doubt is None
    damage(tmp_path)
    diaries.new()
    assert "was damaged" in (diaries.doubt or "")


def test_a_line_that_is_being_written_is_no_damage(tmp_path: Path) -> None:
    diary, diaries = Diary(str(tmp_path), 0), Diaries(str(tmp_path))
    os.write(diary._file, b'{"type":"Node",')
    diaries.new()
    os.write(diary._file, b'"name":"a"}\n')
    assert [entries for _, entries in diaries.new()] == [[Node("a")]]
    assert diaries.doubt is None


MISSION = """
    from robot import Arm

    def run():
        arm = Arm()
        arm.move_by(0.25)
        return arm.x

    if __name__ == "__main__":
        print(run())
"""
TESTS = """
    import os, subprocess, sys
    from pathlib import Path

    def test_moves():
        found = subprocess.run([sys.executable, "mission.py"], capture_output=True, text=True, check=True)
        if float(found.stdout) != 0.25:  # it is a mutant: as if it had scribbled all over the place
            for path in Path(os.environ["MUTABOT_PROCESSES"]).glob("*.jsonl"):
                path.write_text("?\\n")
"""


@pytest.mark.whole
def test_damage_is_an_error_of_its_mutant_and_never_a_survivor(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS)
    path = run_campaign(request_for(folder, engine="replay"), Quiet())
    found = outcomes(path)
    assert {one.verdict for one in found} == {Verdict.ERROR}
    assert all("what processes below the tests reported was damaged" in str(one.message) for one in found)
