"""Processes of campaigns that tests begin as forks are as those that are begun anew."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from mutabot.execution import processes
from tests.campaign.project import run, write_project

#: writes what a process was begun with when the first of the project is imported
CONFTEST = """
import json, os, resource, signal, sys
from pathlib import Path

if not Path("began.json").exists():
    numbers = signal.valid_signals()
    Path("began.json").write_text(json.dumps({
        "words": [sys.argv, sys.orig_argv[1:], sys.executable, list(sys.flags)],
        "path": sys.path,
        "variables": dict(os.environ),
        "files": sorted(os.listdir("/proc/self/fd")),
        "streams": [
            [stream.encoding, stream.errors, stream.line_buffering]
            for stream in (sys.__stdin__, sys.__stdout__, sys.__stderr__)
        ],
        "standard input": os.readlink("/proc/self/fd/0"),
        "hash": hash("arm"),
        "place": [os.getcwd(), os.getsid(0) == os.getpid(), os.umask(0o22), os.nice(0)],
        "signals": [str(signal.getsignal(number)) for number in sorted(numbers)],
        "masked": sorted(signal.pthread_sigmask(signal.SIG_BLOCK, ())),
        "main": [sys.modules["__main__"].__spec__.name, sorted(vars(sys.modules["__main__"]))],
        "known": {
            f"{name}.{key}": len(value) if isinstance(value, (dict, list, set)) else value
            for name, module in sorted(sys.modules.items()) if name.startswith("mutabot.runtime.")
            for key, value in vars(module).items()
            if not key.startswith("__") and isinstance(value, (str, int, float, type(None), dict, list, set))
        },
        "modules": [name for name in sys.modules if name.partition(".")[0] == "mutabot"],
        "limits": [resource.getrlimit(number) for number in range(10)],
    }))
"""
MISSION = """
    def run(arm):
        arm.move_by(0.25)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_it_moves():
        arm = Arm()
        mission.run(arm)
        assert arm.x == 0.25
"""


def began(folder: Path) -> dict[str, Any]:
    """What the first process of a campaign was begun with, without the name of its own folder."""
    (folder / "began.json").unlink(missing_ok=True)
    (folder / "conftest.py").write_text(CONFTEST, encoding="utf-8")
    before = time.time_ns()
    run(folder, engine="auto")
    text = (folder / "began.json").read_text(encoding="utf-8")
    own = next(word for word in json.loads(text)["words"][0] if word.startswith("cache_dir="))
    home = Path(own.partition("=")[2]).parent
    found: dict[str, Any] = json.loads(text.replace(str(home), "HOME"))
    times = [found["known"].pop(name) for name in list(found["known"]) if name.endswith(".BEGAN")]
    assert times
    assert min(times) > before
    return found


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("PYTHONPATH", "more"),
        pytest.param("A", "b", marks=pytest.mark.whole),
        pytest.param("PYTHONHASHSEED", "7", marks=pytest.mark.whole),
        pytest.param("LANG", "C", marks=pytest.mark.whole),
    ],
)
def test_a_fork_is_begun_as_by_the_command_line(
    name: str, value: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_project(tmp_path, MISSION, TESTS)
    monkeypatch.setenv(name, value)
    forked = began(tmp_path)
    monkeypatch.setattr(processes, "subprocess", subprocess)
    anew = began(tmp_path)
    ahead = set(forked.pop("modules")) - set(anew.pop("modules"))
    assert forked == anew
    assert {module for module in ahead if module.startswith("mutabot.runtime")} == set()


def test_what_python_imports_when_it_begins_is_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tests = TESTS + "        assert __import__('sys').customized\n"
    more = {"more/sitecustomize.py": "import sys\nsys.customized = True\n"}
    write_project(tmp_path, MISSION, tests, more=more)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "more"))
    assert run(tmp_path)
