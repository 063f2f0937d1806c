"""SIGTERM, as of build servers and ``timeout``, ends a campaign as Ctrl-C does: what was found is kept."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from uuid import uuid4

import pytest

from mutabot.cli.app import main, terminated_like_ctrl_c
from mutabot.errors import ExitCode
from mutabot.execution.interruption import interruptible, interruptions_kept
from mutabot.journal.reader import JournalReader
from tests.campaign.project import write_project

#: seconds: only so that a test that fails does not hang
PATIENCE = 120.0
MARK = "MUTABOT_TEST_MARK"
MISSION = "def run(arm):\n    arm.move_by(0.25)\n    arm.move_by(-0.5)\n"
TESTS = """
    import os
    import time

    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        arm = Arm()
        mission.run(arm)
        while arm.x != -0.25 and "GO_ON" not in os.environ:  # any mutant stays here
            time.sleep(0.02)
        assert arm.x == -0.25
"""


def marked(mark: str) -> list[str]:
    """The command lines of processes that were begun below the one with this mark."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={mark}".encode() in (folder / "environ").read_bytes().split(b"\0"):
                found.append((folder / "cmdline").read_text())
        except OSError:
            continue
    return found


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_a_campaign_that_is_terminated_ends_cleanly_and_goes_on_later(
    tmp_path: Path, engine: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write_project(tmp_path, MISSION, TESTS)
    mark = str(uuid4())
    run = [sys.executable, "-m", "mutabot", "run", "-o", "repeats=false", "-j", "1", "--engine", engine]
    process = subprocess.Popen(
        run, cwd=tmp_path, text=True, stderr=subprocess.PIPE, stdout=subprocess.PIPE,
        env={**os.environ, MARK: mark},
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert any(line.startswith("mutants 0/") for line in process.stderr)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
        process.communicate()
    assert process.returncode == ExitCode.TERMINATED == 128 + signal.SIGTERM
    assert err.endswith("ended by SIGTERM; `mutabot results` shows the results so far\n")
    assert marked(mark) == []
    assert not list((tmp_path / ".mutabot").glob("work-*"))
    with JournalReader.open(tmp_path / ".mutabot" / "journal.sqlite") as journal:
        assert journal.finished == "interrupted"
        assert len(journal.outcomes()) < len(journal.mutants())
    monkeypatch.setenv("GO_ON", "1")
    assert main(["-C", str(tmp_path), *run[3:]]) == ExitCode.FINE
    assert "complete" in capsys.readouterr().out


def test_it_is_ctrl_c_to_whoever_listens_and_gone_afterwards() -> None:
    with terminated_like_ctrl_c() as termination, pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGTERM)
    assert termination
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_it_ends_what_waits_also_where_ctrl_c_is_ignored() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with terminated_like_ctrl_c(), pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        with terminated_like_ctrl_c(), interruptions_kept():
            signal.raise_signal(signal.SIGTERM)
            with pytest.raises(KeyboardInterrupt), interruptible():
                pass
    finally:
        signal.signal(signal.SIGINT, before)


def test_who_handles_or_ignores_it_already_goes_on_to_do_so() -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with terminated_like_ctrl_c() as termination:
            signal.raise_signal(signal.SIGTERM)
        assert not termination
    finally:
        signal.signal(signal.SIGTERM, before)
