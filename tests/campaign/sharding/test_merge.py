"""Shards put together are as one campaign; shards of other plans are refused, and what is missing is told."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.campaign.checking import plan_only
from mutabot.campaign.run import run_campaign
from mutabot.campaign.sharding.shards import merge
from mutabot.config.options import Shard
from mutabot.errors import MergeError, UsageError
from mutabot.journal.files import recordings_path
from mutabot.journal.journal import Journal
from mutabot.journal.recordings import Recordings
from mutabot.model import Outcome
from mutabot.results.results import read_results
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.test_evidence import MISSION, ROBOT, TESTS, VOCABULARY
from tests.journal.edited import edited

ROOM = 100_000_000
MORE = """
    def again(arm):
        arm.move_by(0.25)
        arm.grip(True)
"""
CHANGES = {
    "rounds": 2, "evidence": True, "families": ("robot", "graded"), "engine": "fork",
    "only": ("mission.py:run:arm.move_by#1:*",),
}  # fmt: skip


def project(folder: Path) -> Path:
    return write_project(folder, MISSION + MORE, TESTS, robot=ROBOT, vocabulary=VOCABULARY)


def plain(outcome: Outcome) -> Outcome:
    return replace(outcome, wall=0.0, cpu=0.0)


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a project, its whole campaign, and the same in two shards."""
    home = tmp_path_factory.mktemp("shards")
    root = project(home / "cell")
    for name, shard in (("whole", None), ("1", Shard(1, 2)), ("2", Shard(2, 2))):
        run_campaign(request_for(root, shard=shard, **CHANGES), Quiet())
        (root / ".mutabot").rename(home / name)
    return home


def shards(campaigns: Path) -> list[Path]:
    return [campaigns / "1", campaigns / "2"]


def test_the_outcomes_are_those_of_a_whole_campaign(campaigns: Path, tmp_path: Path) -> None:
    target = tmp_path / "merged.sqlite"
    assert merge(shards(campaigns), target, root=campaigns / "cell", room=ROOM) == []
    with Journal.open(target) as found, Journal.open(campaigns / "whole" / "journal.sqlite") as whole:
        ours, theirs = read_results(found), read_results(whole)
        assert ours.state == theirs.state == "complete"
        assert {(outcome.mutant, outcome.round): plain(outcome) for outcome in found.outcomes()} == {
            (outcome.mutant, outcome.round): plain(outcome) for outcome in whole.outcomes()
        }
    assert ours.groups == theirs.groups
    assert ours.graded
    assert [result.mutant for result in ours.everything] == [result.mutant for result in theirs.everything]
    assert ours.controls
    assert all(control.ok for control in ours.controls)


def test_the_recordings_are_merged_too(campaigns: Path, tmp_path: Path) -> None:
    target = tmp_path / "merged.sqlite"
    merge(shards(campaigns), target, root=campaigns / "cell", room=ROOM)
    found = Recordings.to_read(target)
    whole = Recordings.to_read(campaigns / "whole" / "journal.sqlite")
    assert found is not None
    assert whole is not None
    with found, whole:
        assert set(found.pairs()) == set(whole.pairs())
        for pair in whole.pairs():
            assert found.of(*pair) == whole.of(*pair)


def test_a_run_goes_on_from_the_merged_journal(campaigns: Path, tmp_path: Path) -> None:
    root = tmp_path / "cell"
    shutil.copytree(campaigns / "cell", root)
    merge(shards(campaigns)[:1], root / ".mutabot" / "journal.sqlite", root=root, room=ROOM)
    told = Quiet()
    path = run_campaign(request_for(root, **CHANGES), told)
    with Journal.open(path) as journal, Journal.open(campaigns / "whole" / "journal.sqlite") as whole:
        assert journal.reused()
        assert {(outcome.mutant, outcome.round) for outcome in journal.outcomes()} == {
            (outcome.mutant, outcome.round) for outcome in whole.outcomes()
        }


def test_a_shard_is_no_whole_campaign(campaigns: Path) -> None:
    with Journal.open(campaigns / "2" / "journal.sqlite") as journal:
        found = read_results(journal)
    assert found.state == "shard 2 of 2"
    assert found.done < found.planned
    assert found.shard is not None
    assert {result.mutant.number for result in found.everything if result.outcomes} <= set(
        found.shard.mutants
    )


def test_shards_part_the_plan_and_no_ladder(campaigns: Path) -> None:
    root = campaigns / "cell"
    whole = plan_only(request_for(root, **CHANGES), Quiet()).mutants
    parts = []
    for name in ("1", "2"):
        with Journal.open(campaigns / name / "journal.sqlite") as journal:
            found = read_results(journal)
        assert found.shard is not None
        parts.append(set(found.shard.mutants))
    assert parts[0] | parts[1] == {mutant.number for mutant in whole}
    assert not parts[0] & parts[1]
    ladders = [
        {mutant.ladder for mutant in whole if mutant.ladder and mutant.number in part} for part in parts
    ]
    assert any(ladders)
    assert not ladders[0] & ladders[1]


def test_a_missing_shard_is_reported_with_what_to_do(campaigns: Path, tmp_path: Path) -> None:
    target = tmp_path / "merged.sqlite"
    (told,) = merge(shards(campaigns)[1:], target, root=campaigns / "cell", room=ROOM)
    assert told.startswith("shard 1 of 2 missing")
    assert "`mutabot run --shard 1/2`" in told
    with Journal.open(target) as journal:
        assert read_results(journal).state == "not all shards are there"


def test_a_shard_that_was_interrupted_is_reported(campaigns: Path, tmp_path: Path) -> None:
    shutil.copytree(campaigns / "1", tmp_path / "1")
    with Journal.open(tmp_path / "1" / "journal.sqlite") as journal:
        lost = journal.outcomes()[0]
    with edited(tmp_path / "1" / "journal.sqlite") as connection:
        connection.execute("DELETE FROM outcome WHERE mutant = ? AND round = ?", (lost.mutant, lost.round))
        connection.execute("UPDATE meta SET value = '\"interrupted\"' WHERE key = 'journal:finished'")
    (told,) = merge([tmp_path / "1", campaigns / "2"], tmp_path / "m.sqlite", root=tmp_path, room=ROOM)
    assert "is not complete (interrupted), 1 outcomes are missing" in told


def test_a_merged_journal_may_lie_where_a_shard_did(campaigns: Path, tmp_path: Path) -> None:
    shutil.copytree(campaigns / "1", tmp_path / "1")
    target = tmp_path / "1" / "journal.sqlite"
    assert merge([tmp_path / "1", campaigns / "2"], target, root=campaigns / "cell", room=ROOM) == []
    with Journal.open(target) as journal:
        assert read_results(journal).state == "complete"
    found = Recordings.to_read(target)
    assert found is not None
    assert recordings_path(target).is_file()
    found.close()


def test_the_same_shard_twice_is_refused(campaigns: Path, tmp_path: Path) -> None:
    with pytest.raises(MergeError, match="shard 1 of 2 is there twice"):
        merge([campaigns / "1", campaigns / "1"], tmp_path / "m.sqlite", root=tmp_path, room=ROOM)


def test_a_whole_campaign_is_no_shard(campaigns: Path, tmp_path: Path) -> None:
    with pytest.raises(MergeError, match="holds a whole campaign, not a shard"):
        merge([campaigns / "whole"], tmp_path / "m.sqlite", root=tmp_path, room=ROOM)
    with pytest.raises(MergeError, match="there is no journal"):
        merge([tmp_path], tmp_path / "m.sqlite", root=tmp_path, room=ROOM)
    assert not (tmp_path / "m.sqlite").exists()


def test_shards_of_other_files_are_refused_by_their_names(campaigns: Path, tmp_path: Path) -> None:
    root = tmp_path / "cell"
    shutil.copytree(campaigns / "cell", root)
    for name in ("mission.py", "tests/test_mission.py"):
        (root / name).write_text((root / name).read_text() + "\n# changed\n")
    path = run_campaign(request_for(root, shard=Shard(2, 2), **{**CHANGES, "rounds": 1}), Quiet())
    target = tmp_path / "m.sqlite"
    with pytest.raises(MergeError) as error:
        merge([campaigns / "1", path], target, root=root, room=ROOM)
    assert "mission.py changed; tests/test_mission.py changed" in str(error.value)
    assert "rounds is 1, was 2" in str(error.value)
    assert not target.exists()


@pytest.mark.parametrize(
    ("key", "inner", "value", "told"),
    [
        ("shard", "depends", {"seed": "5"}, "seed is 5, was 1"),
        ("shard", "depends", {"families": "robot"}, "families is robot, was robot, graded"),
        ("shard", "of", 3, "one is of 3 shards, the other of 2"),
        ("shard", "depends", None, "ended in its baseline, or files changed meanwhile"),
    ],
)
def test_shards_of_different_plans_are_refused_by_what_differs(
    campaigns: Path, tmp_path: Path, key: str, inner: str, value: object, told: str
) -> None:
    shutil.copytree(campaigns / "2", tmp_path / "2")
    with edited(tmp_path / "2" / "journal.sqlite") as connection:
        (text,) = connection.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
        old = json.loads(text)
        new = {**old, inner: {**old[inner], **value} if isinstance(value, dict) else value}
        connection.execute("UPDATE meta SET value = ? WHERE key = ?", (json.dumps(new), key))
    with pytest.raises(MergeError) as error:
        merge([campaigns / "1", tmp_path / "2"], tmp_path / "m.sqlite", root=tmp_path, room=ROOM)
    assert told in str(error.value)


@pytest.mark.parametrize("text", ["", "2", "0/4", "5/4", "1/0", "a/b", "-1/2", "1/2/3", "1.5/2"])
def test_what_is_no_shard_is_refused(text: str) -> None:
    with pytest.raises(UsageError):
        Shard.parse(text)
    assert Shard.parse(" 2 / 8 ") == Shard(2, 8)
