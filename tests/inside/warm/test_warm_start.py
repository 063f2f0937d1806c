"""A process that begins warm is told from one that begins in the plain way by nothing that it can see."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mutabot.border.starter import Starter, is_supported
from mutabot.campaign.workers.warm import WarmServer

from .programs import CASES, Case

pytestmark = pytest.mark.skipif(is_supported() is not None, reason=str(is_supported()))

PYTHON = str(Path(sys.executable))
#: what two processes never have in common
OWN = re.compile(r"0x[0-9a-f]+|/proc/\d+|socket:\[\d+\]|pipe:\[\d+\]")


def environment() -> dict[str, str]:
    """That of a worker, as far as it matters."""
    path = f"{Path(PYTHON).parent}:{os.environ['PATH']}"
    numbers = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    return {**os.environ, "PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1", "PATH": path, **numbers}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[WarmServer]:
    """A zygote of this process."""
    folder = tmp_path_factory.mktemp("zygote")
    found = WarmServer(folder, folder, environment(), own_session=False)
    found.starter.may_start = False
    yield found
    found.close()


def run(case: Case, folder: Path, starter: Starter | None) -> dict[str, Any]:
    """Start a case's program, and tell all that is to be seen of it from outside."""
    for name, text in case.files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(
            text.replace("{python}", PYTHON), encoding="latin-1" if "latin-1" in text else "utf-8"
        )
        file.chmod(0o755)
    filled = {"{python}": PYTHON, "{folder}": str(folder)}
    options = {"stdin": subprocess.PIPE, **case.options}
    env = {**environment(), **{name: fill(one, filled) for name, one in options.pop("env+", {}).items()}}
    cwd = folder / options.pop("cwd", ".")
    command = [fill(one, filled) for one in case.command]
    arguments: dict[str, Any] = dict(
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env, cwd=cwd, **options
    )
    if starter is None:
        process = subprocess.Popen(command, **arguments)
    else:
        with starter.at_work():
            process = subprocess.Popen(command, **arguments)
    said = b""
    if case.signal is not None:
        assert process.stdout is not None
        said = process.stdout.read(3)
        time.sleep(0.1)  # it has said so a moment before it waits
        process.send_signal(case.signal)
    output, errors = process.communicate(case.given.encode() if process.stdin else None, timeout=30)
    return {"code": process.returncode, "out": plain(said + output, folder), "err": plain(errors, folder)}


def fill(text: str, values: dict[str, str]) -> str:
    for name, value in values.items():
        text = text.replace(name, value)
    return text


def plain(output: bytes, folder: Path) -> Any:
    """Output without what is different every time."""
    text = OWN.sub("…", output.decode("utf-8", "backslashreplace").replace(str(folder), "FOLDER"))
    try:
        return json.loads(text)
    except ValueError:
        return text


def _less(one: Any, other: Any) -> Any:
    """Two values without what they have in common."""
    if isinstance(one, list) and isinstance(other, list):
        return [value for value in one if value not in other], [value for value in other if value not in one]
    if isinstance(one, dict) and isinstance(other, dict):
        return {
            name: (one.get(name), other.get(name))
            for name in one.keys() | other.keys()
            if one.get(name) != other.get(name)
        }
    return one, other


def differences(found: dict[str, Any], expected: dict[str, Any]) -> dict[str, Any]:
    """What is not the same."""
    if isinstance(found["out"], dict) and isinstance(expected["out"], dict):
        found, expected = {**found, **found["out"], "out": ""}, {**expected, **expected["out"], "out": ""}
    names = found.keys() | expected.keys()
    return {
        name: _less(found.get(name), expected.get(name))
        for name in names
        if found.get(name) != expected.get(name)
    }


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_begins_the_same_in_both_ways(case: Case, server: WarmServer, tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    before = server.starter.started
    expected = run(case, tmp_path / "one", None)
    found = run(case, tmp_path / "two", server.starter)
    text = str(differences(found, expected))
    assert text == "{}", text
    assert (server.starter.started > before) == case.is_warm, server.starter.refused
