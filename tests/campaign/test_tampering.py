"""Programs under test that write to the journal or delete it: no outcome is lost, and none falsified."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.errors import ExitCode
from mutabot.journal.reader import JournalReader
from mutabot.model import Verdict
from mutabot.results.gate import decide
from mutabot.results.results import Results, read_results
from tests.campaign.project import CONFIGURATION, Quiet, request_for, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(0.25)
"""
#: whatever moves the arm otherwise than it should does this: it is a mutant's doing
TESTS = """
    import mission
    from pathlib import Path
    from robot import Arm

    def deed():
{deed}

    def test_moves():
        arm = Arm()
        mission.run(arm)
        if arm.x < 0.4:
            deed()
        assert arm.x > 0.1
"""
FORGE = """
        import sqlite3
        for path in Path(__file__).parents[1].glob(".mutabot/journal.sqlite"):
            with sqlite3.connect(path) as connection:
                connection.execute("UPDATE outcome SET verdict = 'killed'")
                connection.execute("DELETE FROM outcome WHERE rowid = 1")
"""
DELETE = """
        import shutil
        shutil.rmtree(Path(__file__).parents[1] / ".mutabot", ignore_errors=True)
"""
DELETE_JOURNAL = """
        for path in Path(__file__).parents[1].glob(".mutabot/journal*"):
            path.unlink()
"""
SPOIL_RECORDINGS = """
        for path in Path(__file__).parents[1].glob(".mutabot/journal-evidence.sqlite*"):
            path.write_bytes(b"?" * 10_000)
"""
Verdicts = dict[tuple[str, int], Verdict]


def project(folder: Path, deed: str) -> Path:
    configuration = f"{CONFIGURATION}\n    private_files = false\n"  # else tests write to a copy
    return write_project(folder, MISSION, TESTS.format(deed=deed), configuration=configuration)


def run(folder: Path, **options: object) -> tuple[Results, list[str]]:
    progress = Quiet()
    path = run_campaign(request_for(folder, engine="replay", evidence=True, **options), progress)
    with JournalReader.open(path) as journal:
        return read_results(journal), progress.lines


def verdicts(results: Results) -> Verdicts:
    return {
        (outcome.mutant, outcome.round): outcome.verdict
        for each in results.everything
        for outcome in each.outcomes
    }


@pytest.fixture(scope="module")
def harmless(tmp_path_factory: pytest.TempPathFactory) -> Verdicts:
    """How the mutants end if they do nothing of the kind."""
    results, _ = run(project(tmp_path_factory.mktemp("harmless"), "        pass"))
    found = verdicts(results)
    assert {Verdict.KILLED, Verdict.SURVIVED} <= set(found.values())
    return found


@pytest.mark.whole
def test_a_mutant_cannot_write_its_own_mark(tmp_path: Path, harmless: Verdicts) -> None:
    results, said = run(project(tmp_path, FORGE))
    assert verdicts(results) == harmless
    assert results.altered
    assert any("changed by something else and was restored" in line for line in said)
    decision = decide(results)
    assert decision.exit_code == ExitCode.UNRELIABLE
    assert "no test writes into .mutabot" in decision.lines[0]


@pytest.mark.whole
@pytest.mark.parametrize("deed", [DELETE, DELETE_JOURNAL], ids=["folder", "journal"])
def test_deleting_the_journal_costs_at_most_the_mutants_that_ran_then(
    tmp_path: Path, harmless: Verdicts, deed: str
) -> None:
    results, said = run(project(tmp_path, deed))
    found = verdicts(results)
    assert found.keys() == harmless.keys()
    for pair, verdict in found.items():
        assert verdict == harmless[pair] or (verdict is Verdict.ERROR and deed == DELETE)
    assert results.state == "complete"
    assert (results.altered, results.set_aside) == ((), ())
    assert any("it was written again, nothing is lost" in line for line in said)


@pytest.mark.whole
def test_recordings_that_are_spoiled_cost_no_outcome(tmp_path: Path, harmless: Verdicts) -> None:
    results, said = run(project(tmp_path, SPOIL_RECORDINGS))
    assert verdicts(results) == harmless
    assert results.state == "complete"
    assert not [line for line in said if "Traceback" in line]


@pytest.mark.whole
@pytest.mark.parametrize("name", ["journal.sqlite", "journal-evidence.sqlite"])
def test_processes_of_tests_do_not_learn_where_the_journal_is(tmp_path: Path, name: str) -> None:
    look = f"""
        import os, sys
        told = [*os.environ.values(), *sys.argv, *sys.orig_argv]
        folder = os.environ.get("MUTABOT_JOB")
        told += [Path(folder).read_text()] if folder else []
        found = [os.readlink(link) for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
        Path({str(tmp_path / "told")!r}).write_text("\\n".join([*told, *found]))
"""
    run(project(tmp_path / "project", look))
    told = (tmp_path / "told").read_text()
    assert told
    assert name not in told
