"""Which files outcomes depend on: what the baseline opens, by whatever means, and what a mutant might."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.campaign import run as campaign
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.campaign.reuse.snapshot import OpenedFiles, Snapshot, counted
from tests.campaign.project import Quiet, request_for, write_project

MISSION = """
    def go(arm):
        arm.move_by(float(open("points/fir" "st.txt").read()))
"""
TESTS = """
    import subprocess
    import mission
    from robot import Arm

    def test_goes():
        limit = subprocess.run(["cat", "lim" "it.out"], capture_output=True, check=True).stdout
        arm = Arm()
        mission.go(arm)
        assert 0 < arm.x < float(limit)
"""
FILES = {
    "points/first.txt": "0.25\n",
    "points/second.txt": "0.5\n",
    "limit.out": "1.0\n",
    "spare.log": "named by robot.py\n",
    "out.txt": "nothing to do with it\n",
    "plan.pdf": "nothing to do with it\n",
    "scene.xml": "<scene/>\n",
    "junit.xml": "<?xml version='1.0'?><testsuites/>\n",
}


def by_python(path: Path) -> None:
    path.read_text()


def by_c(path: Path) -> None:
    libc = ctypes.CDLL(None)
    libc.fopen.restype = ctypes.c_void_p
    libc.fclose(ctypes.c_void_p(libc.fopen(bytes(path), b"r")))


def by_another_process(path: Path) -> None:
    subprocess.run(["cat", path], check=True, capture_output=True)


@pytest.mark.parametrize("read", [by_python, by_c, by_another_process])
def test_a_watch_sees_what_any_process_opens(tmp_path: Path, read: Callable[[Path], None]) -> None:
    for name in ("a.txt", "b.txt", "deep/er/c.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("text")
    with OpenedFiles(tmp_path, Snapshot.take(tmp_path).folders) as watch:
        read(tmp_path / "b.txt")
        read(tmp_path / "deep" / "er" / "c.txt")
    (tmp_path / "a.txt").read_text()
    assert watch.opened is not None
    assert {name for name in watch.opened if name.endswith(".txt")} == {"b.txt", "deep/er/c.txt"}


def test_a_watch_that_missed_something_knows_nothing(tmp_path: Path) -> None:
    longest = int(Path("/proc/sys/fs/inotify/max_queued_events").read_text())
    files = [tmp_path / "a.txt", tmp_path / "b.txt"]
    for file in files:
        file.write_text("text")
    with OpenedFiles(tmp_path, ["."]) as watch:
        for number in range(longest + 2):  # equal events in a row count as one
            files[number % 2].open().close()
    assert watch.opened is None


@pytest.mark.whole
def test_notes_count_if_they_are_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[Dependencies] = []

    class Noting(Dependencies):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments)  # type: ignore[arg-type]
            kept.append(self)

    monkeypatch.setattr(campaign, "Dependencies", Noting)
    write_project(tmp_path, MISSION, TESTS, more=FILES)
    (tmp_path / "linked.txt").symlink_to(tmp_path / "robot.toml")
    campaign.run_campaign(request_for(tmp_path), Quiet())
    (dependencies,) = kept
    notes = {"points/first.txt", "limit.out", "linked.txt"}
    assert set(dependencies.files) == notes | {
        "scene.xml", "mission.py", "robot.py", "tests/test_mission.py",
    }  # fmt: skip


def test_where_the_kernel_cannot_report_it_every_file_counts(tmp_path: Path) -> None:
    request = request_for(write_project(tmp_path, MISSION, TESTS, more=FILES))
    digests = dict.fromkeys(FILES, "#")
    assert counted(request, digests, set(), None).keys() == FILES.keys() - {"junit.xml"}
    assert counted(request, digests, set(), set()).keys() == {"scene.xml"}
