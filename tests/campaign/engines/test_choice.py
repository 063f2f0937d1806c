"""A new engine is one file: nothing else knows of it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.engines import kinds
from mutabot.campaign.engines.choice import all_engines
from mutabot.cli.options import ENGINES
from mutabot.errors import UsageError
from mutabot.model import Verdict
from tests.campaign.project import run, write_project

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


@pytest.fixture
def more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder whose files count as engines, too."""
    folder = tmp_path / "more"
    folder.mkdir()
    monkeypatch.setattr(kinds, "__path__", [*kinds.__path__, str(folder)])
    all_engines.cache_clear()
    yield folder
    all_engines.cache_clear()
    sys.modules.pop(f"{kinds.__name__}.idle", None)


def test_the_command_line_knows_each_engine_by_its_file() -> None:
    assert {"auto", *(engine.name for engine in all_engines())} == set(ENGINES)


def test_an_engine_is_a_file(more: Path, tmp_path: Path) -> None:
    (more / "idle.py").write_text(dedent(IDLE))
    assert [engine.name for engine in all_engines()] == ["branch", "idle", "replay"]
    ends = run(write_project(tmp_path / "project", MISSION, TESTS), engine="idle", rounds=1)
    found = {mutant.rpartition(":")[2]: (one.verdict, one.engine) for mutant, one in ends.items()}
    assert len(found) > 1
    assert found.pop("skip") == (Verdict.ERROR, "idle")
    assert set(found.values()) == {(Verdict.NO_EFFECT, "idle")}


def test_an_engine_that_there_is_not_is_told_before_the_tests_run(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"'brunch'.*branch"):
        run(write_project(tmp_path, MISSION, TESTS), engine="brunch")
