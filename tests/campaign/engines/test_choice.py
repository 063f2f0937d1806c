"""A new engine, and a new executor, is one file: nothing else knows of them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign import executors
from mutabot.campaign.engines import kinds
from mutabot.campaign.engines.choice import all_engines
from mutabot.campaign.run import run_campaign
from mutabot.cli.options import ENGINES
from mutabot.model import Verdict
from tests.campaign.project import Quiet, outcomes, request_for, run, write_project

MISSION = """
    def run(arm):
        arm.move_by(0.5)
    """
TESTS = """
    from mission import run
    from robot import Arm

    def test_run():
        run(Arm())
    """
#: says of each mutant that it did nothing, but for those that skip: these go to the next engine
IDLE = """
    from mutabot.model import Outcome, Verdict

    class Idle:
        name, order, runs, may_share = "idle", 50, 1, True

        def run(self, campaign, trials, left):
            for mutant, round in trials:
                if mutant.operator == "skip":
                    left.trials.append((mutant, round))
                else:
                    yield Outcome(mutant.id, round, Verdict.NO_EFFECT, engine=self.name)

        def try_controls(self, campaign, mutants, left):
            yield from ()

    ENGINE = Idle()
    """
EXECUTOR = """
    from mutabot.campaign.workers.workers import Workers

    class Telling(Workers):
        def __init__(self, request, tell):
            super().__init__(request.root, request.arguments, request.jobs)
            self.tell = tell

        def events(self, tasks):
            for event in super().events(tasks):
                if not isinstance(event, tuple):
                    self.tell("a task is done")
                yield event

    def executor(request, tell):
        return Telling(request, tell)
    """


@pytest.fixture
def more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with folders whose files count as engines, and as executors, too."""
    folder = tmp_path / "more"
    for package, name in ((kinds, "engines"), (executors, "executors")):
        (folder / name).mkdir(parents=True)
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(folder / name)])
    all_engines.cache_clear()
    yield folder
    all_engines.cache_clear()
    for name in (f"{kinds.__name__}.idle", f"{executors.__name__}.telling"):
        sys.modules.pop(name, None)


def test_the_command_line_knows_each_engine_by_its_file() -> None:
    assert {"auto", *(engine.name for engine in all_engines())} == set(ENGINES)


def test_an_engine_is_a_file(more: Path, tmp_path: Path) -> None:
    (more / "engines" / "idle.py").write_text(dedent(IDLE))
    assert [engine.name for engine in all_engines()] == ["branch", "idle", "warm", "replay"]
    ends = run(write_project(tmp_path / "project", MISSION, TESTS), engine="idle", rounds=1)
    found = {mutant.rpartition(":")[2]: (one.verdict, one.engine) for mutant, one in ends.items()}
    assert len(found) > 1
    assert found.pop("skip") == (Verdict.ERROR, "idle")
    assert set(found.values()) == {(Verdict.NO_EFFECT, "idle")}


def test_an_executor_is_a_file(more: Path, tmp_path: Path) -> None:
    (more / "executors" / "telling.py").write_text(dedent(EXECUTOR))
    told = Quiet()
    project = write_project(tmp_path / "project", MISSION, TESTS)
    found = outcomes(run_campaign(request_for(project, executor="telling", rounds=1), told))
    assert "a task is done" in told.lines
    assert {one.verdict for one in found} == {Verdict.SURVIVED}
