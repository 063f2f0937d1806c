"""A journal that came with the repository is refused: a pull request that brings one judges itself."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.cli.app import main
from mutabot.config.options import Shard
from mutabot.errors import JournalError
from mutabot.journal.files import refuse_tracked
from tests.campaign.project import Quiet, request_for, write_project

from .edited import edited

MISSION = """
    def fetch(arm):
        arm.move_by(0.5)
        arm.move_by(-0.25)
"""
#: notices nothing
TESTS = """
    import mission
    from robot import Arm

    def test_fetch():
        mission.fetch(Arm())
"""
GATE = ("run", "--min-score", "80", "-o", "repeats=false")
Forge = Callable[[Path, Path], tuple[str, ...]]


def git(folder: Path, *words: str) -> str:
    own = ("-c", "user.name=a", "-c", "user.email=a@b")
    return subprocess.run(
        ["git", *own, *words], cwd=folder, check=True, capture_output=True, text=True
    ).stdout.strip()


def forged(journal: Path) -> Path:
    """All survivors are killed, as the journal has it now: also the digests of its rows are right."""
    with edited(journal) as connection:
        (count,) = connection.execute("SELECT count(*) FROM outcome WHERE verdict = 'survived'").fetchone()
        assert count
        connection.execute(
            "UPDATE outcome SET verdict = 'killed', data = "
            "json_set(data, '$.verdict', 'killed', '$.by', 'check', '$.test', ?)",
            ("tests/test_mission.py::test_fetch",),
        )
    return journal


@pytest.fixture(scope="module")
def attacked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A repository whose tests notice nothing, and a journal that says the opposite."""
    home = tmp_path_factory.mktemp("attack")
    origin = write_project(home / "origin", MISSION, TESTS, more={"requirements.txt": ""})
    git(origin, "init", "-q", "-b", "main")
    git(origin, "add", "-A")
    git(origin, "commit", "-qm", "first")
    run_campaign(request_for(origin), Quiet())
    shutil.move(origin / ".mutabot", home / "made")
    forged(home / "made" / "journal.sqlite")
    return origin, home / "made"


def own(clone: Path, made: Path) -> tuple[str, ...]:
    shutil.copytree(made, clone / ".mutabot")
    return ()


def named(clone: Path, made: Path) -> tuple[str, ...]:
    (clone / "ci").mkdir()
    shutil.copy(made / "journal.sqlite", clone / "ci" / "main.sqlite")
    return "--journal", "ci/main.sqlite"


def since(clone: Path, made: Path) -> tuple[str, ...]:
    return *named(clone, made), "--since", "HEAD~1"


def linked_file(clone: Path, made: Path) -> tuple[str, ...]:
    named(clone, made)
    (clone / ".mutabot").mkdir()
    (clone / ".mutabot" / "journal.sqlite").symlink_to("../ci/main.sqlite")
    return ()


def linked_folder(clone: Path, made: Path) -> tuple[str, ...]:
    shutil.copytree(made, clone / "notes")
    (clone / ".mutabot").symlink_to("notes")
    return ()


def linked_name(clone: Path, made: Path) -> tuple[str, ...]:
    shutil.copytree(made, clone / "deep" / ".store")
    (clone / "cache").symlink_to("deep/.store")
    return "--journal", "cache/journal.sqlite"


ATTACKS = (own, named, since, linked_file, linked_folder, linked_name)


@pytest.mark.parametrize("attack", ATTACKS, ids=lambda attack: str(attack.__name__))
def test_a_pull_request_cannot_bring_its_own_outcomes(
    attack: Forge, attacked: tuple[Path, Path], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    origin, made = attacked
    request = tmp_path / "request"
    git(tmp_path, "clone", "-q", str(origin), str(request))
    options = attack(request, made)
    git(request, "add", "-A", "-f")
    git(request, "commit", "-qm", "a harmless change")
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "-q", str(request), str(clone))
    before = git(clone, "status", "--porcelain", "--ignored")
    words = [str(clone / word) if word.endswith(".sqlite") else word for word in options]
    assert main(["-C", str(clone), *GATE, *words]) == 2
    said = capfd.readouterr().err
    assert "is not used, since git tracks" in said
    assert "git rm --cached" in said
    assert git(clone, "status", "--porcelain", "--ignored") in {before, "!! .mutabot/"}


def test_the_attack_would_succeed_with_a_journal_that_is_believed(
    attacked: tuple[Path, Path], tmp_path: Path
) -> None:
    """What makes the other tests mean something: the same journal, outside of the checkout."""
    origin, made = attacked
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "-q", str(origin), str(clone))
    assert main(["-C", str(clone), *GATE]) == 1
    shutil.rmtree(clone / ".mutabot")
    assert main(["-C", str(clone), *GATE, "--journal", str(made / "journal.sqlite")]) == 0


@pytest.mark.parametrize(
    "words",
    [
        ["results"], ["show", "1"], ["thresholds"], ["check"],
        pytest.param(["suggest"], marks=pytest.mark.needs("suggest")),
        ["report", "--format", "markdown"],
        ["merge", ".mutabot"], ["run"],
    ],
    ids=" ".join,
)  # fmt: skip
def test_no_command_believes_it(
    words: list[str],
    attacked: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    origin, made = attacked
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "-q", str(origin), str(clone))
    shutil.copytree(made, clone / ".mutabot")
    git(clone, "add", "-f", ".mutabot")
    monkeypatch.chdir(clone)
    assert main(words) == 2
    assert "git tracks .mutabot/" in capfd.readouterr().err


@pytest.mark.whole
def test_merge_takes_no_shard_from_the_checkout(
    attacked: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    origin, _ = attacked
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "-q", str(origin), str(clone))
    for number in (1, 2):
        run_campaign(request_for(clone, shard=Shard(number, 2)), Quiet())
        shutil.move(clone / ".mutabot", tmp_path / str(number))
    (clone / "shards").mkdir()
    shutil.copytree(tmp_path / "2", clone / "shards" / "2")
    monkeypatch.chdir(clone)
    assert main(["merge", str(tmp_path / "1"), "shards/2"]) == 0
    shutil.rmtree(clone / ".mutabot")
    git(clone, "add", "-f", "shards")
    assert main(["merge", str(tmp_path / "1"), "shards/2"]) == 2
    assert not (clone / ".mutabot").exists()


@pytest.mark.parametrize(
    "beside",
    [
        "main.sqlite-wal", "main.sqlite-journal", "main-evidence.sqlite", "main.previous.sqlite",
        "main-suggestions.json",
    ],
)  # fmt: skip
def test_what_lies_beside_a_journal_is_part_of_it(beside: str, tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    (tmp_path / "main.sqlite").touch()
    (tmp_path / beside).touch()
    refuse_tracked(tmp_path / "main.sqlite")
    git(tmp_path, "add", beside)
    with pytest.raises(JournalError, match=f"git tracks {beside}: .*git rm --cached {beside}"):
        refuse_tracked(tmp_path / "main.sqlite")


def test_a_journal_of_a_submodule_is_tracked_as_well(tmp_path: Path) -> None:
    for name in ("other", "cell"):
        (tmp_path / name).mkdir()
        git(tmp_path / name, "init", "-q")
    (tmp_path / "other" / "journal.sqlite").touch()
    git(tmp_path / "other", "add", "-A")
    git(tmp_path / "other", "commit", "-qm", "first")
    git(
        tmp_path / "cell",
        "-c",
        "protocol.file.allow=always",
        "submodule",
        "add",
        "-q",
        "../other",
        ".mutabot",
    )
    with pytest.raises(JournalError, match="git tracks"):
        refuse_tracked(tmp_path / "cell" / ".mutabot" / "journal.sqlite")


def test_links_and_folders_that_nobody_committed_are_the_users_own(tmp_path: Path) -> None:
    cell = tmp_path / "cell"
    cell.mkdir()
    git(cell, "init", "-q")
    (cell / "mission.py").touch()
    git(cell, "add", "-A")
    (tmp_path / "big disk").mkdir()
    (tmp_path / "big disk" / "journal.sqlite").touch()
    (cell / ".mutabot").symlink_to("../big disk")
    refuse_tracked(cell / ".mutabot" / "journal.sqlite")
    (cell / "loop").symlink_to("loop")
    refuse_tracked(cell / "loop" / "journal.sqlite")


def test_where_git_does_not_know_a_journal_is_not_believed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    git(tmp_path, "init", "-q")
    refuse_tracked(tmp_path / ".mutabot" / "journal.sqlite")
    (tmp_path / ".mutabot").mkdir()
    (tmp_path / ".mutabot" / "journal.sqlite").touch()
    monkeypatch.setenv("PATH", os.fspath(tmp_path / "nothing"))
    with pytest.raises(JournalError, match=r"it is not known whether .* git cannot be started"):
        refuse_tracked(tmp_path / ".mutabot" / "journal.sqlite")
