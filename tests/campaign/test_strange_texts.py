"""Texts that are no UTF-8, and folders in unusual places, change no outcome and lose none."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from campaign.project import Quiet, outcomes, request_for, write_project
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Outcome
from mutabot.results.gate import decide
from mutabot.results.results import read_results

MISSION = """
    def approach(arm):
        arm.move_by(0.25)
        arm.move_by(0.125)
        return arm.position()

    def retreat(arm):
        arm.move_by(-0.5)

    def twice(arm):
        arm.move_by(0.0625)
"""
#: ``TEXT`` is put into an exception, an assertion, the names of parameters and what functions return
TESTS = """
    import mission, pytest
    from robot import Arm

    def test_approach():
        arm = Arm()
        mission.approach(arm)
        if abs(arm.x - 0.375) > 1e-6:
            raise RuntimeError("off, TEXT")

    @pytest.mark.parametrize("name", ["plain", "TEXT", "other TEXT"])
    def test_retreat(name):
        arm = Arm()
        mission.retreat(arm)
        assert arm.x == -0.5, "not there: TEXT"
"""
MORE = """
    import mission
    from robot import Arm

    def test_twice():
        arm = Arm()
        mission.twice(arm)
        assert arm.x == 0.0625, "TEXT"
"""


def project(folder: Path, text: str, name: str) -> Path:
    more = MORE.replace("TEXT", text)
    configuration = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
    # pytest's cache cannot write such names: with it, pytest itself fails when the session ends
    configuration += 'pytest_args = ["-o", "pythonpath=.", "-p", "no:cacheprovider"]\n'
    files = {f"tests/{name}": more}
    write_project(folder, MISSION, TESTS.replace("TEXT", text), configuration=configuration, more=files)
    return folder


def run(folder: Path) -> tuple[dict[str, Outcome], Path]:
    path = run_campaign(request_for(folder), Quiet())
    return {outcome.mutant: outcome for outcome in outcomes(path)}, path


def ends(found: dict[str, Outcome], text: str, name: str) -> dict[str, object]:
    """How they ended, in words in which the texts of both projects are called alike."""

    def alike(said: str | None) -> str | None:
        for part in (text, name):
            said = said.replace(part, "…") if said is not None else None
        return said

    return {
        mutant: (
            outcome.verdict,
            outcome.by,
            alike(outcome.test),
            alike(outcome.message),
            outcome.hits,
            outcome.acted,
        )
        for mutant, outcome in found.items()
    }


@pytest.mark.whole
def test_with_texts_that_are_no_utf_8_each_mutant_ends_as_without(tmp_path: Path) -> None:
    plain, _ = run(project(tmp_path / "plain", "well", "test_well.py"))
    # in a folder whose name is none either
    found, path = run(project(tmp_path / "a\udcff b", "\\udcff", "test_\udcff.py"))
    assert len(plain) == 14
    assert ends(found, "\\udcff", "test_\\udcff.py") == ends(plain, "well", "test_well.py")
    assert any(outcome.test == "tests/test_\\udcff.py::test_twice" for outcome in found.values())
    assert sum("\\udcff" in (outcome.message or "") for outcome in found.values()) >= 6
    with Journal.open(path) as journal:
        results = read_results(journal)
    assert (results.state, results.done, results.planned) == ("complete", 14, 14)
    assert decide(results).exit_code == 0


MOUNTED = """
import ctypes, json, os, sys
from pathlib import Path

folder, tests = Path(sys.argv[1]), sys.argv[2]
libc = ctypes.CDLL(None, use_errno=True)
if libc.unshare(0x00020000) or libc.mount(b"none", b"/", None, 1 << 18 | 16384, None):
    raise SystemExit("not here")
if libc.mount(b"none", os.fsencode(folder), b"tmpfs", 0, None):
    raise SystemExit("not here")
sys.path.insert(0, tests)
from campaign.test_strange_texts import project, run

found, path = run(project(folder / "deep" / "project", "well", "test_well.py"))
print(json.dumps({mutant: one.verdict for mutant, one in found.items()}))
"""


@pytest.mark.whole
def test_a_project_on_a_file_system_mounted_below_the_temporary_folder(tmp_path: Path) -> None:
    folder = tmp_path / "mounted \u00fc here"
    folder.mkdir()
    tests = Path(__file__).parents[1]
    command = [sys.executable, "-c", MOUNTED, str(folder), str(tests)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, "TMPDIR": str(tmp_path)}
    )
    if "not here" in done.stderr:
        pytest.skip("nobody may mount anything here")
    assert done.returncode == 0, done.stderr
    verdicts = json.loads(done.stdout)
    assert len(verdicts) == 14
    assert set(verdicts.values()) == {"killed", "survived"}


def test_an_outcome_that_gets_lost_on_its_way_to_the_journal_is_missed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add, lost = Journal.add_outcome, []

    def lose_one(journal: Journal, outcome: Outcome, *, key: str = "") -> None:
        if lost:
            add(journal, outcome, key=key)
        lost.append(outcome.mutant)

    monkeypatch.setattr(Journal, "add_outcome", lose_one)
    found, path = run(write_project(tmp_path, MISSION, MORE))
    with Journal.open(path) as journal:
        results = read_results(journal)
        assert journal.finished == "incomplete"
    assert lost[0] not in found
    assert (results.state, results.done, results.planned) == ("incomplete", len(lost) - 1, len(lost))
    decision = decide(results)
    assert decision.exit_code == 4
    number = next(result.mutant.number for result in results.mutants if result.mutant.id == lost[0])
    assert f"mutants {number};" in decision.lines[0]
