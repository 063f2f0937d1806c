"""A package beside the core brings an executor, a table, a sub-command and a format; or is not there."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest
from tests import command

import mutabot
from campaign.project import write_project

USAGE = 2
MISSION = "def run(arm):\n    arm.move_by(0.5)\n"
TESTS = "from mission import run\nfrom robot import Arm\n\ndef test_run():\n    run(Arm())\n"
CONFIGURATION = """
    [tool.mutabot]
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    [tool.mutabot.toy]
    files = ["mission.py"]
    speed = 3
    """
#: its declaration imports nothing of it
EXTENSION = """
    from mutabot.extensions import Described, Extension

    EXTENSION = Extension(
        interface=2,
        executors={"toy": Described("toy.parts:Choice", "Run it on toys.", "HOW")},
        tables={"toy": "toy.parts:ToyTable"},
        commands={"play": Described("toy.parts:play", "Play with the campaign.", before="list")},
        formats={"toys": "toy.parts:toys"},
        sections={"toys": "toy.parts:count"},
    )
    """
PARTS = '''
    from dataclasses import dataclass
    import typer

    from mutabot.api.processes import ExecutorChoice, ProjectFiles, Request, Table
    from mutabot.api.reports import UsageError

    class ToyTable(Table):
        files: ProjectFiles = ()
        speed: int = 1

    class Preview:
        folders_left_out = ("tests",)

        def __init__(self, table):
            self.table = table

        def lacking(self, opened):
            return f"toys lack {sorted(name for name in opened or () if name.endswith('data.txt'))}"

        def check(self, opened):
            return [f"toy       {self.lacking(opened)}"], {"speed": self.table.speed}

    @dataclass(frozen=True)
    class Choice(ExecutorChoice):
        how: str
        speed: int

        @classmethod
        def parse(cls, value, root, table):
            if value != "gently":
                raise UsageError(f"--toy {value}: only gently")
            return cls(value, table.speed)

        def open(self, request, tell):
            tell(f"toys run {self.how} at speed {self.speed}")
            return request.on_this_machine(tell)

        @classmethod
        def preview(cls, request):
            return Preview(request.configuration.tables["toy"])

    def play(request: Request):
        """Play with the campaign, and tell how."""
        typer.echo(f"{request.executor} in {request.rounds} rounds")

    def count(results):
        return {"mutants": len(results.mutants)}

    def toys(material):
        return f"{len(material.campaign.mutants)} toys"

    NOTHING = None
    '''


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder with an installed package that brings one of each."""
    return package(tmp_path / "site", EXTENSION, PARTS)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project that uses its table."""
    root = write_project(tmp_path / "project", MISSION, TESTS)
    (root / "mutabot.toml").unlink(missing_ok=True)
    (root / "pyproject.toml").write_text(dedent(CONFIGURATION))
    return root


def package(site: Path, extension: str, parts: str = "") -> Path:
    """A package named toy, as pip would leave it."""
    (site / "toy").mkdir(parents=True)
    (site / "toy" / "__init__.py").write_text("")
    (site / "toy" / "extension.py").write_text(dedent(extension))
    (site / "toy" / "parts.py").write_text(dedent(parts))
    details = site / "toy_package-1.0.dist-info"
    details.mkdir()
    (details / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-package\nVersion: 1.0\n")
    (details / "entry_points.txt").write_text("[mutabot]\ntoy = toy.extension:EXTENSION\n")
    return site


def mutabot_with(site: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """The command line, where packages in ``site`` are installed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "100")
        return command.mutabot(folder, *words, beside=site)


def python(site: Path, *words: str) -> subprocess.CompletedProcess[str]:
    found = {**os.environ, "PYTHONPATH": str(site), "COLUMNS": "100"}
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, env=found, check=False)


def test_the_option_of_an_executor_chooses_it_and_its_table_is_read(site: Path, project: Path) -> None:
    done = mutabot_with(site, project, "run", "--toy", "gently", "-o", "repeats=false", "-o", "toy.speed=7")
    assert done.returncode == 0, done.stderr
    assert "toys run gently at speed 7" in done.stderr
    assert "toys lack []" in done.stderr
    said = mutabot_with(site, project, "report", "--format", "toys")
    assert said.stdout.endswith(" toys\n"), said.stderr
    found = json.loads(mutabot_with(site, project, "results", "--json").stdout)
    assert found["sections"] == {"toys": {"mutants": len(found["mutants"])}}


def test_a_wrong_value_of_an_executor_is_refused_before_anything_runs(site: Path, project: Path) -> None:
    done = mutabot_with(site, project, "run", "--toy", "wildly")
    assert (done.returncode, done.stderr) == (USAGE, "mutabot: --toy wildly: only gently\n")


@pytest.mark.needs("dask")
def test_a_campaign_has_one_executor(site: Path, project: Path) -> None:
    both = mutabot_with(site, project, "run", "--toy", "gently", "--cluster", "local:1")
    assert both.returncode == USAGE
    assert "--cluster and --toy: a campaign has one executor" in both.stderr


def test_check_says_what_an_executor_with_a_table_would_take_elsewhere(site: Path, project: Path) -> None:
    (project / "tests" / "data.txt").write_text("")
    test = project / "tests" / "test_data.py"
    test.write_text("def test_data():\n    open('tests/data.txt').close()\n")
    done = mutabot_with(site, project, "check")
    assert done.returncode == 0, done.stderr
    assert "toy       toys lack ['tests/data.txt']" in done.stdout


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("speed = 3", "sped = 3", ":7 · tool.mutabot.toy.sped: unknown key 'sped'; did you mean 'speed'?"),
        ("speed = 3", "speed = '3'", ":7 · tool.mutabot.toy.speed: expected a whole number"),
        (
            '["mission.py"]\nsp',
            '["misson.py"]\nsp',
            ":6 · tool.mutabot.toy.files#1: there is no 'misson.py'; did",
        ),
        ("mutabot.toy]", "mutabot.toys]", ":5 · tool.mutabot.toys: unknown key 'toys'; did you mean 'toy'?"),
    ],
)
def test_a_mistake_in_a_table_of_a_package_is_reported_like_any(
    old: str, new: str, told: str, site: Path, project: Path
) -> None:
    file = project / "pyproject.toml"
    file.write_text(file.read_text().replace(old, new))
    done = mutabot_with(site, project, "list")
    assert done.returncode == USAGE
    assert told in done.stderr


def test_a_list_in_a_table_can_be_one_text_on_the_command_line(site: Path, project: Path) -> None:
    done = mutabot_with(site, project, "list", "-o", "toy.files=nowhere.py")
    assert "-o toy.files=nowhere.py · tool.mutabot.toy.files#1: there is no 'nowhere.py'" in done.stderr


def test_a_command_of_a_package_has_the_options_that_it_asks_for(site: Path, project: Path) -> None:
    done = mutabot_with(site, project, "play", "--toy", "gently", "--rounds", "4")
    assert done.stdout == "Choice(how='gently', speed=3) in 4 rounds\n", done.stderr
    text = mutabot_with(site, project, "play", "--help").stdout
    assert "Play with the campaign, and tell how." in text
    assert "--toy HOW" in text
    assert "Run it on toys." in text
    assert "did you mean 'play'" in mutabot_with(site, project, "plai").stderr.lower()


@pytest.mark.parametrize(("before", "follows"), [("list", "list"), ("lst", "")])
def test_help_lists_a_command_before_the_one_that_its_package_names_else_last(
    before: str, follows: str, tmp_path: Path
) -> None:
    site = package(tmp_path, EXTENSION.replace('before="list"', f'before="{before}"'), PARTS)
    shown = mutabot_with(site, tmp_path, "--help").stdout
    listed = shown.partition("Commands:\n")[2].partition("\n\n")[0].splitlines()
    names = [line.split()[0] for line in listed]
    assert [*names, ""][names.index("play") + 1] == follows


def test_help_names_packages_and_imports_none_of_them(site: Path) -> None:
    code = (
        "import sys; from mutabot.cli.app import main\n"
        "main(sys.argv[1:]); print(*sys.modules, file=sys.stderr)"
    )
    for words in (["--help"], ["run", "--help"]):
        done = python(site, "-c", code, *words)
        assert ("Play with the campaign." if len(words) == 1 else "--toy HOW") in done.stdout
        packages = (
            "toy.", "mutabot_dask.", "mutabot_init.", "mutabot_live.", "mutabot_motion.", "mutabot_suggest.",
        )  # fmt: skip
        loaded = {name for name in done.stderr.split() if name.startswith(packages)}
        assert {name for name in loaded if not name.endswith(".extension")} == set()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"play"', '"show"', "'show' of package 'toy-package' has the name of one of 'mutabot' (commands)"),
        ("parts:play", "parts:NOTHING", "of package 'toy-package' (toy.parts:NOTHING) is not a function"),
        ("parts:play", "parts:ply", "'play' of package 'toy-package' (toy.parts:ply) cannot be loaded"),
        ("interface=2", "interface=3", "was written for version 3 of the extension interface"),
    ],
)
def test_a_package_that_does_not_fit_is_named(old: str, new: str, told: str, tmp_path: Path) -> None:
    assert old in EXTENSION
    site = package(tmp_path / "site", EXTENSION.replace(old, new), PARTS)
    done = mutabot_with(site, tmp_path, "play")
    assert done.returncode == USAGE
    assert told in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "words", "told"),
    [
        (
            "parts:Choice",
            "parts:ToyTable",
            ["run", "--toy", "gently"],
            "is not a subclass of mutabot.campaign",
        ),
        ("parts:ToyTable", "parts:Choice", ["list"], "is not a subclass of mutabot.config.table.Table"),
        ('tables={"toy"', 'tables={"seed"', ["list"], "has the name of one of 'mutabot' (tables)"),
        ('"toys"', '"csv"', ["report", "--format", "pages"], "has the name of one of 'mutabot' (formats)"),
        ("parts:toys", "parts:NOTHING", ["report", "--format", "toys"], "NOTHING) is not a function"),
    ],
)
def test_a_part_that_is_not_what_it_should_be_is_named(
    old: str, new: str, words: list[str], told: str, tmp_path: Path, project: Path
) -> None:
    site = package(tmp_path / "site", EXTENSION.replace(old, new), PARTS)
    done = mutabot_with(site, project, *words)
    assert done.returncode == USAGE, done.stdout
    assert told in done.stderr


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder without these packages beside the core."""
    ignored = shutil.ignore_patterns(
        "mutabot_catalogue",
        "mutabot_dask",
        "mutabot_init",
        "mutabot_live",
        "mutabot_minimal",
        "mutabot_motion",
        "mutabot_suggest",
    )
    source = Path(mutabot.__file__).parents[1]
    return Path(shutil.copytree(source, tmp_path_factory.mktemp("site") / "alone", ignore=ignored))


#: runs the command line as if these were not installed
ALONE = """
import sys
from pathlib import Path
sys.path[:] = [one for one in sys.path if not Path(one, "mutabot_dask").is_dir()]
from mutabot.cli.app import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["init"], "the command init comes with the package mutabot_init, which is not installed"),
        (["motion", "3"], "the command motion comes with the package mutabot_motion, which is not installed"),
        (["run", "--cluster", "local:2"], "--cluster comes with the package mutabot_dask, which is not"),
        pytest.param(
            ["suggest"],
            "the command suggest comes with the package mutabot_suggest, which is not installed",
            marks=pytest.mark.whole,
        ),
        pytest.param(
            ["live"],
            "the command live comes with the package mutabot_live, which is not installed",
            marks=pytest.mark.whole,
        ),
        (["list", "--family", "catalogue"], "the family catalogue comes with the package mutabot_catalogue"),
        (["list"], "pyproject.toml:5 · tool.mutabot.cluster: comes with the package mutabot_dask, which"),
    ],
)
def test_what_a_package_of_ours_brings_that_is_not_installed_is_named(
    words: list[str], told: str, alone: Path, project: Path
) -> None:
    file = project / "pyproject.toml"
    file.write_text(file.read_text().replace("mutabot.toy]", "mutabot.cluster]").replace("speed = 3", ""))
    done = python(alone, "-c", ALONE, "-C", str(project), *words)
    assert done.returncode == USAGE, done.stdout
    assert f"mutabot: {told}" in done.stderr


@pytest.mark.parametrize("option", ["--live", "--init"])
def test_a_command_that_is_not_installed_is_no_missing_option(
    option: str, alone: Path, project: Path
) -> None:
    done = python(alone, "-c", ALONE, "-C", str(project), "run", option)
    assert done.returncode == USAGE
    assert f"No such option: {option}" in done.stderr
    assert "which is not installed" not in done.stderr
