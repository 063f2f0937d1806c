"""What a process does to files, and to what a fork would share, is told before it is done."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from textwrap import dedent, indent

import pytest

HEAD = """
import json, os, pathlib, sys, tempfile
from mutabot.inside.footprint.deeds import Deeds

root = pathlib.Path(sys.argv[1])
(root / "there.txt").write_text("old")
(root / "own").mkdir(exist_ok=True)
(root / "ignored").mkdir(exist_ok=True)
os.chdir(root)
watch = Deeds((str(root / "ignored"),))
watch.install()
watch.start()
"""
TAIL = """
watch.stop(str(root / "own"))
short = {deed: deed.path.removeprefix(str(root)) for deed in watch.done}
print(json.dumps([[deed.verb, short[deed], lasts] for deed, lasts in watch.done.items()]))
"""


def seen(folder: Path, code: str) -> list[list[object]]:
    """What a fresh process tells about this code: verb, path, whether it outlives its test."""
    text = HEAD + dedent(code) + TAIL
    done = subprocess.run(
        [sys.executable, "-c", text, str(folder)], capture_output=True, text=True, check=True
    )
    found: list[list[object]] = json.loads(done.stdout.splitlines()[-1])
    return found


CASES: dict[str, tuple[str, list[list[object]]]] = {
    "a file is written": ("open('log.txt', 'w')", [["writes", "/log.txt", True]]),
    "one is appended to": ("open('there.txt', 'a')", [["writes", "/there.txt", True]]),
    "one is written by number": ("os.open('a', os.O_CREAT | os.O_WRONLY)", [["writes", "/a", True]]),
    "one is read": ("open('there.txt').read()", []),
    "one is deleted": ("os.remove('there.txt')", [["deletes", "/there.txt", True]]),
    "one is renamed": ("os.replace('there.txt', 'b')", [["renames", "/there.txt", True]]),
    "a folder is made": ("os.mkdir('new')", [["makes", "/new", True]]),
    "the test's own folder": ("open('own/log.txt', 'w')", [["writes", "/own/log.txt", False]]),
    "our own folder": ("open('ignored/log.txt', 'w')", []),
    "a nameless file": ("tempfile.TemporaryFile()", []),
    "nowhere": ("open(os.devnull, 'w')", []),
    "a database": ("import sqlite3; sqlite3.connect('d.db')", [["opens the database", "/d.db", True]]),
    "a database in memory": ("import sqlite3; sqlite3.connect(':memory:')", []),
    "a process": ("os.system('true')", [["starts a process", "", False]]),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_done_is_seen(tmp_path: Path, case: str) -> None:
    code, expected = CASES[case]
    assert seen(tmp_path, code) == expected


def test_a_random_name_is_nobody_elses(tmp_path: Path) -> None:
    code = "folder = tempfile.mkdtemp(); open(folder + '/a', 'w')"
    assert {lasts for _, _, lasts in seen(tmp_path, code)} == {False}


def test_a_fixed_address_is_seen_and_a_free_one_is_not(tmp_path: Path) -> None:
    code = "import socket; socket.socket().bind(('127.0.0.1', 0))"
    assert seen(tmp_path, code) == []
    code = "import socket; socket.socket(socket.AF_UNIX).bind('here')"
    assert seen(tmp_path, code) == [["waits at the address 'here'", "", False]]


def test_it_is_told_before_it_is_done(tmp_path: Path) -> None:
    code = """
    def told(deed):
        if os.path.exists("new.txt"):
            raise SystemExit("too late")
        watch.on_deed = None

    watch.on_deed = told
    open("new.txt", "w")
    """
    assert seen(tmp_path, indent(dedent(code), "")) == [["writes", "/new.txt", True]]
