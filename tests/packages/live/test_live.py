"""A real campaign with its page: it can be stopped, and ends as it would without."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from campaign.project import write_project
from mutabot.cli.app import main
from mutabot.errors import ExitCode
from mutabot.journal.reader import JournalReader
from packages.live.visits import PATIENCE, ask, command, listening

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.5)
"""
#: outcomes come one by one
ONE_BY_ONE = ("--engine", "replay", "--only", "1-4")
TESTS = """
    import time
    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        arm = Arm()
        mission.run(arm)
        time.sleep(0.2)
        assert arm.x == -0.25
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write_project(tmp_path / "project", MISSION, TESTS)


@contextmanager
def running(folder: Path, *options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """``mutabot live`` in a project, and the address that it prints."""
    words = [sys.executable, "-m", "mutabot", "live", "-o", "repeats=false", "-j", "1", *options]
    process = subprocess.Popen(
        words, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL
    )
    try:
        assert process.stderr is not None
        found = re.fullmatch(r"mutabot: live at (http://127\.0\.0\.1:\d+/\S+/)\n", process.stderr.readline())
        assert found is not None
        yield process, found[1]
    finally:
        process.kill()
        process.communicate()


def until(events: Iterator[tuple[int, str, Any]], wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """The first state that is wanted; states in between may have been left out."""
    state: dict[str, Any] = {}
    for _, kind, state in events:
        if kind == "state" and wanted(state):
            return state
        assert kind == "note" or not state["ended"], state
    raise AssertionError(f"the stream ended with {state}")


def is_at_mutants(state: dict[str, Any]) -> bool:
    return bool(state["stage"] == "mutants" and state["done"])


def journal_of(folder: Path) -> JournalReader:
    return JournalReader.open(folder / ".mutabot" / "journal.sqlite")


@pytest.mark.whole
def test_a_campaign_is_watched_and_stays_until_the_page_is_closed(project: Path) -> None:
    with running(project, *ONE_BY_ONE) as (process, address):
        with listening(address) as events:
            until(events, is_at_mutants)
            last = until(events, lambda state: state["ended"] == "complete")
            text = ask(address, "data/campaign.js").text
            assert f'"version":{last["version"]}' in text
            assert '"state":"complete"' in text
            assert process.poll() is None
        out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == ExitCode.FINE
    assert "survivors" in out
    assert "the page stays as long as a browser shows it" in err
    with journal_of(project) as journal:
        assert journal.finished == "complete"
        assert len(journal.outcomes()) == len(journal.mutants()) == 4


@pytest.mark.whole
def test_stop_is_like_ctrl_c_and_the_campaign_goes_on_later(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with running(project, *ONE_BY_ONE) as (process, address):
        with listening(address) as events:
            until(events, is_at_mutants)
            until(events, lambda state: state["done"] > 0)
            assert command(address, "stop") == 204
            until(events, lambda state: state["ended"] == "interrupted")
        _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == ExitCode.INTERRUPTED
    assert "`mutabot results` shows the results so far" in err
    with journal_of(project) as journal:
        assert journal.finished == "interrupted"
        found = len(journal.outcomes())
        assert 0 < found < len(journal.mutants())
    assert main(["-C", str(project), "run", "-o", "repeats=false", *ONE_BY_ONE]) == ExitCode.FINE
    assert f"reused {found} of" in "".join(capsys.readouterr())


@pytest.mark.whole
def test_what_an_earlier_campaign_found_is_not_shown_as_this_one(project: Path) -> None:
    assert main(["-C", str(project), "run", "-o", "repeats=false", "--only", "1"]) == ExitCode.FINE
    with running(project) as (_, address), listening(address) as events:
        until(events, lambda state: state["stage"])
        assert ask(address, "data/campaign.js").text == ""
        until(events, is_at_mutants)
        text = ask(address, "data/campaign.js").text
        while not text:  # the journal is not looked into more than once a second
            until(events, lambda state: True)
            text = ask(address, "data/campaign.js").text
        assert '"planned":6' in text  # the earlier one had 1


def test_a_campaign_that_ends_before_its_first_mutant_says_so(project: Path) -> None:
    with running(project, "--only", "nothing-like-it") as (process, address):
        with listening(address) as events:
            states = [data for _, kind, data in events if kind == "state"]
        process.communicate(timeout=PATIENCE)
    assert "nothing-like-it" in states[-1]["ended"]
    assert process.returncode == ExitCode.USAGE
