"""A benchmark that does not run is a defect: each script runs in a short form."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "benchmarks"
MUTABOT = str(Path(sys.executable).with_name("mutabot"))
#: a short form of each script: its arguments
SHORT: dict[str, list[str]] = {
    "campaigns_in_a_row": ["--count", "1"],
    "cell_physics": ["limits"],
    "cell_speed": ["1"],
    "cluster_simulation": ["--mutants", "1000"],
    "controller": ["--mutants", "1000", "--sample", "2"],
    "differential": ["--examples", "scales", "--sample", "2"],
    "engines": ["--examples", "scales", "--sample", "2"],
    "example_seeds": ["tracking", "1"],
    "flaky_campaigns": ["--count", "1", "--chance", "10"],
    "hardware_stops": ["--held", "10", "--ended", "1"],
    "html_report": ["--mutants", "20", "--rounds", "1", "--repeats", "1"],
    "instrumentation": [],
    "interception": [],
    "judged": ["fluent_api", "--conventional", "0"],
    "kill_and_resume": ["--kills", "1"],
    "languages_judged": ["--sample", "2", "--only", "pick.src"],
    "paper_scores": ["."],
    "paper_seeds": ["1"],
    "patches_judged": ["doctest_program", "--patches", "1"],
    "processes_in_a_row": ["--count", "1", "--examples", "scales"],
    "published_campaign": [MUTABOT, "1", "1"],
    "real_bugs/added": ["dispenser", "--jobs", "1"],
    "real_bugs/coupling": ["base", "--sample", "5", "--jobs", "1"],
    "real_bugs/rates": [],
    "real_bugs/shares": [],
    "same_results": [str(SCRIPTS / "witness_records")] * 2,
    "since_edits": ["--edits", "1", "--projects", "scales", "--rounds", "1"],
    "stdlib_corpus": ["colorsys"],
    "stories_judged": ["--count", "4", "--sample", "14", "--bare", "paper"],
    "suggested_checks": ["--seeds", "1", "scales"],
    "suite_length": ["--lengths", "50"],
    "tasks": ["--check"],
    "ten_thousand": ["--mutants", "400"],
    "witness": ["witness", "fluent_api"],
    "world_cost": ["--magnitudes", "2", "--when", "made"],
    "world_judged": ["paper", "--engines", "fork", "--only", "payload"],
    "world_ladders": ["paper", "--only", "centre of mass"],
}
#: scripts that measure speed or count draws: a short form says that they run, and its figures nothing
LOOSE = {"controller", "html_report", "suite_length", "ten_thousand", "world_cost"}
#: what a short form cannot bring
ELSEWHERE = {
    "foreign_programs": "installs simulators: `make foreign`",
    "foreign_worlds": "needs simulators of others",
    "plain_projects": "installs other tools and their projects",
    "random_edits": "is a module of `since_edits`",
}


def test_every_script_has_a_short_form() -> None:
    in_folder = {
        f"real_bugs/{path.stem}" for path in (SCRIPTS / "real_bugs").glob("*.py") if _is_script(path)
    }
    assert {path.stem for path in SCRIPTS.glob("*.py")} | in_folder == SHORT.keys() | ELSEWHERE.keys()


def _is_script(path: Path) -> bool:
    return 'if __name__ == "__main__":' in path.read_text(encoding="utf-8")


def test_what_the_makefile_asks_of_a_script_it_understands() -> None:
    text = (ROOT / "Makefile").read_text().replace("\\\n", " ")
    asked: dict[str, set[str]] = {}
    for name, words in re.findall(r"benchmarks/(\w+)\.py([^\n]*)", text):
        asked.setdefault(name, set()).update(re.findall(r"--[a-z-]+", words))
    assert len(asked) > 15
    for name, options in asked.items():
        script = (SCRIPTS / f"{name}.py").read_text()
        assert [option for option in options if f'"{option}"' not in script] == [], name


@pytest.fixture
def folder(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """Where the script works: a copy of an example with a campaign, or an empty folder."""
    if request.node.callspec.params["name"] != "paper_scores":
        (tmp_path / "witness").mkdir()
        return tmp_path
    copy = tmp_path / "paper"
    shutil.copytree(ROOT / "examples" / "paper", copy, ignore=shutil.ignore_patterns(".mutabot"))
    words = ["run", "--only", "@published.txt", "--sample", "2", "--rounds", "1"]
    subprocess.run([MUTABOT, *words], cwd=copy, env=_environment(), check=True, capture_output=True)
    return copy


def _environment() -> dict[str, str]:
    """Ours, with the plug-ins that the tests of examples need."""
    return {name: value for name, value in os.environ.items() if name != "PYTEST_DISABLE_PLUGIN_AUTOLOAD"}


@pytest.mark.whole
@pytest.mark.parametrize("name", SHORT)
def test_a_script_runs_in_a_short_form(name: str, folder: Path) -> None:
    if (
        name in ("cell_physics", "cell_speed", "world_cost", "world_judged", "world_ladders")
        and find_spec("mujoco") is None
    ):
        pytest.skip("needs MuJoCo")
    done = subprocess.run(
        [sys.executable, str(SCRIPTS / f"{name}.py"), *SHORT[name]],
        cwd=folder,
        env=_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr[-3000:]
    assert done.returncode in ((0, 1) if name in LOOSE else (0,)), (done.stdout + done.stderr)[-3000:]
    assert done.stdout.strip()
