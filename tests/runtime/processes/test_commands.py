"""What a command says about the Pythons that it starts."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.runtime.processes.commands import STARTUP, starts_a_killer, texts_of, why_unseen

ISOLATED = "isolates it"
CLEARED = "clears its environment"
SETS_PATH = "the command sets PYTHONPATH"
UNSET = "the command unsets"


def why(command: list[str], folder: Path | None = None) -> str:
    return why_unseen("subprocess.Popen", (command[0], command, folder, None)) or ""


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        ("python -S mission.py", ISOLATED),
        ("python3.11 -W error -X dev -I -m mission", ISOLATED),
        ("python -uE mission.py", ISOLATED),
        ("python -Ic pass", ISOLATED),
        ("python mission.py -S", ""),
        ("python -mS", ""),
        ("python -W Ignore mission.py", ""),
        ("env -i A=1 python mission.py", CLEARED),
        ("env - python mission.py", CLEARED),
        ("env -u PYTHONPATH python mission.py", CLEARED),
        ("env --unset=PYTHONPATH python mission.py", CLEARED),
        ("env -u HOME A=-i python mission.py", ""),
        ("env -i ls", ""),
        ("sudo -u robot python mission.py", CLEARED),
        ("sudo -E python mission.py", ""),
        ("env PYTHONPATH=lib python mission.py", SETS_PATH),
        ("nice python -I mission.py", ISOLATED),
        ("grep -I python mission.py", ""),
    ],
)
@pytest.mark.parametrize("is_of_shell", [False, True])
def test_python_that_loses_what_it_needs_is_named(command: str, reason: str, is_of_shell: bool) -> None:
    assert reason in why(["sh", "-c", f"cd cell && exec {command}"] if is_of_shell else command.split())
    assert bool(why(command.split())) == bool(reason)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("PYTHONPATH=lib python mission.py", SETS_PATH),
        ('export PYTHONPATH="lib"; python mission.py', SETS_PATH),
        ("PYTHONPATH=lib:$PYTHONPATH python mission.py", ""),
        ('export PYTHONPATH="lib:${PYTHONPATH}"; python mission.py', ""),
        (f"PYTHONPATH={STARTUP}:lib python mission.py", ""),
        ("PYTHONPATH=lib ls", ""),
        ("unset PYTHONPATH; python mission.py", UNSET),
        ("ls; python -S < mission.py", ISOLATED),
    ],
)
def test_what_a_shell_does_to_the_environment_is_read_in_its_command_and_scripts(
    tmp_path: Path, text: str, reason: str
) -> None:
    for name, content in (("run.sh", f"#!/bin/sh\n{text}\n"), ("plain", f"{text}\n")):
        (tmp_path / name).write_text(content)
    commands = [["sh", "-c", text], ["./run.sh"], ["nohup", "./run.sh", "1"], ["bash", "-e", "plain"]]
    for found in [
        *(why(command, tmp_path) for command in commands),
        why_unseen("os.system", (text.encode(),)),
    ]:
        assert reason in (found or "")
        assert bool(found) == bool(reason)


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("/usr/bin/python3 -I", ISOLATED),
        ("/usr/bin/env -S python3 -uS", ISOLATED),
        ("/usr/bin/env python3", ""),
    ],
)
def test_the_first_line_of_a_script_is_part_of_its_command(tmp_path: Path, line: str, reason: str) -> None:
    (tmp_path / "go").write_text(f"#!{line}\nimport os\nos.system('python -E')\n")
    assert reason in why(["./go", "-S"], tmp_path)
    assert bool(why(["sh", "-c", "./go -S"], tmp_path)) == bool(reason)


def test_what_is_no_script_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "data").write_bytes(b"\x7fELF python -S\n")
    assert texts_of("subprocess.Popen", (None, ["./data", "./gone", "."], tmp_path, None))[3:] == []
    assert texts_of("subprocess.Popen", (None, [1], tmp_path, None)) == []


def test_a_shell_that_ends_others_is_recognised() -> None:
    assert starts_a_killer("os.system", (b"python mission.py & pkill python",))
    assert not starts_a_killer("os.system", (b"python skills.py",))
