"""A provider whose faults begin at a simulated time, in magnitudes, as a package outside brings it."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from tests.plugins.test_faults import write
from tests.plugins.test_plugins import ERRORS, SCORE_TOO_LOW, USAGE, mutabot

#: a box that slides on a belt until friction stops it; the program drives it to a mark
PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["mission.py"]
        vocabulary = ["belt.toml"]
        families = ["world"]
        slippery = { at = 1.0 }
        """,
    "belt.toml": """
        clock = { tick = "belt:Belt.advance", unit = "s" }
        """,
    "belt.py": """
        class Belt:
            friction = 1.0

            def __init__(self):
                self.time, self.position = 0.0, 0.0

            def advance(self, speed):
                self.time += 0.1
                self.position += 0.1 * speed * type(self).friction
                return self.time
        """,
    "mission.py": """
        import belt

        def drive(seconds):
            here = belt.Belt()
            while here.time < seconds:
                here.advance(1.0)
            return here.position
        """,
    "conftest.py": "",
    "tests/test_mission.py": """
        import belt
        import mission

        def test_a_short_way():
            assert abs(mission.drive(0.5) - 0.55) < 0.1

        def test_a_long_way():
            assert abs(mission.drive(3.0) - 3.0) < 0.5

        def test_the_belt_is_as_it_was():
            assert belt.Belt.friction == 1.0
        """,
}
PACKAGE = {
    "slippery.py": """
        from mutabot.api.faults import Activation, Extension, FaultProvider, Planned, PlannedMutant
        from mutabot.api.faults import Rule, Site

        EXTENSION = Extension(
            interface=2,
            faults={"slippery": "slippery:Slippery"},
            tables={"slippery": "slippery_table:Slip"},
        )

        class Slip(Rule):
            name = "slip"
            family = "world"
            summary = "From a simulated time on, things slip."
            has_sizes = True
            has_moments = %(has_moments)s

        class Slippery(FaultProvider):
            name = "slippery"
            families = ("world",)
            location = "parameter"

            def rules(self):
                return [Slip()]

            def plan(self, project, original):
                planned, at = Planned(), project.tables["slippery"].at
                keys = (Activation.at_time(at),)
                active = Activation("slippery_inside:Slip", {"at": at}, keys, %(awaits)s)
                site = Site.of_parameter("belt", "friction")
                for size in (0.05, 0.5):
                    told = f"friction is {size:g} less from {at:g} s on"
                    mutant = self.mutant(Slip(), site, told, variant=f"{size:g}", magnitude=size)
                    planned.mutants.append(PlannedMutant(mutant, does=size, active=active))
                for round, tests in enumerate(original.tests):
                    reached = [test for test in tests if original.simulated(round, test) >= at]
                    planned.reach(round, site, reached)
                return planned
        """,
    "slippery_table.py": """
        from pydantic import Field

        from mutabot.api.processes import Table

        class Slip(Table):
            at: float = Field(1.0, description="Simulated seconds.", examples=["1.0"])
        """,
    "slippery_inside.py": """
        %(head)s
        from mutabot.api.faults import ActiveFault

        class Slip(ActiveFault):
            def start_test(self, test, random):
                self.before = None

            def reach(self, key):
                from belt import Belt
                assert self.context.seconds >= self.data["at"], self.context.seconds
                self.before = Belt.friction
                Belt.friction -= self.mutant.magnitude
                self.acts(self.before, Belt.friction)

            def end_test(self):
                if self.before is not None:
                    from belt import Belt
                    Belt.friction = self.before
        """,
    "slippery-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: slippery\nVersion: 1.0\n",
    "slippery-1.0.dist-info/entry_points.txt": "[mutabot]\nslippery = slippery:EXTENSION\n",
}


def installed(folder: Path, head: str = "", awaits: str = "'<test>'", *, has_moments: bool = False) -> Path:
    """A folder into which the package is installed."""
    said = {"head": head, "awaits": awaits, "has_moments": has_moments}
    filled = {name: text % said for name, text in PACKAGE.items()}
    return write(folder / "site", filled)


def rounds(folder: Path, site: Path, *options: str) -> dict[str, dict[str, Any]]:
    """How each mutant ended, by its magnitude."""
    done = mutabot(site, folder, "run", "--json", "--fresh", *options)
    assert done.returncode == 0, done.stderr
    return {
        mutant["id"].rpartition("=")[2]: mutant["rounds"][0] for mutant in json.loads(done.stdout)["graded"]
    }


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_a_fault_begins_at_its_simulated_time(engine: str, tmp_path: Path) -> None:
    site, project = installed(tmp_path), write(tmp_path / "project", PROJECT)
    found = rounds(project, site, "--engine", engine)
    assert {size: (end["verdict"], end["engine"]) for size, end in found.items()} == {
        "0.05": ("survived", engine), "0.5": ("killed", engine),
    }  # fmt: skip
    assert found["0.5"]["test"] == "tests/test_mission.py::test_a_long_way"
    assert {end["acted"] for end in found.values()} == {1}


#: an engine, and what the fault awaits
WAYS = [(engine, awaits) for engine in ("fork", "replay") for awaits in ("'belt'", "'<tick>'")]
#: the same, with the simulator in a process below the tests
BELOW = {
    **PROJECT,
    "mission.py": """
        import subprocess
        import sys

        def drive(seconds):
            words = [sys.executable, "drive.py", str(seconds)]
            return float(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
        """,
    "drive.py": """
        import sys
        import belt

        here = belt.Belt()
        while here.time < float(sys.argv[1]):
            here.advance(1.0)
        print(here.position)
        """,
    "pyproject.toml": PROJECT["pyproject.toml"].replace('"mission.py"', '"mission.py", "drive.py"'),
}


@pytest.mark.parametrize(
    ("engine", "awaits"),
    [
        ("fork", "'belt'"),
        *(pytest.param(*way, marks=pytest.mark.whole) for way in WAYS if way != ("fork", "'belt'")),
    ],
)
def test_a_process_below_the_tests_has_the_fault_when_it_has_what_that_needs(
    engine: str, awaits: str, tmp_path: Path
) -> None:
    head = "import sys; assert 'belt' in sys.modules, 'the simulator is not there yet'"
    site, project = installed(tmp_path, head, awaits), write(tmp_path / "project", BELOW)
    found = rounds(project, site, "--engine", engine)
    assert {size: (end["verdict"], end["engine"]) for size, end in found.items()} == {
        "0.05": ("survived", engine), "0.5": ("killed", engine),
    }  # fmt: skip


@pytest.mark.whole
def test_a_fault_that_does_not_wait_for_its_simulator_cannot_be_put_in_place(tmp_path: Path) -> None:
    head = "import sys; assert 'belt' in sys.modules, 'the simulator is not there yet'"
    site, project = installed(tmp_path / "site", head, "''"), write(tmp_path / "project", PROJECT)
    done = mutabot(site, project, "run", "--json", "--engine", "replay")
    assert done.returncode == ERRORS
    assert "slip cannot be put in place: AssertionError: the simulator is not there yet" in done.stdout


def test_a_fault_that_needs_a_simulator_waits_until_the_program_has_imported_it(tmp_path: Path) -> None:
    head = "import sys; assert 'belt' in sys.modules, 'the simulator is not there yet'"
    project = write(tmp_path / "project", PROJECT)
    found = rounds(project, installed(tmp_path / "site", head, "'belt'"), "--engine", "replay")
    assert {size: end["verdict"] for size, end in found.items()} == {"0.05": "survived", "0.5": "killed"}


DEMAND = """
[[tool.mutabot.demand]]
operator = "slip"
site = "%s"
notice = 0.2
"""


def test_a_demanded_magnitude_of_a_package_is_planted_searched_and_judged(tmp_path: Path) -> None:
    configuration = PROJECT["pyproject.toml"].replace('families = ["world"]', 'families = ["robot"]')
    demanding = {"pyproject.toml": dedent(configuration) + DEMAND % "friction"}
    project = write(tmp_path / "project", {**PROJECT, **demanding})
    done = mutabot(installed(tmp_path), project, "run", "--json")
    found = {graded["magnitude"]: graded for graded in json.loads(done.stdout)["graded"]}
    verdicts = {size: mutant["rounds"][0]["verdict"] for size, mutant in found.items()}
    assert verdicts == {0.05: "survived", 0.2: "survived", 0.5: "killed"}
    assert found[0.2]["description"] == "friction is 0.2 less from 1 s on"
    assert [graded["number"] for graded in found.values()] == [1, 2, 3]
    assert done.returncode == SCORE_TOO_LOW
    assert "survives 0.2 in round 1 (mutant 2)" in done.stderr
    told = json.loads(mutabot(tmp_path / "site", project, "thresholds", "--json").stdout)
    (ladder,) = told["ladders"]
    assert (ladder["place"], ladder["none_up_to"], ladder["all_from"]) == ("belt", 0.2, 0.5)


def test_a_demand_of_a_package_that_speaks_of_nothing_is_reported_and_others_are_refused(
    tmp_path: Path,
) -> None:
    site = installed(tmp_path)
    files = {"pyproject.toml": dedent(PROJECT["pyproject.toml"]) + DEMAND % "gravity"}
    project = write(tmp_path / "project", {**PROJECT, **files})
    told = mutabot(site, project, "list").stderr
    assert "no mutant of slip is what it speaks of" in told
    assert "`mutabot list --family world` names the sites" in told
    wrong = (project / "pyproject.toml").read_text().replace('"slip"', '"slipp"')
    (project / "pyproject.toml").write_text(wrong)
    done = mutabot(site, project, "list")
    assert done.returncode == USAGE
    assert "did you mean 'slip'?" in done.stderr


@pytest.mark.parametrize("has_moments", [False, True])
def test_moments_are_for_operators_that_have_some(has_moments: bool, tmp_path: Path) -> None:
    site, project = installed(tmp_path, has_moments=has_moments), write(tmp_path / "project", PROJECT)
    done = mutabot(site, project, "list", "--json", "-o", "when=['from 2', 'once']")
    found = json.loads(done.stdout)
    ids = [f"belt:friction:slip={size}{'@from 2' if has_moments else ''}" for size in ("0.05", "0.5")]
    assert [mutant["id"] for mutant in found["mutants"]] == ids
    reasons = {omission["reason"] for omission in found["left_out"]}
    unknown = {"how often a test reaches it is not known, so that no moment can be drawn"}
    assert reasons == (unknown if has_moments else set())
    is_told = "mutants of world ignore it: only mutants of calls have moments" in done.stderr
    assert is_told is not has_moments
