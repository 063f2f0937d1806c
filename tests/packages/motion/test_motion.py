"""``mutabot motion``: what is refused beforehand, and what is shown of what is recorded."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot.evidence.recording import to_bytes
from mutabot.journal.recordings import ORIGINAL, Rank, Recordings
from packages.motion.sample import recording
from results import samples

JOURNAL = Path(".mutabot", "journal.sqlite")
SURVIVOR = samples.MUTANTS[1]


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with the results of a campaign of which nothing was recorded."""
    samples.write_journal(tmp_path / JOURNAL)
    monkeypatch.chdir(tmp_path)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


@pytest.fixture
def recorded(project: Path) -> Path:
    """The same, with the survivor's test recorded in the first round, and that of the original in both."""
    with Recordings.to_write(project / JOURNAL, 10**6) as found:
        for round in range(2):
            found.add(ORIGINAL, round, samples.TEST, Rank.ORIGINAL, to_bytes(recording()))
        data = to_bytes(recording(lets_go=True))
        found.add(SURVIVOR.id, 0, samples.TEST, Rank.SURVIVOR, data)
    return project


def number() -> str:
    return str(SURVIVOR.number)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--test test_a", "say how to show it: --video,"),
        ("--video a.avi", "must end in .mp4"),
        ("--video nowhere/a.mp4", "there is no folder nowhere"),
        ("--rrd a.mp4", "must end in .rrd"),
        ("--mcap .", "must end in .mcap"),
        ("--mcap a.mcap --round 9", "there is no round 9; the campaign has 2"),
    ],
)
def test_what_cannot_be_done_is_2_before_anything_runs(
    words: str, told: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(project.glob("*"))
    assert main(["motion", number(), *words.split()]) == 2
    assert told in capsys.readouterr().err
    assert sorted(project.glob("*")) == before


@pytest.mark.parametrize(
    ("option", "library", "module"),
    [
        ("--rrd a.rrd", "rerun", "rrd"),
        ("--mcap a.mcap", "foxglove", "mcap"),
        ("--video a.mp4", "av", "pictures.video"),
    ],
)
def test_without_its_library_the_extra_is_named(
    option: str,
    library: str,
    module: str,
    project: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(__import__("sys").modules, library, None)
    monkeypatch.delitem(__import__("sys").modules, f"mutabot_motion.{module}", raising=False)
    assert main(["motion", number(), *option.split()]) == 2
    error = capsys.readouterr().err
    assert f"{option.partition(' ')[0]} need" in error
    assert "pip install 'path/to/mutabot[" in error


def test_of_what_was_not_recorded_it_is_said_what_records_it(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rerun")
    assert main(["motion", number(), "--test", samples.TEST, "--rrd", "a.rrd"]) == 2
    error = capsys.readouterr().err
    assert f"nothing is recorded of {samples.TEST} in round 1" in error
    assert "`mutabot run --fresh` records it" in error
    assert not (project / "a.rrd").exists()


def test_what_is_recorded_is_written_without_running_anything(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rerun")
    pytest.importorskip("foxglove")
    words = ["motion", number(), "--round", "1", "--rrd", "a.rrd", "--mcap", "a.mcap"]
    assert main(words) == 0
    assert (recorded / "a.rrd").read_bytes().startswith(b"RRF2")
    assert (recorded / "a.mcap").read_bytes().startswith(b"\x89MCAP0")
    out, err = capsys.readouterr()
    assert out == ""
    assert [line.partition(":")[2].partition(":")[0] for line in err.splitlines()] == [" a.rrd", " a.mcap"]


def test_where_nothing_differs_the_original_is_shown_and_that_is_said(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("foxglove")
    assert main(["motion", number(), "--round", "2", "--mcap", "a.mcap"]) == 0
    assert "differs: only the original is shown" in capsys.readouterr().err


def test_a_test_is_named_by_a_part_of_its_name_and_others_are_listed(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("foxglove")
    part = samples.TEST.rpartition("::")[2][-6:]
    assert main(["motion", number(), "--round", "1", "--test", part, "--mcap", "a.mcap"]) == 0
    assert main(["motion", number(), "--test", "nonsense", "--mcap", "a.mcap"]) == 2
    assert f"these do: {samples.TEST}" in capsys.readouterr().err
