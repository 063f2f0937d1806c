"""``--since``: what changes since a revision can have altered is run, and nothing else."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.reuse.reuse import Revision
from mutabot.campaign.run import run_campaign
from mutabot.errors import ExitCode, UsageError
from mutabot.journal.journal import Journal
from mutabot.results.gate import decide
from mutabot.results.results import read_results
from random_edits import EDITS
from tests.campaign.project import Quiet, fingerprint, request_for, write_project
from tests.campaign.scripted import CHECKED, End, Run, Script

MISSION = """
    def left(arm):
        arm.move_by(0.2)
        arm.move_by(0.1)

    def right(arm):
        arm.move_by(0.3)
        return arm.position()
"""
LEFT = """
    from robot import Arm
    import mission

    def test_left():
        arm = Arm()
        mission.left(arm)
        assert arm.x > 0
"""
RIGHT = """
    from robot import Arm
    import mission

    def test_right():
        end = mission.right(Arm())
        assert end > 0
"""
BENCHMARK = Path(__file__).parents[3] / "benchmarks" / "since_edits.py"
Pair = tuple[str, int]


def git(folder: Path, *command: str) -> None:
    identity = ["-c", "user.name=tests", "-c", "user.email=tests@localhost"]
    subprocess.run(["git", *identity, *command], cwd=folder, check=True, capture_output=True)


class Project:
    """A project in a repository."""

    def __init__(self, folder: Path) -> None:
        self.folder = write_project(folder, MISSION, LEFT, more={"tests/test_right.py": RIGHT})
        git(folder, "init", "-q")
        (folder / ".gitignore").write_text(".mutabot\n__pycache__\n.pytest_cache\n")
        git(folder, "add", "-A")
        git(folder, "commit", "-qm", "before")
        self.progress = Quiet()

    @property
    def journal(self) -> Path:
        return self.folder / ".mutabot" / "journal.sqlite"

    def edit(self, name: str, change: Callable[[str], str]) -> None:
        path = self.folder / name
        path.write_text(change(path.read_text()))

    def run(self, **changes: Any) -> set[Pair]:
        """Run a campaign: the mutants and rounds that it really ran."""
        self.progress = Quiet()
        run_campaign(request_for(self.folder, **changes), self.progress)
        with Journal.open(self.journal) as journal:
            return {(outcome.mutant, outcome.round) for outcome in journal.outcomes()} - journal.reused()

    def notes(self) -> str:
        return "\n".join(self.progress.lines)


@pytest.fixture
def project(tmp_path: Path, script: Script) -> Project:
    """One whose campaigns start no process."""
    return Project(tmp_path)


def of(function: str, pairs: set[Pair]) -> set[Pair]:
    return {pair for pair in pairs if f":{function}:" in pair[0]}


def test_since_takes_over_what_no_change_can_have_altered(project: Project) -> None:
    first = project.run()
    project.edit("mission.py", lambda text: "# a comment\n" + text)
    assert project.run(since="HEAD") == set()
    assert f"0 to run, {len(first)} taken over" in project.notes()
    project.edit("mission.py", lambda text: text.replace("0.3", "0.4"))
    before = fingerprint(project.folder)
    assert project.run(since="HEAD") == of("right", first)
    assert f"{len(of('right', first))} to run: right() in mission.py changed" in project.notes()
    assert fingerprint(project.folder) == before


def test_what_a_test_has_noticed_that_does_not_reach_it_is_run_after_each_change(
    project: Project, script: Script
) -> None:
    def noticed(run: Run) -> End:
        is_other = run.mutant is not None and ":left:" in run.mutant.id and run.test.endswith("test_right")
        return CHECKED if is_other else {}

    script.mutated = noticed
    first = project.run()
    project.edit("tests/test_right.py", lambda text: text + "    assert True\n")
    assert project.run(since="HEAD") == first
    script.mutated = lambda run: {}
    project.run(fresh=True)
    project.edit("tests/test_right.py", lambda text: text + "    assert 1 < 2\n")
    assert project.run(since="HEAD") == of("right", first)
    assert f"{len(of('left', first))} of them are survivors" in project.notes()


def test_without_a_journal_only_altered_mutants_are_run_and_that_is_said(project: Project) -> None:
    project.edit("mission.py", lambda text: text.replace("0.3", "0.4"))
    ran = project.run(since="HEAD")
    assert ran == of("right", ran)
    assert ran
    assert (
        "not judged; their tests execute nothing that has changed: no journal holds an outcome"
        in project.notes()
    )
    with Journal.open(project.journal) as journal:
        results = read_results(journal)
    assert results.since is not None
    assert sum(results.since.run.values()) == len(ran)
    assert sum(results.since.not_judged.values()) > 0
    assert results.done == results.planned == len(ran)


def test_where_nothing_has_changed_and_no_journal_is_there_nothing_is_wrong(project: Project) -> None:
    assert project.run(since="HEAD") == set()
    with Journal.open(project.journal) as journal:
        results = read_results(journal)
    assert results.everything == ()
    assert decide(results, min_score=0.9).exit_code == ExitCode.FINE


def test_uncommitted_and_untracked_files_and_the_vocabulary_count(project: Project) -> None:
    first = project.run()
    project.edit("robot.toml", lambda text: text.replace("noise = 0.5", "noise = 0.4"))
    assert project.run(since="HEAD") == {pair for pair in first if "position" in pair[0]}
    git(project.folder, "checkout", "robot.toml")
    (project.folder / "tests" / "conftest.py").write_text("x = 1\n")
    assert project.run(since="HEAD") == first
    assert "tests/conftest.py is new" in project.notes()


def test_a_journal_of_elsewhere_is_taken_over_as_far_as_it_holds(project: Project, tmp_path: Path) -> None:
    first = project.run()
    stored = tmp_path / "stored.sqlite"
    shutil.copy(project.journal, stored)
    shutil.rmtree(project.folder / ".mutabot")
    project.edit("mission.py", lambda text: text.replace("0.3", "0.4"))
    assert project.run(since="HEAD", other_journal=stored) == of("right", first)
    shutil.rmtree(project.folder / ".mutabot")
    assert project.run(since="HEAD", other_journal=stored, seed=5) == of("right", first)
    assert "seed is 5, was 1" in project.notes()  # and what is not altered is not judged


def test_a_missing_journal_is_reported_with_since_and_an_error_without(project: Project) -> None:
    nowhere = project.folder / "nowhere.sqlite"
    project.edit("mission.py", lambda text: text.replace("0.3", "0.4"))
    project.run(since="HEAD", other_journal=nowhere)
    assert "nothing is taken over from it" in project.notes()
    with pytest.raises(UsageError, match="--journal"):
        project.run(other_journal=nowhere)


def test_a_renamed_file_is_a_new_one(project: Project) -> None:
    first = project.run()
    git(project.folder, "mv", "mission.py", "errand.py")
    for name in ("tests/test_mission.py", "tests/test_right.py", "mutabot.toml"):
        project.edit(
            name,
            lambda text: (
                text.replace("import mission", "import errand")
                .replace("mission.left", "errand.left")
                .replace("mission.right", "errand.right")
                .replace('"mission.py"', '"errand.py"')
            ),
        )
    ran = project.run(since="HEAD")
    assert {mutant for mutant, _ in ran} == {mutant.replace("mission.py", "errand.py") for mutant, _ in first}


@pytest.mark.parametrize(
    ("ref", "said"), [("nowhere", "git does not know this revision"), ("--all", "not the name of a revision")]
)
def test_an_unknown_revision_is_an_error_before_anything_runs(project: Project, ref: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        project.run(since=ref)
    assert not [line for line in project.progress.lines if "baseline" in line]


def test_what_is_no_repository_and_what_is_shallow_say_what_to_do(
    project: Project, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    outside = tmp_path_factory.mktemp("elsewhere") / "outside"
    shutil.copytree(project.folder, outside, ignore=shutil.ignore_patterns(".git"))
    project.edit("mission.py", lambda text: text + "\n")
    git(project.folder, "commit", "-qam", "after")
    git(tmp_path, "clone", "-q", "--depth", "1", f"file://{project.folder}", str(tmp_path / "shallow"))
    with pytest.raises(UsageError, match="fetch-depth: 0"):
        Revision.find(tmp_path / "shallow", "HEAD~1")
    with pytest.MonkeyPatch.context() as patch:
        with pytest.raises(UsageError, match="is in no repository of git"):
            Revision.find(outside, "HEAD")
        patch.setenv("PATH", "")
        with pytest.raises(UsageError, match="needs git"):
            Revision.find(project.folder, "HEAD")


def edits(*options: str) -> dict[str, Any]:
    done = subprocess.run([sys.executable, BENCHMARK, *options], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return dict(json.loads(done.stdout[done.stdout.index("\n{") :]))


@pytest.mark.whole
def test_since_gives_the_outcomes_of_a_whole_campaign_after_a_few_edits() -> None:
    found = edits("--edits", "2", "--projects", "errands", "--kinds", "program,renamed", "--rounds", "1")
    assert found["outcomes"] > 0
    assert found["wrong"] == []


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")  # the paper's tests need one
def test_since_gives_the_outcomes_of_a_whole_campaign_after_an_edit_of_each_kind() -> None:
    # not every kind of edit is possible in every project
    projects = [
        "paper" if kind == "test" else "scales" if kind == "vocabulary" else "errands" for kind in EDITS
    ]
    found = edits(
        "--edits", str(len(EDITS)), "--seed", "14", "--projects", ",".join(projects), "--rounds", "1"
    )
    assert found["edits"] == dict.fromkeys(EDITS, 1)
    assert found["wrong"] == []


def test_a_journal_that_is_not_there_is_an_error_before_anything_runs(
    project: Project, tmp_path: Path
) -> None:
    with pytest.raises(UsageError, match=r"--journal: .*there is no journal"):
        project.run(other_journal=tmp_path / "none.sqlite")
    assert not [line for line in project.progress.lines if "baseline" in line]
