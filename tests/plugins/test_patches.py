"""A provider whose mutants are patches of several files, one of them data, as a package outside brings it."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from tests.plugins.test_faults import write
from tests.plugins.test_plugins import ERRORS, mutabot

MOVE = "from cell.limits import clipped\n\ndef go(speed):\n    return "
#: what each patch makes of which files
PATCHES = {
    "double": {
        "cell/limits.json": '{"speed": 4.0, "force": 10.0}',
        "cell/move.py": MOVE + "clipped(speed)  # !\n",
    },
    "force": {"cell/limits.json": '{"speed": 2.0, "force": 99.0}'},
    "late": {"cell/move.py": MOVE + "clipped(speed + 1)\n"},
    "quiet": {
        "cell/limits.json": '{"speed": 2.0, "force": 11.0}\n',
        "cell/move.py": MOVE + "clipped(speed * 1)\n",
    },
    "outside": {"../elsewhere.py": "x = 1\n"},
}
PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["cell"]
        families = ["edits"]
        """,
    "cell/__init__.py": "",
    "cell/limits.py": """
        import json
        from pathlib import Path

        LIMITS = json.loads(Path(__file__).with_name("limits.json").read_text())

        def clipped(speed):
            return min(speed, LIMITS["speed"])
        """,
    "cell/limits.json": '{"speed": 2.0, "force": 10.0}\n',
    "cell/move.py": """
        from cell.limits import clipped

        def go(speed):
            return clipped(speed)
        """,
    "conftest.py": "",
    "tests/test_move.py": """
        import subprocess
        import sys
        from cell.move import go

        def test_slow():
            assert go(0.5) == 0.5

        def test_fast():
            assert go(5.0) == 2.0

        def test_in_a_process_below():
            words = [sys.executable, "-c", "from cell.move import go; print(go(9.0))"]
            assert float(subprocess.run(words, check=True, capture_output=True, text=True).stdout) < 4.0
        """,
    **{f"patches/{name}.json": json.dumps(texts) for name, texts in PATCHES.items()},
}
PACKAGE = {
    "patches_of_bugs.py": """
        import json
        from difflib import SequenceMatcher

        from mutabot.api.faults import Activation, Extension, FaultProvider, Planned, PlannedMutant
        from mutabot.api.faults import Rule, Site

        EXTENSION = Extension(interface=2, faults={"edits": "patches_of_bugs:Patches"})

        class Patch(Rule):
            name = "patch"
            family = "edits"
            summary = "Files are as they were before a bug was fixed."

        def hunks(root, texts):
            for path, text in texts.items():
                before = (root / path).read_text().splitlines() if (root / path).is_file() else [""]
                for tag, first, last, *_ in SequenceMatcher(None, before, text.splitlines()).get_opcodes():
                    if tag != "equal":
                        last = max(1, last)
                        yield path, (min(first + 1, last), 0, last, len(before[last - 1].encode()))

        class Patches(FaultProvider):
            name = "edits"
            families = ("edits",)
            location = "patch"

            def rules(self):
                return [Patch()]

            def plan(self, project, original):
                planned = Planned()
                for file in sorted((project.root / "patches").glob("*.json")):
                    texts = json.loads(file.read_text())
                    site = Site.of_patch(file.stem, hunks(project.root, texts))
                    mutant = self.mutant(Patch(), site, file.stem)
                    active = Activation("patches_inside:Patched", texts, (), Activation.AT_ONCE)
                    planned.mutants.append(PlannedMutant(mutant, does=texts, active=active))
                    for round, tests in enumerate(original.tests):
                        planned.reach(round, site, tests)
                return planned
        """,
    "patches_inside.py": """
        from mutabot.api.faults import ActiveFault

        class Patched(ActiveFault):
            def prepare_process(self):
                for path, text in self.data.items():
                    self.context.change_file(path, text.encode())

            def start_test(self, test, random):
                self.acts()

            def end_test(self):
                pass
        """,
    "patches_of_bugs-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: patches-of-bugs\nVersion: 1.0\n",
    "patches_of_bugs-1.0.dist-info/entry_points.txt": "[mutabot]\npatches = patches_of_bugs:EXTENSION\n",
}


def test_patches_of_several_files_are_judged_and_the_users_files_stay(tmp_path: Path) -> None:
    site, project = write(tmp_path / "site", PACKAGE), write(tmp_path / "project", PROJECT)
    before = {file: file.read_bytes() for file in project.rglob("*.*") if file.is_file()}
    done = mutabot(site, project, "run", "--json", "-o", "repeats=false")
    assert done.returncode == ERRORS, done.stderr
    found = {mutant["description"]: mutant["rounds"][0] for mutant in json.loads(done.stdout)["mutants"]}
    assert {name: (end["verdict"], end["test"]) for name, end in found.items()} == {
        "double": ("killed", "tests/test_move.py::test_fast"),
        "force": ("survived", None),
        "late": ("killed", "tests/test_move.py::test_slow"),
        "quiet": ("survived", None),
        "outside": ("error", "tests/test_move.py::test_slow"),
    }
    assert "../elsewhere.py cannot be changed: it is not a file of the project" in found["outside"]["message"]
    assert {file: file.read_bytes() for file in before} == before
    assert not (tmp_path / "elsewhere.py").exists()
    assert "5 mutants that are active before any point at which they could be forked" in done.stderr
    _check_reports(site, project)


def _check_reports(site: Path, project: Path) -> None:
    """All reports have every place of the patch of two files that survives; its number is 5."""
    (found,) = [mutant for mutant in json.loads(mutabot(site, project, "results", "--json").stdout)["mutants"]
                if mutant["description"] == "quiet"]  # fmt: skip
    assert found["id"] == "cell/limits.json:quiet:patch"
    places = [{"file": "cell/limits.json", "line": 1, "column": 1, "end_line": 1, "end_column": 30},
              {"file": "cell/move.py", "line": 4, "column": 1, "end_line": 4, "end_column": 26}]  # fmt: skip
    assert [found["span"], *found["other_spans"]] == places
    told = mutabot(site, project, "show", "5").stdout
    assert '> 1 │ {"speed": 2.0, "force": 10.0}' in told
    assert "> 4 │     return clipped(speed)" in told
    for command in (["results"], ["list"], ["show", "5"]):
        told = mutabot(site, project, *command).stdout
        assert all(place in told for place in ("cell/limits.json:1", "cell/move.py:4")), (command, told)
    line = mutabot(site, project, "report", "--format", "github").stdout.splitlines()[1]
    assert line.startswith("::warning file=cell/limits.json,line=1,endLine=1,col=1,endColumn=30,title=")
    assert "::quiet (also at cell/move.py:4): survived" in line
    (told,) = json.loads(mutabot(site, project, "report", "--format", "sarif").stdout)["runs"]
    (result,) = [finding for finding in told["results"] if finding["properties"]["number"] == 5]
    regions = [
        location["physicalLocation"] for location in (*result["locations"], *result["relatedLocations"])
    ]
    assert [
        (region["artifactLocation"]["uri"], region["region"]["snippet"]["text"]) for region in regions
    ] == [
        ("cell/limits.json", '{"speed": 2.0, "force": 10.0}'),
        ("cell/move.py", "    return clipped(speed)"),
    ]
    files = json.loads(mutabot(site, project, "report", "--format", "mutation-testing").stdout)["files"]
    assert {name: file["language"] for name, file in files.items()} == {
        "../elsewhere.py": "python", "cell/limits.json": "text", "cell/move.py": "python",
    }  # fmt: skip
    mutabot(site, project, "report", "--html", str(project / "page"))
    sources = (project / "page/data/sources.js").read_text(encoding="utf-8")
    assert all(f'"{place["file"]}"' in sources for place in places)
    assert '"cell/move.py","line":4' in (project / "page/data/campaign.js").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the package is installed."""
    return write(tmp_path_factory.mktemp("site"), PACKAGE)


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["--only", "cell/move.py"], ["double", "late", "quiet"]),
        (["--only", "cell/move.py:4"], ["double", "late", "quiet"]),
        (["--only", "move.py:1-3"], []),
        (["--only", "cell/limits.json", "--skip", "cell/*.py"], ["force"]),
        (["--only", "cell", "--skip", "limits.json:1"], ["late"]),
    ],
)
def test_a_patch_is_chosen_by_each_of_its_files_and_lines(
    words: list[str], names: list[str], site: Path, tmp_path: Path
) -> None:
    project = write(tmp_path / "project", PROJECT)
    done = mutabot(site, project, "list", "--json", *words)
    found = json.loads(done.stdout)["mutants"] if done.returncode == 0 else []
    assert [mutant["description"] for mutant in found] == names, done.stderr


def test_a_patch_is_accepted_until_its_line_changes(site: Path, tmp_path: Path) -> None:
    project = write(tmp_path / "project", PROJECT)
    mutabot(site, project, "run", "-o", "repeats=false", "--only", "*quiet*")
    assert mutabot(site, project, "accept", "5", "--why", "the force is not used").returncode == 0
    text = (project / "mutabot-accepted.toml").read_text()
    assert 'line = "{\\"speed\\": 2.0, \\"force\\": 10.0}"' in text
    again = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--only", "*quiet*")
    (found,) = json.loads(again.stdout)["mutants"]
    assert (found["status"], found["accepted"]["why"]) == ("accepted", "the force is not used")
    (project / "cell/limits.json").write_text('{"speed": 2.0, "force": 12.0}\n')
    again = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--only", "*quiet*")
    assert json.loads(again.stdout)["mutants"][0]["status"] == "survived"
    assert "has changed from" in again.stderr


def test_since_a_revision_patches_are_run_whose_files_or_texts_have_changed(
    site: Path, tmp_path: Path
) -> None:
    project = write(tmp_path / "project", {**PROJECT, ".gitignore": ".mutabot/\n__pycache__/\n"})
    commands = (
        ["init", "-q"],
        ["add", "."],
        ["-c", "user.name=x", "-c", "user.email=x", "commit", "-qm", "x"],
    )
    for words in commands:
        subprocess.run(["git", *words], cwd=project, check=True)
    options = ("run", "-o", "repeats=false", "--skip", "*outside*", "--since", "HEAD")
    assert "0 to run" in mutabot(site, project, *options).stderr
    (project / "cell/limits.json").write_text('{"speed": 2.0, "force": 12.0}\n')
    assert "4 to run" in mutabot(site, project, *options).stderr


@pytest.mark.whole
def test_a_patch_that_only_a_process_below_the_tests_can_show_is_noticed(tmp_path: Path) -> None:
    site, project = write(tmp_path / "site", PACKAGE), write(tmp_path / "project", PROJECT)
    (project / "tests/test_move.py").write_text(
        "import subprocess, sys\n\n"
        "def test_below():\n"
        "    words = [sys.executable, '-c', 'from cell.move import go; print(go(9.0))']\n"
        "    assert float(subprocess.run(words, capture_output=True, text=True).stdout) < 3.0\n"
    )
    done = mutabot(site, project, "run", "--json", "-o", "repeats=false", "--only", "*double*")
    (found,) = json.loads(done.stdout)["mutants"]
    assert found["rounds"][0]["verdict"] == "killed", done.stderr
