"""The start-up module: any Python from 3.8 on, whatever is there already, at next to no cost."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.model.event_file import FOLDER, VARIABLE, WAKE, EventReader
from mutabot.model.events import Began
from mutabot.runtime.processes import startup

KEY = "0123456789abcdef"
STARTUP = str(Path(startup.__file__).parent)


def folder_of(home: Path, *lines: str) -> Path:
    folder = home / FOLDER
    folder.mkdir(parents=True)
    (folder / WAKE).write_text("".join(f"{line}\n" for line in (f"key {KEY}", *lines)), encoding="utf-8")
    return folder


def only_event(folder: Path) -> Began:
    """What the one process told that there was."""
    (file,) = folder.glob("*.jsonl")
    (told,) = EventReader(str(file), KEY).read(is_last=True)
    assert isinstance(told, Began)
    return told


def run(python: str, *arguments: str, folder: Path, more: str = "") -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join(filter(None, [STARTUP, more]))
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": path, VARIABLE: str(folder)}
    return subprocess.run([python, *arguments], env=environment, capture_output=True, text=True, check=True)


@cache
def interpreters() -> list[str]:
    """Every Python of 3.8 or newer that this machine has."""
    found = []
    for minor in range(8, 15):
        python = shutil.which(f"python3.{minor}")
        if python is None:
            continue
        asked = subprocess.run(
            [python, "-c", "import sys; print(sys.version_info[1])"],
            capture_output=True,
            text=True,
            check=False,
        )
        if asked.stdout.strip() == str(minor):
            found.append(python)
    return list(dict.fromkeys([sys.executable, *found]))


@pytest.mark.parametrize("python", interpreters(), ids=lambda path: Path(path).name)
def test_a_process_of_no_interest_runs_as_ever_and_imports_nothing_more(python: str, tmp_path: Path) -> None:
    folder = folder_of(tmp_path, "path /nowhere", "name robot_that_nobody_has", "file /nowhere/mission.py")
    code = "import sys; names, path = [*sys.modules], [*sys.path]; import json; " + (
        "print(json.dumps(names)); print(json.dumps(path))"
    )
    with_us = run(python, "-c", code, folder=folder).stdout
    without = subprocess.run(
        [python, "-c", code], env={"PATH": os.environ["PATH"]}, capture_output=True, text=True, check=True
    ).stdout
    (modules, path), (usual, usual_path) = (map(json.loads, text.splitlines()) for text in (with_us, without))
    assert {*modules} - {*usual} <= {"sitecustomize"}
    assert path == usual_path
    assert list(folder.iterdir()) == [folder / WAKE]


def test_an_older_python_says_that_it_cannot_be_looked_into(tmp_path: Path) -> None:
    old = [
        python for python in interpreters() if Path(python).name in ("python3.8", "python3.9", "python3.10")
    ]
    if not old:
        pytest.skip("no Python older than 3.11 is here")
    script = tmp_path / "mission.py"
    script.write_text("print('it ran')")
    folder = folder_of(tmp_path / "home", "path /nowhere", f"file {script}")
    assert run(old[0], str(script), folder=folder).stdout == "it ran\n"
    told = only_event(folder)
    assert "is older than 3.11" in (told.unable or "")
    assert told.command[-1].endswith("mission.py")


@pytest.mark.parametrize("python", interpreters(), ids=lambda path: Path(path).name)
def test_a_python_that_cannot_load_us_says_so(python: str, tmp_path: Path) -> None:
    script = tmp_path / "mission.py"
    script.write_text("print('it ran')")
    folder = folder_of(tmp_path / "home", "join module_that_nobody_has", f"file {script}")
    assert run(python, str(script), folder=folder).stdout == "it ran\n"
    assert only_event(folder).unable is not None


def test_a_process_that_cannot_join_says_so_and_runs_as_ever(tmp_path: Path) -> None:
    script, ours = tmp_path / "mission.py", tmp_path / "ours"
    script.write_text("print('it ran')")
    ours.mkdir()
    (ours / "broken_session.py").write_text("def join(folder):\n    raise RuntimeError('no such package')\n")
    folder = folder_of(
        tmp_path / "home", "join broken_session", f"path {ours}", "own broken_session", f"file {script}"
    )
    done = run(sys.executable, str(script), folder=folder)
    assert (done.stdout, done.stderr) == ("it ran\n", "")
    assert "no such package" in (only_event(folder).unable or "")


@pytest.mark.parametrize(
    ("start", "joins"),
    [
        ("subprocess.run(['env', '-i', sys.executable, '-c', '0'])", True),
        ("subprocess.run([sys.executable, '-c', '0'], env={})", True),
        ("subprocess.run([sys.executable, '-c', '0'], env={b'A': b'b'})", True),
        ("os.system(f'{sys.executable} -I -c 0')", True),
        ("subprocess.run([sys.executable, '-c', '0'])", False),
        ("subprocess.run([sys.executable, '-c', '0'], env=dict(os.environ))", False),
        ("os.system('true')", False),
    ],
)
def test_a_process_joins_for_one_that_it_starts_and_that_might_not(
    tmp_path: Path, start: str, joins: bool
) -> None:
    ours = tmp_path / "ours"
    ours.mkdir()
    (ours / "its_session.py").write_text("def join(folder):\n    open(f'{folder}/joined', 'w').close()\n")
    folder = folder_of(tmp_path / "home", "join its_session", f"path {ours}", "own its_session")
    run(sys.executable, "-c", f"import os, subprocess, sys; {start}", folder=folder)
    assert (folder / "joined").exists() is joins


def test_a_process_that_cannot_join_for_others_says_so_once_it_is_of_interest(tmp_path: Path) -> None:
    script, start = tmp_path / "mission.py", "subprocess.run(['env', 'true'])"
    script.write_text("")
    for number, more in enumerate(("", f"; open({str(script)!r}).close()")):
        folder = folder_of(tmp_path / str(number), "join module_that_nobody_has", f"file {script}")
        run(sys.executable, "-c", f"import subprocess; {start}; {start}{more}", folder=folder)
        assert len([*folder.glob("*.jsonl")]) == number


def test_a_sitecustomize_that_is_there_already_is_loaded_as_ever(tmp_path: Path) -> None:
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "sitecustomize.py").write_text("import sys\nsys.theirs = __name__, __file__\n")
    folder = folder_of(tmp_path / "home")
    code = "import sys, sitecustomize; print(sys.theirs, sitecustomize.__file__)"
    told = run(sys.executable, "-c", code, folder=folder, more=str(theirs)).stdout
    place = str(theirs / "sitecustomize.py")
    assert told == f"{('sitecustomize', place)} {place}\n"


def test_a_campaign_that_is_over_does_not_matter(tmp_path: Path) -> None:
    assert run(sys.executable, "-c", "print(1)", folder=tmp_path / "gone").stdout == "1\n"


def test_a_process_of_interest_does_not_load_what_few_need() -> None:
    code = """
        import sys
        import mutabot.runtime.processes.member
        few = {"subprocess", "asyncio", "hashlib", "pathlib", "random", "pytest"}
        few |= {"inspect"} if sys.version_info < (3, 12) else set()  # dataclasses ask it for annotations
        print(sys.modules.keys() & few)
        import dataclasses
        @dataclasses.dataclass
        class Without:
            a: int = 3
        print(Without.__doc__, "inspect" in sys.modules)
    """
    told = subprocess.run(
        [sys.executable, "-c", dedent(code)], capture_output=True, text=True, check=True
    ).stdout
    assert told.splitlines() == ["set()", "Without(a: int = 3) True"]
