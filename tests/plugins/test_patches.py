"""A provider whose mutants are patches of several files, one of them data, as a package outside brings it."""

from __future__ import annotations

import json
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
    "outside": {"../elsewhere.py": "x = 1\n"},
}
PROJECT = {
    "pyproject.toml": """
        [tool.mutabot]
        program = ["cell"]
        families = ["patch"]
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

        from mutabot.api.faults import Activation, Extension, FaultProvider, Planned, PlannedMutant
        from mutabot.api.faults import Rule, Site

        EXTENSION = Extension(interface=2, faults={"patches": "patches_of_bugs:Patches"})

        class Patch(Rule):
            name = "patch"
            family = "patch"
            summary = "Files are as they were before a bug was fixed."

        class Patches(FaultProvider):
            name = "patches"
            families = ("patch",)
            location = "patch"

            def rules(self):
                return [Patch()]

            def plan(self, project, original):
                planned = Planned()
                for file in sorted((project.root / "patches").glob("*.json")):
                    texts = json.loads(file.read_text())
                    site = Site.of_parameter("patches", file.stem)
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
    found = {one["description"]: one["rounds"][0] for one in json.loads(done.stdout)["mutants"]}
    assert {name: (one["verdict"], one["test"]) for name, one in found.items()} == {
        "double": ("killed", "tests/test_move.py::test_fast"),
        "force": ("survived", None),
        "late": ("killed", "tests/test_move.py::test_slow"),
        "outside": ("error", "tests/test_move.py::test_slow"),
    }
    assert "../elsewhere.py cannot be changed: it is not a file of the project" in found["outside"]["message"]
    assert {file: file.read_bytes() for file in before} == before
    assert not (tmp_path / "elsewhere.py").exists()
    assert "4 mutants that are active before any point at which they could be forked" in done.stderr
    # a patch stands in no one file: reports name none
    (line,) = mutabot(site, project, "report", "--format", "github").stdout.splitlines()
    assert line.startswith("::warning title=Survivor 2%3A patch (program)::force: survived in round 1.")
    (told,) = json.loads(mutabot(site, project, "report", "--format", "sarif").stdout)["runs"]
    (result,) = told["results"]
    assert result["locations"] == [
        {"logicalLocations": [{"fullyQualifiedName": "patches:force", "kind": "variable"}]}
    ]


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
