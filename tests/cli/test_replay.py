"""``mutabot replay``: what is refused before anything runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.cli.app import main
from results import samples


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--round 9", "there is no round 9; the campaign has 2"),
    ],
)
def test_what_cannot_be_done_is_2_before_anything_runs(
    words: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    samples.write_journal(tmp_path / ".mutabot" / "journal.sqlite")
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.glob("*"))
    assert main(["replay", str(samples.MUTANTS[1].number), *words.split()]) == 2
    assert told in capsys.readouterr().err
    assert sorted(tmp_path.glob("*")) == before
