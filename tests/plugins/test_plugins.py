"""Operators of third parties: a real package, installed with pip, and packages that break the contract."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests import command

PACKAGE = Path(__file__).parent / "package"
SCORE_TOO_LOW, USAGE, ERRORS = 1, 2, 4

#: approaches a wall until a laser says 10 cm; the test allows 2 cm either way
PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["approach.py"]
        vocabulary = ["robot.toml"]
        """,
    "robot.toml": """
        [[operation]]
        call = "robot:distance"
        result = { kind = "distance", unit = "m" }
        """,
    "robot.py": """
        gap = 0.0

        def distance():
            return gap

        def forward(amount):
            global gap
            gap -= amount
        """,
    "approach.py": """
        import robot

        def run():
            while robot.distance() > 0.101:
                robot.forward(0.01)
        """,
    "tests/test_approach.py": """
        import approach
        import robot

        def test_it_stops_before_the_wall():
            robot.gap = 0.15
            approach.run()
            assert abs(robot.gap - 0.10) <= 0.02
        """,
    "conftest.py": "",
}

#: those that are only found when they are used: by what of an operator the plan asks
ON_USE = {
    "fails on an operation": "subjects(self, whole)",
    "cannot say what it does": "describe(self, subject, before, after)",
    "has no middleware": "middleware(self, subject, random)",
    "does not know its needs": "needs_of(self, subject)",
}
#: how a plug-in can break the contract: (name in its extension, its code, what the error must tell)
BROKEN = {
    "raises at import": ("late", "raise RuntimeError('no licence')", "RuntimeError('no licence')"),
    "imports what is not there": ("late", "import not_there_at_all", "not_there_at_all"),
    "has no such class": ("late", "", "Rule"),
    "is no operator": ("late", "class Rule: name = 'late'", "not a subclass"),
    "cannot be made": (
        "late",
        "from mutabot.operators import Operator\nclass Rule(Operator):\n    name = 'late'",
        "abstract",
    ),
    "does not change any value": (
        "late",
        "from mutabot.api.faults import ValueOperator\nclass Rule(ValueOperator):\n    name = 'late'",
        "'late' defines neither change nor changes",
    ),
    "has another name": (
        "late",
        "from mutabot.operators.kinds.commands import Skip\nclass Rule(Skip):\n    name = 'early'",
        "'early'",
    ),
    **{
        how: (
            "late",
            "from mutabot.operators.kinds.readings import Negate\nclass Rule(Negate):\n    name = 'late'\n"
            f"    def {asked}:\n        raise KeyError('frame')",
            "KeyError('frame')",
        )
        for how, asked in ON_USE.items()
    },
}

#: repeats a call; breaks on a real answer, which the plan's rehearsal does not have
BREAKS_LATE = """
import sys

import pytest
from mutabot.operators.kinds.commands import Repeat

class Rule(Repeat):
    name = "late"

    def subjects(self, whole):
        return [whole]

    def middleware(self, subject, random):
        async def mutated(call, proceed):
            await proceed(call)
            reply = await proceed(call)
            if reply.payload is not None:
                raise_it()
            return reply

        return mutated
"""


#: a family that mutabot itself does not have
OF_ITS_OWN = """
from mutabot.operators.kinds.readings import Negate

class Rule(Negate):
    name = "late"
    family = "wild"
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the plug-in."""
    copy = tmp_path_factory.mktemp("source") / "package"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    target = tmp_path_factory.mktemp("installed")
    options = ["--no-build-isolation", "--no-deps", "--no-index", "--disable-pip-version-check", "--quiet"]
    done = subprocess.run(
        [sys.executable, "-m", "pip", "install", *options, "--target", str(target), str(copy)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return target


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A tiny project with one reading."""
    root = tmp_path / "project"
    for name, text in PROJECT.items():
        lines = text.strip("\n").splitlines()
        indent = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(line[indent:] for line in lines) + "\n", encoding="utf-8")
    return root


def python(path: Path | None, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python with ``path`` among the places where packages are found."""
    environment = {**os.environ, "PYTHONPATH": str(path) if path is not None else ""}
    return subprocess.run(
        [sys.executable, *arguments], env=environment, capture_output=True, text=True, check=False
    )


def mutabot(path: Path | None, project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run mutabot's command line on a project, with ``path`` among the places where packages are found."""
    return command.mutabot(project, *arguments, beside=path)


def broken_plug_in(folder: Path, name: str, code: str) -> Path:
    """A folder as an installer leaves it, with a plug-in of this code."""
    details = folder / "broken_plug_in-1.0.dist-info"
    details.mkdir(parents=True)
    (details / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-plug-in\nVersion: 1.0\n")
    (details / "entry_points.txt").write_text("[mutabot]\nbroken = broken_plug_in_extension:EXTENSION\n")
    (folder / "broken_plug_in_extension.py").write_text(
        "from mutabot.api.faults import Extension\n"
        f"EXTENSION = Extension(interface=2, operators={{{name!r}: 'broken_plug_in:Rule'}})\n"
    )
    (folder / "broken_plug_in.py").write_text(code)
    return folder


def mutants(done: subprocess.CompletedProcess[str], *, code: int = 0) -> dict[str, dict[str, Any]]:
    """The campaign's mutants by operator."""
    assert done.returncode == code, done.stderr
    return {mutant["operator"]: mutant for mutant in json.loads(done.stdout)["mutants"]}


def test_the_operator_of_an_installed_plug_in_gets_a_verdict(installed: Path, project: Path) -> None:
    creep = mutants(mutabot(installed, project, "run", "--json", "-o", "repeats=false"))["creep"]
    # Each reading is 5 mm farther off, half of what the robot drives in between: it drives too far.
    assert creep["id"] == "approach.py:run:robot.distance#1:result:creep"
    assert (creep["rounds"][0]["verdict"], creep["rounds"][0]["by"]) == ("killed", "check")
    assert creep["description"] == "robot.distance: reads 0.15 m and creeps"


def test_without_the_plug_in_its_operator_is_not_there(project: Path) -> None:
    assert set(mutants(mutabot(None, project, "list", "--json"))) == {"negate", "noise"}


def test_the_plug_ins_examples_do_what_they_say(installed: Path) -> None:
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from operators.test_examples import *\n"
        "assert 'creep' in names()\n"
        "for index in range(len(operator('creep').examples)):\n"
        "    test_the_example_does_what_it_says('creep', index)\n"
        "test_the_example_is_a_place_where_the_operator_acts()\n"
    )
    done = python(installed, "-c", code, str(Path(__file__).parents[1]))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("how", [how for how in BROKEN if how not in ON_USE])
def test_a_broken_plug_in_raises_an_operator_error_that_names_it(how: str, tmp_path: Path) -> None:
    name, code, told = BROKEN[how]
    ask = (
        "from mutabot.errors import OperatorError\n"
        "from mutabot.operators import operator\n"
        "try:\n    operator('late')\n"
        "except OperatorError as error:\n    print(error)\n"
    )
    done = python(broken_plug_in(tmp_path, name, code), "-c", ask)
    named = f"operator {name!r} of package 'broken-plug-in' (broken_plug_in:Rule)"
    assert done.stdout.startswith(named), done.stderr
    assert told in done.stdout


@pytest.mark.parametrize(
    "how", ["raises at import", *(pytest.param(how, marks=pytest.mark.whole) for how in ON_USE)]
)
def test_the_command_line_names_the_plug_in_that_is_broken(how: str, project: Path, tmp_path: Path) -> None:
    name, code, told = BROKEN[how]
    done = mutabot(broken_plug_in(tmp_path / "site", name, code), project, "list")
    assert done.returncode == USAGE, done.stderr
    assert "Traceback" not in done.stderr
    assert f"operator {name!r}" in done.stderr
    assert told in done.stderr


@pytest.mark.parametrize(
    ("raising", "told"),
    [
        ("raise ValueError('broken')", "ValueError: broken"),
        pytest.param("pytest.fail('broken')", "Failed: broken", marks=pytest.mark.whole),
        pytest.param("pytest.skip('broken')", "Skipped: broken", marks=pytest.mark.whole),
        pytest.param("sys.exit('broken')", "SystemExit: broken", marks=pytest.mark.whole),
    ],
)
def test_an_operator_that_fails_while_at_work_is_an_error_and_never_a_kill(
    raising: str, told: str, project: Path, tmp_path: Path
) -> None:
    code = BREAKS_LATE + f"\ndef raise_it():\n    {raising}\n"
    site = broken_plug_in(tmp_path / "site", "late", code)
    done = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--only", "late")
    end = mutants(done, code=ERRORS)["late"]["rounds"][0]
    assert end["verdict"] == "error"
    assert end["message"] == f"operator late: {told}"


@pytest.mark.whole
def test_a_family_of_a_plug_ins_own_is_planted_where_it_is_asked_for(project: Path, tmp_path: Path) -> None:
    site = broken_plug_in(tmp_path / "site", "late", OF_ITS_OWN)
    usual = mutabot(site, project, "list", "--json")
    assert set(mutants(usual)) == {"negate", "noise"}
    assert "operators of family 'wild' are not asked for: add --family wild" in usual.stderr
    both = mutabot(site, project, "list", "--json", "--family", "wild,robot")
    assert set(mutants(both)) == {"negate", "noise", "late"}
    assert "not asked for" not in both.stderr
    configuration = project / "pyproject.toml"
    configuration.write_text(configuration.read_text() + 'families = ["wild"]\n')
    late = mutants(mutabot(site, project, "list", "--json"))
    assert {name: value["family"] for name, value in late.items()} == {"late": "wild"}


@pytest.mark.parametrize("where", ["--family", "families"])
def test_a_family_that_no_plug_in_brings_is_named_with_the_nearest(
    where: str, project: Path, tmp_path: Path
) -> None:
    site = broken_plug_in(tmp_path / "site", "late", OF_ITS_OWN)
    configuration = project / "pyproject.toml"
    if where == "families":
        configuration.write_text(configuration.read_text() + 'families = ["wilt"]\n')
    done = mutabot(site, project, "list", *(["--family", "wilt"] if where == "--family" else []))
    assert done.returncode == USAGE
    assert "unknown family 'wilt'; did you mean 'wild'?" in done.stderr
