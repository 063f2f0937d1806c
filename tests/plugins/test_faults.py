"""A provider of faults that a package brings: parameters of a simulated world, set before each test."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from tests.plugins.test_plugins import ERRORS, USAGE, mutabot, mutants, python

PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["world.py"]
        families = ["toys"]
        """,
    "world.py": """
        gravity = 9.81
        colour = 0.5
        mass = 1.0

        def seconds_to_fall(height):
            return (2.0 * height / gravity) ** 0.5
        """,
    "conftest.py": "",
    "tests/test_world.py": """
        import world

        def test_it_falls_at_all():
            assert world.seconds_to_fall(1.0) < 10.0

        def test_it_falls_in_time():
            assert abs(world.seconds_to_fall(1.0) - 0.45) < 0.01

        def test_the_world_is_as_it_was():
            assert (world.gravity, world.colour) != (9.81, 0.25)
        """,
}
#: what the package does to which parameter, and how that ends
ENDS = {
    "gravity": (5.0, "killed"),
    "colour": (0.75, "survived"),
    "mass": (1.0, "no effect"),
    "wind": (1.0, "error"),
}
PACKAGE = {
    "toy_world.py": """
        from mutabot.api.faults import Activation, Extension, FaultProvider, Planned, PlannedMutant
        from mutabot.api.faults import Rule, Site

        EXTENSION = Extension(interface=2, faults={"toy": "toy_world:Parameters"})
        VALUES = %r

        class Parameter(Rule):
            name = "parameter"
            family = "toys"
            summary = "A parameter of the world has another value."

        class Parameters(FaultProvider):
            name = "toy"
            families = ("toys",)
            location = "parameter"

            def rules(self):
                return [Parameter()]

            def plan(self, project, original):
                planned = Planned()
                for name, value in VALUES.items():
                    site = Site.of_parameter("world", name)
                    told = f"world.{name} is {value:g}"
                    mutant = self.mutant(Parameter(), site, told, variant=f"{value:g}")
                    how = Activation("toy_world_inside:Parameter", {"name": name, "value": value})
                    planned.mutants.append(PlannedMutant(mutant, does=how.data, active=how))
                    for round, tests in enumerate(original.tests):
                        planned.reach(round, site, tests)
                return planned
        """
    % {name: value for name, (value, _) in ENDS.items()},
    "toy_world_inside.py": """
        from importlib import import_module

        from mutabot.api.faults import ActiveFault

        class Parameter(ActiveFault):
            def start_test(self, test, random):
                self.world, name, value = import_module("world"), self.data["name"], self.data["value"]
                self.before = getattr(self.world, name)
                setattr(self.world, name, value)
                self.reached() if value == self.before else self.acts(self.before, value)

            def end_test(self):
                setattr(self.world, self.data["name"], self.before)
        """,
    "toy_world-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: toy-world\nVersion: 1.0\n",
    "toy_world-1.0.dist-info/entry_points.txt": "[mutabot]\ntoy = toy_world:EXTENSION\n",
}


FORMATS = ("csv", "github", "junit", "markdown", "mutation-testing", "sarif")


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(dedent(text).lstrip("\n"), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the package is installed."""
    return write(tmp_path_factory.mktemp("site"), PACKAGE)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project whose tests let one of two parameters be another."""
    return write(tmp_path / "project", PROJECT)


def by_parameter(found: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {mutant["id"].partition(":")[2].partition(":")[0]: mutant for mutant in found["mutants"]}


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_parameters_get_verdicts(engine: str, site: Path, project: Path) -> None:
    done = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--engine", engine)
    assert done.returncode == ERRORS, done.stderr
    found = by_parameter(json.loads(done.stdout))
    rounds = {name: mutant["rounds"][0] for name, mutant in found.items()}
    assert {name: end["verdict"] for name, end in rounds.items()} == {
        name: verdict for name, (_, verdict) in ENDS.items()
    }
    assert found["gravity"]["id"] == "world:gravity:parameter=5"
    assert rounds["gravity"]["test"] == "tests/test_world.py::test_it_falls_in_time"
    assert rounds["gravity"]["engine"] == engine
    assert (rounds["colour"]["hits"], rounds["colour"]["acted"]) == (3, 3)
    assert (rounds["mass"]["hits"], rounds["mass"]["acted"]) == (3, 0)
    assert rounds["mass"]["message"] == "the site was reached, but no value changed"
    assert "parameter cannot be put in place: AttributeError" in rounds["wind"]["message"]
    reports = [
        ["results"],
        ["show", "1"],
        *(["report", "--format", report_format] for report_format in FORMATS),
    ]
    every = (
        "import sys; from mutabot.cli.app import main; sys.exit([main(words) for words in %r] != [0] * %d)"
    )
    told = python(site, "-c", every % ([["-C", str(project), *words] for words in reports], len(reports)))
    assert told.returncode == 0, told.stderr
    again = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--engine", engine)
    assert by_parameter(json.loads(again.stdout))["colour"]["rounds"][0]["verdict"] == "survived"


def test_what_only_forks_may_judge_is_handed_on_with_the_reason(tmp_path: Path, project: Path) -> None:
    unforked = PACKAGE["toy_world.py"].replace('"value": value})', '"value": value}, keys=())')
    site = write(tmp_path / "site", {**PACKAGE, "toy_world.py": unforked})
    done = mutabot(site, project, "run", "--json", "--engine", "fork", "--only", "1")
    (found,) = mutants(done, code=ERRORS).values()
    end = found["rounds"][0]
    assert end["verdict"] == "error"
    assert (
        end["message"] == "it could not be forked: it is active before any point at which it could be forked"
    )


def test_its_operators_are_listed_and_its_family_is_known(site: Path, project: Path) -> None:
    done = mutabot(site, project, "operators", "--family", "toys", "--json")
    assert [operator["name"] for operator in json.loads(done.stdout)["operators"]] == ["parameter"]
    unknown = mutabot(None, project, "list")
    assert unknown.returncode == USAGE
    assert "unknown family 'toys'" in unknown.stderr


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("class Parameters:\n    name = 'toy'", "is not a subclass of mutabot.faults.FaultProvider"),
        ("raise RuntimeError('no licence')", "RuntimeError('no licence')"),
    ],
)
def test_a_provider_that_is_of_no_use_is_named(code: str, told: str, project: Path, tmp_path: Path) -> None:
    extension = PACKAGE["toy_world.py"].replace("toy_world:Parameters", "toy_broken:Parameters")
    site = write(tmp_path / "site", {**PACKAGE, "toy_world.py": extension, "toy_broken.py": code})
    done = mutabot(site, project, "list")
    assert done.returncode == USAGE, done.stderr
    assert "'toy' of package 'toy-world'" in done.stderr
    assert told in done.stderr
    assert "Traceback" not in done.stderr


def test_mutants_of_calls_need_nothing_that_parses_program_text(project: Path) -> None:
    vocabulary = '[[operation]]\ncall = "world:seconds_to_fall"\nresult = { kind = "distance", unit = "m" }\n'
    configuration = PROJECT["pyproject.toml"].replace('families = ["toys"]', 'vocabulary = ["world.toml"]')
    write(project, {"pyproject.toml": configuration, "world.toml": vocabulary})
    run = "\ndef run():\n    return seconds_to_fall(1.0)\n"
    (project / "world.py").write_text(dedent(PROJECT["world.py"]) + run)
    (project / "tests" / "test_world.py").write_text(
        "import sys\nimport world\n\ndef test_it():\n    assert world.run() > 0.4\n"
        "    assert 'libcst' not in sys.modules\n"
    )
    code = (
        "import sys\nfrom mutabot.cli.app import main\ncode = main()\n"
        "assert 'libcst' not in sys.modules\nsys.exit(code)"
    )
    done = python(None, "-c", code, "-C", str(project), "run", "--json", "--only", "negate")
    assert [mutant["operator"] for mutant in json.loads(done.stdout)["mutants"]] == ["negate"], done.stderr
