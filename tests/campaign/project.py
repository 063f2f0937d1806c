"""Small projects on disk, and campaigns on them, for tests of the controller."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model import Outcome

#: the reference, as one of several engines: it takes long, and that it agrees with forks is for the corpus
REPLAY = pytest.param("replay", marks=pytest.mark.whole)
ROBOT = """
    class Refused(Exception):
        pass

    class Diverged(Exception):
        pass

    class Broken(AssertionError):
        pass

    class Arm:
        def __init__(self, x=0.0):
            self.x = x

        def move_by(self, dx):
            if not -1.0 <= self.x + dx <= 1.0:
                raise Refused(f"{self.x + dx} is out of reach")
            self.x += dx

        def position(self):
            return self.x
"""
VOCABULARY = """
    refusals = ["robot:Refused"]
    checks = ["robot:Broken"]
    failures = ["robot:Diverged"]

    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.position"
    result = { kind = "position", axis = "x", unit = "m", noise = 0.5 }
"""
#: a program, and tests of which the second passes only after the first
DEPENDENT = (
    """
    def prepare(arm):
        arm.move_by(0.25)

    def finish(arm):
        return arm.position()
    """,
    """
    import builtins
    import mission
    from robot import Arm

    builtins.ARM = Arm()  # where nobody looks for state

    def test_a_prepares():
        mission.prepare(ARM)
        for _ in range(3):
            ARM.position()
        assert ARM.x == 0.25

    def test_b_finishes():
        mission.finish(ARM)
        assert ARM.x == 0.25
    """,
)
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
"""


@dataclass
class Quiet(Progress):
    """A progress that keeps what it is told."""

    lines: list[str] = field(default_factory=list)

    def stage(self, text: str, total: int | None = None) -> None:
        self.lines.append(f"== {text} {total}")

    def advance(self, line: str | None = None) -> None:
        self.lines.append(line or "")

    def note(self, text: str) -> None:
        self.lines.append(text)


def write_project(
    folder: Path,
    mission: str,
    tests: str,
    *,
    robot: str = ROBOT,
    vocabulary: str = VOCABULARY,
    configuration: str = CONFIGURATION,
    more: Mapping[str, str] | None = None,
) -> Path:
    """A project with one program, one robot module and one test file."""
    files = {
        "mission.py": mission,
        "robot.py": robot,
        "robot.toml": vocabulary,
        "mutabot.toml": configuration,
        "tests/test_mission.py": tests,
        **(more or {}),
    }
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text), encoding="utf-8")
    return folder


@cache
def no_private_files() -> str | None:
    """Why this system lets no process keep its files to itself, so that none is forked; None if it does."""
    code = "from mutabot.runtime.isolation.files import _enter_namespace; _enter_namespace()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.stderr.strip().splitlines()[-1] if done.returncode else None


def request_for(folder: Path, **changes: Any) -> Request:
    """The request that ``mutabot run -o repeats=false`` would make in this folder: repeats take time."""
    if changes.get("engine") == "fork" and (why := no_private_files()) is not None:
        pytest.skip(why)
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    values = {
        "rounds": configuration.rounds,
        "seed": configuration.seed,
        "jobs": 2,
        "repeats": False,
        **changes,
    }
    return Request(configuration, vocabulary, **values)


def run(folder: Path, **changes: Any) -> dict[str, Outcome]:
    """A whole campaign; outcomes of the first round by mutant id."""
    path = run_campaign(request_for(folder, **changes), Quiet())
    return {outcome.mutant: outcome for outcome in outcomes(path) if outcome.round == 0}


def by_forks(folder: Path, **changes: Any) -> dict[tuple[str, int], Outcome]:
    """Outcomes by mutant and round, of forks where these can be; that replay agrees is for the corpus."""
    path = run_campaign(request_for(folder, **{"engine": "auto", **changes}), Quiet())
    return {(outcome.mutant, outcome.round): outcome for outcome in outcomes(path)}


def outcomes(path: Path) -> list[Outcome]:
    with Journal.open(path) as journal:
        return journal.outcomes()


def fingerprint(folder: Path) -> dict[str, str]:
    """Every file of the project, bar mutabot's own folder, with a hash of its content."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".mutabot" not in path.parts
    }
