"""How many of our files an outcome goes through: whoever follows one opens these, and no more."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import mutabot
from mutabot.campaign.comparison import ProbeSpread
from mutabot.campaign.engines import engine as engines
from mutabot.campaign.run import run_campaign
from mutabot.evidence.recording import Recording, to_text
from mutabot.execution.task import Result
from mutabot.journal.journal import Journal
from mutabot.model.events import ForkTestEnd
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import CHECKED, Script, Scripted

MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    import mission
    from robot import Arm

    def test_run():
        mission.run(Arm())
"""
#: from the end of a mutant's test, as the executor hands it to the engine, to its row in the file: these
#: decide something about an outcome
DECIDING = {
    "campaign/engines/engine.py", "campaign/engines/forks.py", "campaign/engines/replay.py",
    "campaign/baseline/baseline.py", "campaign/verdict.py", "campaign/comparison.py",
    "campaign/reuse/keys.py", "journal/journal.py",
}  # fmt: skip
#: and these hold the journal's file against others: whose it is, and that it is still there
GUARDING = {"journal/database.py", "journal/files.py"}
#: and these have the data that it is made of: what processes tell, the mutant with its place and the answers
#: that it carries, the outcome and what was executed, how numbers are compared, and how data become JSON
DATA = {
    "model/events.py", "model/mutant.py", "model/job.py", "model/answer.py", "model/outcome.py",
    "model/source_units.py", "model/quantity.py", "model/codec.py",
}  # fmt: skip
#: what was recorded of the world has a way beside it: kept recordings, what is in them, and how they differ
RECORDED = {
    "campaign/evidence.py", "journal/recordings.py", "evidence/recording.py", "evidence/story.py",
    "model/world_difference.py",
}  # fmt: skip
#: the most files of the others that an outcome goes through
MOST = 14
ROOT = Path(mutabot.__file__).parent


class Follower:
    """Notes which files of ours are entered, as long as the executor is not at work."""

    def __init__(self) -> None:
        self.files: dict[str, None] = {}
        self.is_under_way = False

    def look(self, frame: FrameType, event: str, argument: object) -> None:
        path = Path(frame.f_code.co_filename)
        if event == "call" and path.is_relative_to(ROOT):
            self.files[path.relative_to(ROOT).as_posix()] = None

    def aside(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function whose files are not noted."""

        def unseen(*arguments: Any) -> Any:
            sys.setprofile(None)
            found = function(*arguments)
            sys.setprofile(self.look if self.is_under_way else None)
            return found

        return unseen

    def events(self, told: Iterable[Any]) -> Iterator[Any]:
        """What the executor tells, from the end of the mutant's test on."""
        for entry in told:
            is_fork = isinstance(entry, tuple) and isinstance(entry[1], ForkTestEnd)
            is_fresh = isinstance(entry, Result) and entry.task.job.mutant is not None
            self.is_under_way = self.is_under_way or is_fork or is_fresh
            sys.setprofile(self.look if self.is_under_way else None)
            yield entry
            sys.setprofile(None)


@pytest.mark.parametrize("is_recorded", [False, True])
@pytest.mark.parametrize("ends", [CHECKED, {}], ids=["killed", "survived"])
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_an_outcome_goes_through_few_files(
    tmp_path: Path,
    script: Script,
    monkeypatch: pytest.MonkeyPatch,
    engine: str,
    ends: Mapping[str, Any],
    is_recorded: bool,
) -> None:
    recorded = {"recording": to_text(Recording())} if is_recorded else {}
    script.original = lambda run: recorded
    script.mutated = lambda run: {**ends, **recorded}
    follower, add, told = Follower(), Journal.add_outcome, Scripted.events
    visited: list[list[str]] = []

    def add_outcome(*arguments: Any, **named: Any) -> None:
        add(*arguments, **named)
        sys.setprofile(None)
        # how classes of data are made is no part of the way
        visited.append([name for name in follower.files if name != "frozen.py"])
        follower.files.clear()
        follower.is_under_way = False

    monkeypatch.setattr(Journal, "add_outcome", add_outcome)
    monkeypatch.setattr(Scripted, "events", lambda self, tasks: follower.events(told(self, tasks)))
    # how far the original scatters is found once for each test and round, not for each outcome
    monkeypatch.setattr(ProbeSpread, "between", follower.aside(ProbeSpread.between))
    # a control is another mutant, with an end of its own
    monkeypatch.setattr(engines, "controls_of", lambda *_, **__: [])
    monkeypatch.setattr(engines, "run_controls", lambda *_: iter(()))
    write_project(tmp_path, MISSION, TESTS)
    run_campaign(
        request_for(tmp_path, engine=engine, only=("reverse",), rounds=2, evidence=is_recorded), Quiet()
    )
    _, files = visited  # the first outcome makes what later ones find
    assert {"campaign/verdict.py", "campaign/reuse/keys.py", "journal/journal.py"} <= {*files}
    assert {*files} <= DECIDING | GUARDING | DATA | RECORDED
    assert len({*files} - RECORDED - GUARDING) <= MOST, files
    assert (not RECORDED.isdisjoint(files)) is is_recorded
