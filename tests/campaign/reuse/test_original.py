"""A campaign takes its baseline from runs of the original that still hold, and makes all others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.checking import check, plan_only
from mutabot.campaign.reuse import parts
from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError, ControlError, JournalError
from mutabot.execution.interruption import Interruption
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader, kept_original
from mutabot.model import Verdict
from mutabot.model.events import TestEnd
from tests.campaign.project import (
    REPLAY,
    Quiet,
    outcomes,
    request_for,
    write_project,
)
from tests.campaign.scripted import CHECKED, End, Run, Script
from tests.journal.edited import edited

MISSION = """
    def left(arm):
        arm.move_by(0.2)

    def right(arm):
        arm.move_by(0.3)
        return arm.position()
"""
TESTS = """
    import os
    import mission
    from robot import Arm

    LIMIT = float(open("limit.txt").read())

    def test_left():
        arm = Arm()
        mission.left(arm)
        assert 0 < arm.x < LIMIT

    def test_right():
        assert mission.right(Arm()) > 0
"""
DATA = {"limit.txt": "0.9\n", "scene.json": "{}\n", "notes.txt": "nobody opens them\n"}
HOLDS = "still holds"


class Project:
    """A project whose campaigns start no process, and how often they run the original."""

    def __init__(self, folder: Path, script: Script) -> None:
        self.folder, self.script = write_project(folder, MISSION, TESTS, more=DATA), script
        self.lines: list[str] = []

    @property
    def journal(self) -> Path:
        return self.folder / ".mutabot" / "journal.sqlite"

    def edit(self, name: str, change: Callable[[str], str] = lambda text: text + "\n") -> None:
        path = self.folder / name
        path.write_text(change(path.read_text()))

    def runs(self, **changes: Any) -> int:
        """Run a campaign: how often it ran the original for its baseline."""
        return self.counted(lambda progress: run_campaign(request_for(self.folder, **changes), progress))

    def counted(self, command: Callable[[Quiet], object]) -> int:
        before, progress = len(self.script.tasks), Quiet()
        try:
            command(progress)
        finally:
            self.lines = progress.lines
        jobs = [task.job for task in self.script.tasks[before:]]
        found = sum(job.mutant is None and job.forking is None and job.record for job in jobs)
        assert any(HOLDS in line for line in self.lines) or found
        return found


@pytest.fixture
def project(tmp_path: Path, script: Script) -> Project:
    script.kill("reverse")
    return Project(tmp_path, script)


@pytest.mark.parametrize("engine", ["auto", "fork", "replay"])
def test_a_second_campaign_of_other_mutants_runs_the_original_no_more(project: Project, engine: str) -> None:
    rounds = {"engine": engine, "rounds": 2}
    assert project.runs(only=("reverse",), **rounds) == (4 if engine == "replay" else 2)
    assert project.runs(skip=("reverse",), **rounds) == 0
    assert project.runs(fresh=True, **rounds) == (4 if engine == "replay" else 2)


EDITS: dict[str, Callable[[Project], object]] = {
    "a test": lambda project: project.edit("tests/test_mission.py", lambda text: text + "    assert True\n"),
    "a comment": lambda project: project.edit("tests/test_mission.py", lambda text: text + "# why\n"),
    "the program": lambda project: project.edit("mission.py", lambda text: text.replace("0.2", "0.25")),
    "a module beside it": lambda project: project.edit("robot.py"),
    "data": lambda project: project.edit("scene.json"),
    "new data": lambda project: (project.folder / "more.csv").write_text("1\n"),
    "a new test": lambda project: (project.folder / "tests/test_b.py").write_text("def test_b(): ...\n"),
    "no data any more": lambda project: (project.folder / "scene.json").unlink(),
    "the vocabulary": lambda project: project.edit("robot.toml", lambda text: text.replace("0.5", "0.4")),
    "a conftest.py": lambda project: (project.folder / "conftest.py").write_text("import os\n"),
    "pytest's arguments": lambda project: project.edit(
        "mutabot.toml", lambda text: text.replace('"-o"', '"-x", "-o"')
    ),
    "the limit of memory": lambda project: project.edit(
        "mutabot.toml", lambda text: text + 'memory = "8 GB"\n'
    ),
    "the oracle": lambda project: project.edit("mutabot.toml", lambda text: text + 'oracle = ["robot.py"]\n'),
    "files of its own": lambda project: project.edit(
        "mutabot.toml", lambda text: text + "private_files = false\n"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_makes_the_baseline_anew(project: Project, name: str) -> None:
    assert project.runs() == 1
    EDITS[name](project)
    assert project.runs() == 1
    assert project.runs() == 0


def test_what_nothing_depends_on_may_change(project: Project) -> None:
    assert project.runs() == 1
    project.edit("mutabot.toml", lambda text: "# limits\nmin_score = 10\n" + text)
    (project.folder / "README.md").write_text("It moves.\n")
    for name in ("mission.py", "tests/test_mission.py"):
        (project.folder / name).touch()
    assert project.runs(jobs=1, sample=None, only=("reverse",)) == 0


@pytest.mark.parametrize("changes", [{"seed": 7}, {"engine": "replay"}, {"evidence": True}])
def test_what_is_asked_otherwise_makes_it_anew(project: Project, changes: dict[str, Any]) -> None:
    project.runs()
    assert project.runs(**changes) > 0
    assert project.runs(**changes) == 0


def test_a_further_round_is_run_beside_those_that_hold(project: Project) -> None:
    assert project.runs(rounds=2) == 2
    assert project.runs(rounds=3) == 1
    assert project.runs(rounds=3) == 0
    assert project.runs(rounds=1) == 0
    assert project.runs(rounds=3) == 0


def test_an_environment_variable_makes_it_anew(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    project.runs()
    monkeypatch.setenv("OLDPWD", "/elsewhere")
    assert project.runs() == 0
    monkeypatch.setenv("ROBOT_ADDRESS", "10.0.0.1")
    assert project.runs() == 1
    monkeypatch.setenv("ROBOT_ADDRESS", "10.0.0.2")
    assert project.runs() == 1


def test_folders_of_libraries_count_in_any_order(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LD_LIBRARY_PATH", "/one:/two")
    project.runs()
    monkeypatch.setenv("LD_LIBRARY_PATH", "/two:/one")
    assert project.runs() == 0
    monkeypatch.setenv("LD_LIBRARY_PATH", "/two")
    assert project.runs() == 1


@pytest.mark.parametrize(("where", "found"), [("versions", "2.0"), ("code_of_packages", (("arm.py", "#2"),))])
def test_what_is_installed_makes_it_anew(
    project: Project, monkeypatch: pytest.MonkeyPatch, where: str, found: Any
) -> None:
    project.runs()
    before = getattr(parts, where)
    monkeypatch.setattr(parts, where, lambda *of: {**before(*of), "arms": found})
    assert project.runs() == 1


def test_another_machine_makes_it_anew(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    project.runs()
    monkeypatch.setattr("platform.node", lambda: "a slower one")
    assert project.runs() == 1


def test_what_was_said_of_it_is_said_again(project: Project) -> None:
    def original(run: Run) -> End:
        return CHECKED if run.test.endswith("right") and run.before else {}

    project.script.original = original
    project.edit("mutabot.toml", lambda text: text + "unstable_limit = 0.6\n")
    project.edit("robot.toml", lambda text: text + '\n[[operation]]\ncall = "robot:Arm.stop"\n')
    project.runs(engine="replay", only=("reverse",))
    first = [line for line in project.lines if "excluded" in line or "robot.toml" in line]
    assert any("excluded in round 1" in line for line in first)
    project.script.original = lambda run: {}
    assert project.runs(engine="replay", skip=("reverse",)) == 0
    assert [line for line in project.lines if "excluded" in line or "robot.toml" in line] == first


def test_one_that_was_interrupted_is_not_kept(project: Project) -> None:
    project.script.interrupts = lambda event: isinstance(event, TestEnd)
    with pytest.raises(Interruption):
        project.runs()
    project.script.interrupts = lambda event: False
    assert project.runs() == 1


def test_one_whose_tests_fail_is_not_kept(project: Project) -> None:
    project.script.original = lambda run: CHECKED
    with pytest.raises(BaselineError):
        project.runs()
    project.script.original = lambda run: {}
    assert project.runs() == 1


def test_a_campaign_that_was_interrupted_leaves_its_baseline(project: Project) -> None:
    seen = {"forks": 0}

    def interrupts(event: object) -> bool:
        seen["forks"] += type(event).__name__ == "ForkTestEnd"
        return seen["forks"] > 3

    project.script.interrupts = interrupts
    with pytest.raises(Interruption):
        project.runs(engine="fork")
    project.script.interrupts = lambda event: False
    assert project.runs(engine="fork") == 0


def test_one_that_a_control_contradicts_is_not_used_again(project: Project) -> None:
    project.runs(engine="replay", only=("reverse",))
    project.script.control = lambda run: CHECKED
    with pytest.raises(ControlError):
        project.runs(engine="replay", skip=("reverse",))
    project.script.control = lambda run: None
    assert project.runs(engine="replay", skip=("reverse",)) == 2


def test_one_whose_tests_end_otherwise_later_is_not_used_again(project: Project) -> None:
    project.edit("mutabot.toml", lambda text: text + "unstable_limit = 0.6\n")
    project.runs(only=("reverse",))
    project.script.original = lambda run: CHECKED if run.test.endswith("left") else {}
    assert project.runs(skip=("reverse",)) == 0
    assert any("excluded as flaky" in line for line in project.lines)
    project.script.original = lambda run: {}
    assert project.runs(skip=("reverse",)) == 1


def listed(project: Project) -> Callable[[Quiet], object]:
    return lambda progress: plan_only(request_for(project.folder), progress)


def checked(project: Project) -> Callable[[Quiet], object]:
    return lambda progress: check(request_for(project.folder), progress)


@pytest.mark.parametrize("command", [listed, checked])
def test_commands_without_mutants_leave_their_baseline_to_a_campaign(
    project: Project, command: Callable[[Project], Callable[[Quiet], object]]
) -> None:
    assert project.counted(command(project)) == 1
    with pytest.raises(JournalError, match="no journal yet"):
        JournalReader.open(project.journal)
    assert project.counted(listed(project)) == 0
    assert project.runs() == 0
    with JournalReader.open(project.journal) as journal:
        assert journal.finished == "complete"
        assert journal.tests()
    assert project.counted(listed(project)) == 0
    assert project.counted(checked(project)) == 1  # it tries the set-up as it is now


def test_a_list_changes_nothing_in_the_journal_of_a_campaign(project: Project) -> None:
    project.runs()
    before = outcomes(project.journal)
    project.edit("scene.json")
    assert project.counted(listed(project)) == 1
    with JournalReader.open(project.journal) as journal:
        assert (journal.finished, journal.attempt, journal.outcomes()) == ("complete", None, before)
    assert project.runs() == 0


def test_a_list_leaves_nothing_in_a_journal_that_is_written_or_is_none(project: Project) -> None:
    with Journal.create(project.journal, meta={}):
        assert project.counted(listed(project)) == 1
    assert kept_original(project.journal) is None
    project.journal.write_text("my notes")
    assert project.counted(listed(project)) == 1
    assert project.journal.read_text() == "my notes"


def test_a_campaign_that_cannot_begin_after_a_list_says_so(project: Project) -> None:
    project.counted(listed(project))
    project.edit("scene.json")
    project.script.original = lambda run: CHECKED
    with pytest.raises(BaselineError):
        project.runs()
    with JournalReader.open(project.journal) as journal:
        assert "fail on the unmutated program" in (journal.finished or "")


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE original SET events = x'00' WHERE task != ''",
        "UPDATE original SET events = substr(events, 1, length(events) - 9) WHERE task != ''",
        "UPDATE original SET task = 'another' WHERE task != ''",
        "UPDATE original SET data = '{}' WHERE task = ''",
        "UPDATE original SET data = 'no JSON' WHERE task != ''",
        "DELETE FROM original WHERE task != ''",
        "DELETE FROM original WHERE task = ''",
    ],
)
def test_runs_that_cannot_be_read_are_made_anew(project: Project, change: str) -> None:
    project.runs()
    with edited(project.journal) as connection:
        connection.execute(change)
    assert project.runs() == 1
    assert project.runs() == 0


def test_a_journal_that_came_from_another_folder_is_of_no_use(project: Project, tmp_path: Path) -> None:
    project.runs()
    other = Project(tmp_path / "other", project.script)
    other.journal.parent.mkdir()
    other.journal.write_bytes(project.journal.read_bytes())
    assert other.runs() == 1


@pytest.mark.parametrize("name", ["scene.json", "mission.py", "new.json"])
def test_a_baseline_in_whose_course_files_changed_is_not_kept(project: Project, name: str) -> None:
    def original(run: Run) -> End:
        if run.test.endswith("right") and not project.journal.with_name("edited").exists():
            project.journal.with_name("edited").touch()
            with (project.folder / name).open("a") as file:
                file.write("\n")
        return {}

    project.script.original = original
    assert project.runs() == 1
    assert project.runs() == 1
    assert project.runs() == 0


# With real processes: what tests open, and that verdicts are the same

#: what two campaigns of a mutant's outcome must have alike
Said = tuple[Verdict, str | None, int, int, tuple[str, ...]]


def said(path: Path) -> dict[tuple[str, int], Said]:
    return {
        (end.mutant, end.round): (
            end.verdict, end.test, end.hits, end.acted, tuple(kill.test for kill in end.kills)
        )
        for end in outcomes(path)
    }  # fmt: skip


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_halves_of_a_campaign_end_as_the_whole(tmp_path: Path, engine: str) -> None:
    whole = write_project(tmp_path / "whole", MISSION, TESTS, more=DATA)
    halves = write_project(tmp_path / "halves", MISSION, TESTS, more=DATA)
    wanted = said(run_campaign(request_for(whole, engine=engine), Quiet()))
    found, progress = {}, Quiet()
    for number, ids in enumerate((sorted(wanted)[::2], sorted(wanted)[1::2])):
        only = tuple(mutant for mutant, _ in ids)
        found |= said(run_campaign(request_for(halves, engine=engine, only=only), progress))
        assert any(HOLDS in line for line in progress.lines) == bool(number)
    assert found == wanted
    assert {facts[0] for facts in found.values()} >= {Verdict.KILLED, Verdict.SURVIVED}


def test_notes_that_tests_open_count_and_no_others(tmp_path: Path) -> None:
    folder = write_project(tmp_path, MISSION, TESTS, more=DATA)

    def is_anew() -> bool:
        progress = Quiet()
        plan_only(request_for(folder), progress)
        return not any(HOLDS in line for line in progress.lines)

    assert is_anew()
    (folder / "notes.txt").write_text("edited\n")
    assert not is_anew()
    (folder / "limit.txt").write_text("0.8\n")
    assert is_anew()
    assert not is_anew()
    (folder / "limit.txt").write_text("0.7\n")  # known from the run before, not from the one that holds
    assert is_anew()
