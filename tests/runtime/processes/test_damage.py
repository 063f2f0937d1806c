"""Files by which processes below the tests report, as the tests may leave them: damage is noticed."""

from __future__ import annotations

import mmap
import os
import shutil
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Verdict
from mutabot.model.event_file import FOLDER, NOW, SUFFIX, sealed
from mutabot.model.events import Began, Event, Found, SessionEnd
from mutabot.model.fold import Children
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.processes.environment import Announced, Now
from tests.campaign.project import REPLAY, Quiet, outcomes, request_for, write_project

KEY = "0123456789abcdef"
NAME = f"{os.getpid()}-1"
BEGAN = Began(os.getpid(), 1, ("python", "mission.py"), 0.0)


def folder_of(home: Path) -> Path:
    (home / FOLDER).mkdir()
    return home / FOLDER


def only_file(folder: Path) -> Path:
    return folder / f"{NAME}{SUFFIX}"


def line_of(event: Event, number: int) -> bytes:
    return sealed(event, number, NAME, KEY)


def append(folder: Path, *data: bytes) -> None:
    with only_file(folder).open("ab") as file:
        file.write(b"".join(data))


def forge(folder: Path) -> None:
    (folder / f"1-1{SUFFIX}").write_bytes(sealed(BEGAN, 1, "1-1", KEY))


def twice(folder: Path) -> None:
    append(folder, only_file(folder).read_bytes().splitlines(keepends=True)[-1])


DAMAGE: dict[str, Callable[[Path], object]] = {
    "deleted": lambda folder: only_file(folder).unlink(),
    "all deleted": shutil.rmtree,
    "shorter": lambda folder: os.truncate(only_file(folder), 3),
    "scribbled": lambda folder: append(folder, b"progress: 10 %\n"),
    "a value": lambda folder: append(folder, b'[{"type": "Found"}]\n'),
    "torn": lambda folder: append(folder, line_of(SessionEnd(), 3)[:-9] + b"\n"),
    "of another": forge,
    "one removed": lambda folder: append(folder, line_of(SessionEnd(), 4)),
    "one twice": twice,
    "of a process that could not write": lambda folder: Now(str(folder)).note_unwritten(),
    "no number": lambda folder: (folder / NOW).unlink(),
    "half a number": lambda folder: os.truncate(folder / NOW, 4),
    "another number": lambda folder: (folder / NOW).write_bytes(bytes(mmap.PAGESIZE)),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_damage_is_noticed(tmp_path: Path, damage: Callable[[Path], object]) -> None:
    folder = folder_of(tmp_path)
    running = Announced(str(folder))
    file, children = EventFile(str(folder), NAME, KEY), Children(str(tmp_path), KEY)
    children.number = running.begin("test_moves")
    for event in (BEGAN, Found(nodes=("a",))):
        file.send(event)
    assert children.read() == [BEGAN, Found(nodes=("a",))]
    assert children.doubt is None
    damage(folder)
    children.read()
    assert "was damaged" in (children.doubt or "")


#: whatever can be in the place of a file
OTHERS: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a folder": Path.mkdir,
    "a link": lambda path: path.symlink_to("/dev/zero"),
    "a socket": lambda path: os.mknod(path, 0o600 | stat.S_IFSOCK),
    "something huge": lambda path: (path.touch(), os.truncate(path, 1 << 40)),
}


@pytest.mark.parametrize("other", OTHERS.values(), ids=OTHERS)
def test_whatever_is_in_the_place_of_a_file_nobody_waits_for_it(
    tmp_path: Path, other: Callable[[Path], object]
) -> None:
    folder = folder_of(tmp_path)
    Announced(str(folder))
    children = Children(str(tmp_path), KEY)
    append(folder, line_of(BEGAN, 1))
    assert children.read() == [BEGAN]
    for name in (NOW, f"{NAME}{SUFFIX}"):
        (folder / name).unlink()
        other(folder / name)
    children.read()
    assert "was damaged" in (children.doubt or "")
    if other is not OTHERS["something huge"]:
        with pytest.raises(OSError, match=r"\w"):
            Announced(str(folder))
        with pytest.raises(RuntimeError, match="cannot write"):
            EventFile(str(folder), NAME, KEY, fail=cannot_write)


def cannot_write() -> None:
    raise RuntimeError("cannot write")


def test_nobody_writes_into_a_file_that_has_another_name(tmp_path: Path) -> None:
    folder, precious = folder_of(tmp_path), tmp_path / "precious"
    precious.write_text("precious")
    (folder / NOW).hardlink_to(precious)
    with pytest.raises(OSError, match="something else is in the place of this file"):
        Announced(str(folder))
    assert precious.read_text() == "precious"


def test_an_event_that_is_being_written_is_no_damage(tmp_path: Path) -> None:
    folder = folder_of(tmp_path)
    children = Children(str(tmp_path), KEY)
    line = line_of(Found(nodes=("a",)), 2)
    append(folder, line_of(BEGAN, 1), line[:20])
    later = threading.Timer(0.2, append, (folder, line[20:]))
    later.start()
    assert children.read() == [BEGAN, Found(nodes=("a",))]
    assert children.doubt is None
    later.join()


def test_a_process_that_was_killed_while_it_wrote_is_not_waited_for(tmp_path: Path) -> None:
    folder = folder_of(tmp_path)
    with subprocess.Popen([sys.executable, "-c", ""]) as gone:
        name = f"{gone.pid}-1"
    line = sealed(Began(gone.pid, 1, ("python",), 0.0), 1, name, KEY)
    (folder / f"{name}{SUFFIX}").write_bytes(line + line_of(Found(), 2)[:20])
    children = Children(str(tmp_path), KEY)
    children.read()
    assert f"{name} ends in the midst of event 2" in (children.doubt or "")


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
            for path in Path(os.environ["MUTABOT_PROCESSES"]).glob("[0-9]*.jsonl"):
                path.write_text("?\\n")
"""


@pytest.mark.whole
def test_damage_is_an_error_of_its_mutant_and_never_a_survivor(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS)
    path = run_campaign(request_for(folder, engine="replay"), Quiet())
    found = outcomes(path)
    assert {outcome.verdict for outcome in found} == {Verdict.ERROR}
    assert all(
        "what processes below the tests reported was damaged" in str(outcome.message) for outcome in found
    )


#: whatever looks which test is running then dies of SIGBUS, as it would not in plain pytest
SHORT = """
    import os
    from robot import Arm

    def run():
        arm = Arm()
        arm.move_by(0.25)
        if arm.x == -0.25:
            os.truncate(os.environ["MUTABOT_PROCESSES"] + "/now", 0)
        arm.move_by(0.0)
        return arm.x

    if __name__ == "__main__":
        print(run())
"""
DIED = """
    import subprocess, sys

    def test_moves():
        found = subprocess.run([sys.executable, "mission.py"], capture_output=True, text=True)
        assert found.returncode == 0
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_process_that_dies_since_it_shortened_a_file_of_ours_is_no_kill(
    tmp_path: Path, engine: str
) -> None:
    folder = write_project(tmp_path, SHORT, DIED)
    path = run_campaign(request_for(folder, engine=engine, only=("*#1:*",)), Quiet())
    found = {outcome.mutant: outcome for outcome in outcomes(path)}
    harmful = next(mutant for mutant in found if "reverse" in mutant)
    assert found[harmful].verdict is Verdict.ERROR
    assert "the number of the running test was deleted or changed" in str(found[harmful].message)
    assert {outcome.verdict for name, outcome in found.items() if name != harmful} == {Verdict.SURVIVED}


#: a mutant fills the disk, as far as its processes are concerned: no file of theirs may grow any more
FULL = """
    import resource, subprocess, sys
    import mission

    def test_moves():
        found = subprocess.run([sys.executable, "mission.py"], capture_output=True, text=True)
        assert found.returncode == 0 and float(found.stdout) == 0.25

    def test_moves_again():
        assert mission.run() == 0.25
"""
FULL_MISSION = """
    import resource
    from robot import Arm

    def run():
        arm = Arm()
        arm.move_by(0.25)
        if arm.x == -0.25:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
            arm.position()
        return arm.x

    if __name__ == "__main__":
        print(run())
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_process_that_cannot_write_is_an_error_of_its_mutant_and_touches_no_other(
    tmp_path: Path, engine: str
) -> None:
    harmless = FULL_MISSION.replace("resource.RLIMIT_FSIZE, (1,", "resource.RLIMIT_CORE, (0,")
    found = {}
    for name, mission in (("harmless", harmless), ("full", FULL_MISSION)):
        folder = write_project(tmp_path / name, mission, FULL)
        path = run_campaign(request_for(folder, engine=engine, only=("*move_by*",)), Quiet())
        found[name] = {outcome.mutant: outcome for outcome in outcomes(path)}
    harmful = next(mutant for mutant in found["full"] if "reverse" in mutant)
    assert found["full"].keys() == found["harmless"].keys()
    assert found["harmless"][harmful].verdict is Verdict.KILLED
    assert found["full"][harmful].verdict is Verdict.ERROR
    assert "could not write its events" in str(found["full"][harmful].message)
    assert {mutant: each.verdict for mutant, each in found["full"].items() if mutant != harmful} == {
        mutant: each.verdict for mutant, each in found["harmless"].items() if mutant != harmful
    }
