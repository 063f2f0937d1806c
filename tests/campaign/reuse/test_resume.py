"""Resuming: what still holds is taken over, what depends on a change runs again, and nothing is ever lost."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import mutabot
from mutabot.campaign import run as campaign
from mutabot.campaign.reuse.keys import changed_parts
from mutabot.campaign.reuse.snapshot import Snapshot
from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError, JournalError, NothingToDoError, SelectionError
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from mutabot.results.results import Results, read_results
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import CHECKED, End, Run, Script
from tests.journal.edited import edited

MISSION = """
    def left(arm):
        arm.move_by(0.2)

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
        assert mission.right(Arm()) > 0
"""
ASSERTS_MORE: Callable[[str], str] = lambda text: text + "    assert True\n"  # noqa: E731
BENCHMARK = Path(__file__).parents[3] / "benchmarks" / "kill_and_resume.py"
Pair = tuple[str, int]


class Project:
    """A project whose campaigns run one after another."""

    def __init__(self, folder: Path) -> None:
        more = {"tests/test_right.py": RIGHT, "scene.json": "{}\n", "README.md": "It moves.\n"}
        self.folder = write_project(folder, MISSION, LEFT, more=more)
        self.progress = Quiet()

    @property
    def journal(self) -> Path:
        return self.folder / ".mutabot" / "journal.sqlite"

    def edit(self, name: str, change: Callable[[str], str] = lambda text: text + "\n# edited\n") -> None:
        path = self.folder / name
        path.write_text(change(path.read_text()))

    def run(self, **changed_parts: Any) -> set[Pair]:
        """Run a campaign: the mutants and rounds that it really ran."""
        self.progress = Quiet()
        run_campaign(request_for(self.folder, **changed_parts), self.progress)
        with Journal.open(self.journal) as journal:
            results = read_results(journal)
            assert results.done == results.planned
            ran = {(outcome.mutant, outcome.round) for outcome in journal.outcomes()} - journal.reused()
        lines = [line for line in self.progress.lines if line.startswith("#")]
        assert len(lines) == len(ran)
        return ran

    @property
    def note(self) -> str:
        """What was said about reuse."""
        found = [line for line in self.progress.lines if "reused" in line]
        assert len(found) <= 1
        return found[0] if found else ""

    def state(self) -> tuple[str, int]:
        with Journal.open(self.journal) as journal:
            results = read_results(journal)
        return results.state, results.done

    def all_results(self) -> Results:
        """What reports show."""
        with Journal.open(self.journal) as journal:
            return read_results(journal, earlier=True)


@pytest.fixture
def project(tmp_path: Path, script: Script) -> Project:
    """One whose campaigns start no process, as what is reused does not depend on how mutants are run."""
    script.kill("reverse")
    return Project(tmp_path)


@pytest.fixture
def real(tmp_path: Path) -> Project:
    return Project(tmp_path)


def noticed_from_elsewhere(run: Run) -> End:
    """A test of the one function notices mutants of the other."""
    is_other = run.test.endswith("test_right") and run.mutant is not None and ":left:" in run.mutant.id
    return CHECKED if is_other and run.mutant.id.endswith("reverse") else {}


def of(function: str, pairs: set[Pair]) -> set[Pair]:
    return {pair for pair in pairs if f":{function}:" in pair[0]}


def test_what_has_not_changed_is_not_run_again(real: Project) -> None:
    first = real.run()
    assert real.note == ""
    assert real.run() == set()
    assert real.note == f"reused all {len(first)} outcomes: nothing that they depend on has changed"
    for name in ("mission.py", "tests/test_right.py"):
        os.utime(real.folder / name)  # another time, the same content
    real.edit("README.md")
    real.edit("mutabot.toml", lambda text: text + "jobs = 1\nmin_score = 3\n")
    real.edit("robot.toml", lambda text: "# entries move down a line\n" + text)
    (real.folder / "published.txt").write_text(f"# a selection\n{min(first)[0]}\n")
    assert real.run(jobs=1, engine="replay") == set()


def test_a_fresh_campaign_runs_everything(project: Project) -> None:
    first = project.run()
    assert project.run(fresh=True) == first
    assert project.note == ""


def test_a_changed_function_runs_what_can_reach_it_again_and_a_data_file_everything(project: Project) -> None:
    first = project.run()
    project.edit("mission.py", lambda text: text.replace("arm.move_by(0.3)", "arm.move_by(0.1)"))
    right = of("right", first)
    assert project.run() == right
    kept = len(first) - len(right)
    assert project.note == (
        f"reused {kept} of {len(first)} outcomes; {len(right)} run again: right() in mission.py changed"
    )
    project.edit("mission.py", lambda text: text.replace("arm.move_by(0.2)", "arm.move_by(0.1)"))
    assert project.run() == first  # what a test executes counts for all tests after it
    assert project.note.endswith("run again: left() in mission.py changed")
    project.edit("robot.py", lambda text: text.replace("self.x = x", "self.x = 0.0"))
    assert project.run() == first
    assert project.note.endswith("run again: Arm.__init__() in robot.py changed")
    project.edit("scene.json", lambda text: "[]")
    (project.folder / "new.py").write_text("def right():\n    pass\n")
    assert project.run() == first
    assert "scene.json changed" in project.note


def test_comments_and_layout_run_nothing_again(project: Project) -> None:
    first = project.run()
    with Journal.open(project.journal) as journal:
        places = {outcome.mutant: outcome.place for outcome in journal.outcomes()}
    project.edit("mission.py", lambda text: "# a comment\n" + text.replace("(arm)", "(\n    arm,\n)"))
    project.edit("tests/test_mission.py", lambda text: "\n\n# another\n" + text)
    assert project.run() == set()
    assert project.note.startswith(f"reused all {len(first)} outcomes")
    with Journal.open(project.journal) as journal:
        now = {outcome.mutant: outcome.place for outcome in journal.outcomes()}
    project.run(fresh=True)
    with Journal.open(project.journal) as journal:
        assert {outcome.mutant: outcome.place for outcome in journal.outcomes()} == now
    assert now != places


def test_a_changed_test_file_runs_the_mutants_again_that_it_judges(project: Project) -> None:
    first = project.run()
    right = of("right", first)
    project.edit("tests/test_right.py", ASSERTS_MORE)
    assert project.run() == right
    kept = len(first) - len(right)
    assert project.note == (
        f"reused {kept} of {len(first)} outcomes; {len(right)} run again: test_right() in tests/test_right.py"
        " changed"
    )


def test_a_new_test_runs_what_it_judges_and_no_test_has_killed_before_it(project: Project) -> None:
    first = project.run()
    killed = {pair for pair in first if pair[0].endswith("reverse")}
    judged = "\ndef test_right_again():\n    assert mission.right(Arm()) > 0\n"
    project.edit("tests/test_right.py", lambda text: text + judged)
    assert project.run() == of("right", first) - killed
    assert "which tests reach it changed" in project.note
    (project.folder / "tests" / "test_zero.py").write_text(f"from robot import Arm\nimport mission\n{judged}")
    assert project.run() == of("right", first) - killed
    before = "def test_first():\n    assert mission.right(Arm()) > 0\n\n"
    project.edit(
        "tests/test_right.py", lambda text: text.replace("def test_right():", f"{before}def test_right():")
    )
    assert project.run() == of("right", first)
    (project.folder / "tests" / "conftest.py").write_text("")
    assert project.run() == first
    assert "tests/conftest.py is new" in project.note


def test_survivors_are_not_asked_again_by_tests_that_do_not_reach_them_and_that_is_reported(
    project: Project,
) -> None:
    first = project.run()
    project.edit("tests/test_right.py")
    assert project.run() == set()
    assert "not asked again" not in "\n".join(project.progress.lines)  # a comment can have changed nothing
    project.edit("tests/test_right.py", ASSERTS_MORE)
    assert project.run() == of("right", first)
    with Journal.open(project.journal) as journal:
        kept = [
            outcome for outcome in journal.outcomes() if (outcome.mutant, outcome.round) in journal.reused()
        ]
    survivors = sum(outcome.verdict is Verdict.SURVIVED for outcome in kept)
    assert 0 < survivors < len(kept)
    assert (
        f"{survivors} of them are survivors that tests do not reach which may have changed: these are not "
        "asked again; `mutabot run --fresh` asks all"
    ) in project.progress.lines
    assert project.run() == set()
    assert "not asked again" not in "\n".join(project.progress.lines)


def test_what_a_test_has_noticed_that_does_not_reach_it_depends_on_all_tests(
    project: Project, script: Script
) -> None:
    script.mutated = noticed_from_elsewhere
    first = project.run()
    noticed = {pair for pair in of("left", first) if pair[0].endswith("reverse")}
    assert noticed
    assert project.run() == set()
    project.edit("tests/test_right.py", ASSERTS_MORE)
    assert project.run() == of("right", first) | noticed
    (project.folder / "tests" / "test_then.py").write_text("def test_then():\n    pass\n")
    assert project.run() == set()  # after all that have decided
    (project.folder / "tests" / "test_more.py").write_text("def test_more():\n    pass\n")
    assert project.run() == of("right", first) | noticed
    assert "which tests there are changed" in project.note


def test_a_changed_operation_runs_its_own_mutants_again(project: Project) -> None:
    first = project.run()
    project.edit("robot.toml", lambda text: text.replace("noise = 0.5", "noise = 0.4"))
    ran = project.run()
    assert ran == {pair for pair in first if "arm.position" in pair[0]}
    assert "run again: robot:Arm.position in the vocabulary changed" in project.note
    project.edit("robot.toml", lambda text: text.replace('failures = ["robot:Diverged"]', ""))
    assert project.run() == first
    assert "failures of the vocabulary changed" in project.note


def test_another_seed_or_version_runs_everything_again(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = project.run()
    assert project.run(seed=2) == first
    assert "run again: seed is 2, was 1" in project.note
    monkeypatch.setattr(mutabot, "__version__", "99.0")
    assert project.run(seed=2) == first
    assert "mutabot is 99.0, was" in project.note


def test_limits_and_settings_of_pytest_run_everything_again(project: Project) -> None:
    first = project.run()
    project.edit("mutabot.toml", lambda text: text + "timeout_factor = 20\n")
    assert project.run() == first
    assert "timeout_factor is 20.0, was 10.0" in project.note
    (project.folder / "pyproject.toml").write_text("[tool.ruff]\nline-length = 80\n[quick]\nname = 'x'\n")
    assert project.run() == first  # pytest takes the folder with this file for its root
    project.edit("pyproject.toml", lambda text: text.replace("80", "90"))
    assert project.run() == set()
    project.edit("pyproject.toml", lambda text: text + "[tool.pytest.ini_options]\naddopts = '-s'\n")
    assert project.run() == first
    assert "tool.pytest in pyproject.toml changed" in project.note


def test_further_rounds_and_mutants_are_run_beside_those_that_hold(project: Project) -> None:
    reverse = project.run(only=("reverse",))
    all_of_first = project.run() | reverse
    assert "not run before" in project.note
    second = project.run(rounds=2)
    assert {round for _, round in second} == {1}
    assert len(second) == len(all_of_first)
    assert project.run(only=("reverse",)) == set()
    assert project.run(rounds=2) == set()


def test_a_selection_of_nothing_leaves_the_earlier_campaign_as_it_was(project: Project) -> None:
    first = project.run()
    before = project.all_results()
    with pytest.raises(SelectionError, match="revers"):
        project.run(only=("reversed",), fresh=True)
    after = project.all_results()
    assert len(after.mutants) == len(first)
    assert (after.mutants, after.groups, after.state) == (before.mutants, before.groups, "complete")
    assert (after.attempt or "").startswith("--only: no mutant matches 'reversed'")
    assert project.run() == set()
    assert project.all_results().attempt is None


@pytest.mark.parametrize("fresh", [False, True])
def test_a_narrow_run_shows_its_mutants_beside_all_others(project: Project, fresh: bool) -> None:
    first = project.run()
    whole = project.all_results()
    narrow = project.run(only=("2",), fresh=fresh)
    assert len(narrow) == int(fresh)
    results = project.all_results()
    assert [mutant.mutant for mutant in results.mutants] == [mutant.mutant for mutant in whole.mutants]
    assert results.groups == whole.groups
    assert len(results.earlier) == len(first) - 1
    assert not any(result.outdated for result in results.mutants)
    assert project.state() == ("complete", 1)
    assert project.run() == set()
    assert not project.all_results().earlier


def test_results_of_earlier_runs_are_marked_where_something_has_changed(project: Project) -> None:
    project.run()
    project.edit("tests/test_right.py", ASSERTS_MORE)
    narrow = project.run(only=("5",))
    outdated = {result.mutant.id for result in project.all_results().mutants if result.outdated}
    earlier = {result.mutant.id for result in project.all_results().earlier}
    assert {mutant for mutant, _ in of("right", {(mutant, 0) for mutant in earlier})} == outdated
    assert outdated < earlier
    assert not outdated & {mutant for mutant, _ in narrow}
    project.edit("scene.json")
    project.run(only=("1",))
    assert all(result.outdated for result in project.all_results().earlier)


@pytest.mark.needs("source")
def test_mutants_of_another_family_stay_until_the_program_has_them_no_longer(project: Project) -> None:
    robots = {mutant for mutant, _ in project.run()}
    texts = {mutant for mutant, _ in project.run(families=("conventional",))}
    shown = project.all_results()
    assert {result.mutant.id for result in shown.mutants} == robots | texts
    assert {result.mutant.id for result in shown.earlier} == robots
    assert not any(result.outdated for result in shown.mutants)
    numbers = [result.mutant.number for result in shown.mutants]
    assert len(numbers) == len(set(numbers))
    project.edit("robot.py", lambda text: text.replace("self.x = x", "'docstring'; self.x = x"))
    project.run(families=("conventional",))
    assert {result.mutant.id for result in project.all_results().mutants if result.outdated} == robots
    assert {mutant for mutant, _ in project.run(families=("robot", "conventional"))} == robots


def test_mutants_that_the_program_has_no_longer_are_not_shown(project: Project) -> None:
    project.run()
    project.edit("mission.py", lambda text: text.replace("return arm.position()", "return 1"))
    project.run(only=("1",))
    shown = project.all_results()
    assert {result.mutant.operation for result in shown.mutants} == {"robot:Arm.move_by"}
    assert len(shown.mutants) == 6
    assert sum(result.outdated for result in shown.mutants) == 3


def test_an_interrupted_campaign_shows_what_was_there_before(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = project.run()
    project.edit("scene.json")

    def interrupted(*arguments: Any, **options: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(campaign, "run_planned", interrupted)
    with pytest.raises(KeyboardInterrupt):
        project.run()
    shown = project.all_results()
    assert (shown.state, shown.done) == ("interrupted", len(first))
    assert all(result.outdated for result in shown.mutants)
    project.edit("scene.json", lambda text: text.removesuffix("\n# edited\n"))
    with pytest.raises(KeyboardInterrupt):
        project.run(fresh=True)
    assert not any(result.outdated for result in project.all_results().mutants)


def test_errors_and_unstable_outcomes_are_never_reused(project: Project) -> None:
    first = sorted(project.run())
    bad = {first[0], first[1]}
    with edited(project.journal) as connection:
        for pair, verdict in zip(sorted(bad), (Verdict.ERROR, Verdict.UNSTABLE), strict=True):
            connection.execute(
                "UPDATE outcome SET verdict = ?1, data = json_set(json_remove(data, '$.by'), "
                "'$.verdict', ?1) WHERE mutant = ?2 AND round = ?3",
                (verdict.value, *pair),
            )
    assert project.run() == bad
    assert "2 run again: they ended in an error or unstable" in project.note


def test_data_that_the_tests_write_are_no_reason_to_run_again(project: Project, script: Script) -> None:
    def written(run: Run) -> dict[str, Any]:
        (project.folder / "log.txt").write_text(str(time.time()))
        return {}

    script.original = written
    assert project.run()
    assert project.run() == set()


def test_a_new_file_that_nothing_has_to_do_with_is_no_reason_to_run_again(project: Project) -> None:
    project.run()
    for name in ("out.txt", "run.log", "docs/plan.pdf", "tests/notes.md"):
        path = project.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("a note\n")
    assert project.run() == set()
    (project.folder / "out.txt").write_text("another\n")
    assert project.run() == set()


def test_a_program_edited_while_mutants_run_is_never_mistaken_for_the_one_they_ran(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = campaign.run_planned

    def edited(*arguments: Any) -> bool:
        project.edit("mission.py")
        return original(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(campaign, "run_planned", edited)
        first = project.run()
    assert "mission.py changed while mutants ran" in project.note
    project.edit("mission.py", lambda text: text.removesuffix("\n# edited\n"))
    assert project.run() == first


def test_an_interrupted_campaign_goes_on(project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    add = Journal.add_outcome

    def interrupt(self: Journal, outcome: Outcome, *, key: str) -> None:
        add(self, outcome, key=key)
        if len(self.outcomes()) == 3:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "add_outcome", interrupt)
        with pytest.raises(KeyboardInterrupt):
            project.run()
    assert project.state() == ("interrupted", 3)
    ran = project.run()
    assert project.note == f"reused 3 of {len(ran) + 3} outcomes; {len(ran)} not run before"
    assert project.state() == ("complete", len(ran) + 3)


@pytest.mark.parametrize("phase", ["begin", "whole_plan"])
def test_a_campaign_that_ends_before_its_first_mutant_loses_nothing(
    project: Project, script: Script, monkeypatch: pytest.MonkeyPatch, phase: str
) -> None:
    first = project.run()

    def interrupt(*arguments: Any, **options: Any) -> None:
        raise KeyboardInterrupt

    for _ in range(2):
        with monkeypatch.context() as patch:
            patch.setattr(campaign, phase, interrupt)
            with pytest.raises(KeyboardInterrupt):
                project.run()
        assert project.state() == ("complete", len(first))
        assert project.all_results().attempt == "interrupted"
    project.edit("tests/test_right.py", lambda text: text + "    assert False\n")
    with monkeypatch.context() as patch:
        patch.setattr(script, "original", lambda run: CHECKED if "right" in run.test else {})
        with pytest.raises(BaselineError):
            project.run()
    assert project.state() == ("complete", len(first))
    assert (project.all_results().attempt or "").startswith("1 test fails")
    project.edit("tests/test_right.py", lambda text: text.removesuffix("    assert False\n"))
    with pytest.raises(NothingToDoError):
        project.run(only=("reverse",), skip=("reverse",))
    assert project.run() == set()
    assert project.note == f"reused all {len(first)} outcomes: nothing that they depend on has changed"


def test_a_full_disk_stops_the_campaign_and_keeps_what_is_there(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    add = Journal.add_outcome

    def fill(self: Journal, outcome: Outcome, *, key: str) -> None:
        if len(self.outcomes()) == 3:
            connection = self._file
            pages = connection.execute("PRAGMA page_count").fetchone()[0]
            connection.execute(f"PRAGMA max_page_count = {pages}")
            outcome = Outcome(outcome.mutant, outcome.round, outcome.verdict, message="x" * 100_000)
        add(self, outcome, key=key)

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "add_outcome", fill)
        with pytest.raises(JournalError, match="disk is full"):
            project.run()
    assert project.state()[1] == 3
    assert_nothing_is_left(project)
    project.run()
    assert project.note.startswith("reused 3 of ")


def test_a_disk_that_is_full_for_the_workers_is_a_clear_error(
    project: Project, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "job")

    monkeypatch.setattr(campaign, "run_planned", full)
    with pytest.raises(JournalError, match="job cannot be written: No space left"):
        project.run()
    assert_nothing_is_left(project)


def can_mount(folder: Path) -> bool:
    words = ["mount", "-t", "tmpfs", "-o", "size=700k", "none", str(folder)]
    return os.geteuid() == 0 and subprocess.run(words, capture_output=True, check=False).returncode == 0


def mutabot_run(project: Project, *options: str) -> subprocess.Popen[str]:
    words = [sys.executable, "-m", "mutabot.cli.app", "-C", str(project.folder), "run", "-j", "2", *options]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.whole
def test_a_really_full_disk_is_exit_code_2(real: Project) -> None:
    home = real.journal.parent
    home.mkdir()
    if not can_mount(home):
        pytest.skip("needs the right to mount a file system")
    try:
        (home / "ballast").write_bytes(b"x" * 580_000)
        _, said = (process := mutabot_run(real)).communicate()
        assert process.returncode == 2, said
        assert str(home) in said
        assert "Traceback" not in said
        assert_nothing_is_left(real)
        (home / "ballast").unlink()
        real.run()
    finally:
        subprocess.run(["umount", str(home)], check=True)


def test_a_folder_that_cannot_be_written_is_exit_code_2(real: Project) -> None:
    (real.folder / ".mutabot").write_text("in the way")
    _, said = (process := mutabot_run(real)).communicate()
    assert process.returncode == 2
    assert ".mutabot" in said
    assert "Traceback" not in said


@pytest.mark.whole
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_campaign_ended_from_outside_says_so_and_goes_on(real: Project, how: signal.Signals) -> None:
    slow = "import time\n\ndef test_slow():\n    time.sleep(60)\n"
    first = real.run()
    (real.folder / "tests" / "test_slow.py").write_text(slow)
    process = mutabot_run(real)
    until = time.monotonic() + 120
    while not processes(real) and time.monotonic() < until:
        time.sleep(0.02)
    time.sleep(0.5)  # until it has told the kernel whose child it is
    process.send_signal(how)
    _, said = process.communicate()
    assert process.returncode == (130 if how == signal.SIGINT else -how), said
    assert real.state() == ("complete", len(first))
    assert real.all_results().attempt == ("interrupted" if how == signal.SIGINT else "killed")
    (real.folder / "tests" / "test_slow.py").unlink()
    assert real.run() == set()
    assert len(first) == real.state()[1]
    assert_nothing_is_left(real)


def processes(project: Project) -> list[str]:
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (entry / "cwd").readlink() == project.folder:
                found.append((entry / "cmdline").read_text())
        except OSError:
            continue
    return found


def assert_nothing_is_left(project: Project) -> None:
    until = time.monotonic() + 60
    while processes(project) and time.monotonic() < until:
        time.sleep(0.02)
    assert processes(project) == []
    assert not list(project.journal.parent.glob("work-*"))
    assert not list(project.journal.parent.glob("*.new"))


@pytest.mark.whole
def test_campaigns_killed_at_random_moments_end_like_an_undisturbed_one() -> None:
    words = [sys.executable, str(BENCHMARK), "--kills", "5", "--rounds", "1", "--seed", "7"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sum(json.loads(done.stdout)["kills"].values()) == 5


def test_changes_are_described_in_words() -> None:
    old = {"a.py": "#1", "b.py": "#1", "seed": "1", "numpy": "2.0"}
    new = {"b.py": "#2", "c.py": "#1", "seed": "2", "numpy": "2.0"}
    assert changed_parts(old, new) == ["a.py is gone", "b.py changed", "c.py is new", "seed is 2, was 1"]
    assert changed_parts({}, {"numpy": "2.0"}) == ["numpy is new"]


def test_a_snapshot_holds_what_tests_could_read_and_nothing_else(tmp_path: Path) -> None:
    counted = ("mission.py", "scenes/box.xml", ".env", "conftest.py", "deep/er/data.csv")
    others = (
        ".git/config", ".mutabot/journal.sqlite", "env/pyvenv.cfg", "env/lib/x.py", "a/__pycache__/x.pyc",
        "report/mutabot-report.txt", "report/data/campaign.js", "README.md", ".gitignore", ".venv/x.py",
        "x.egg-info/PKG-INFO", "mission.py~",
    )  # fmt: skip
    for name in (*counted, *others):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    os.mkfifo(tmp_path / "pipe")  # to open it would wait for ever
    (tmp_path / "nowhere").symlink_to("gone")
    (tmp_path / "loop").symlink_to(tmp_path)
    assert set(Snapshot.take(tmp_path).files) == set(counted)


def test_thousands_of_files_are_read_in_a_moment(tmp_path: Path) -> None:
    for folder in range(30):
        (tmp_path / str(folder)).mkdir()
        for file in range(100):
            (tmp_path / str(folder) / f"{file}.py").write_text(f"{folder} {file}\n" * 200)
    before = time.process_time()
    first = Snapshot.take(tmp_path)
    assert time.process_time() - before < 1.5  # a fifth of that on a quiet machine
    assert len(first.files) == 3000
    (tmp_path / "3" / "4.py").write_text("edited")
    again = Snapshot.take(tmp_path, first)
    assert again.edited_since(first.digests) == ["3/4.py"]
    assert again.touched_since(first) == {"3/4.py"}
