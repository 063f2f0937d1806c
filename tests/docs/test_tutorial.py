"""The tutorial runs: its files are written, and its commands typed, as they stand on the page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.cli.app import main

PAGE = Path(__file__).parents[2] / "docs" / "tutorial.md"
TEXT = PAGE.read_text(encoding="utf-8")
_BLOCK = re.compile(r"^```(?P<kind>\w+)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# (?P<name>[\w/.]+)\n")
#: stands on the page for lines that differ from machine to machine
_SHORTENED = "…"


def steps() -> Iterator[tuple[str, str]]:
    """What a reader does, in order: a file's name and what to write, or a command and what it prints."""
    for block in _BLOCK.finditer(TEXT):
        if block["kind"] == "text":
            continue  # what a reader sees who does something else
        if block["kind"] == "console":
            command, _, printed = block["text"].partition("\n")
            yield command, printed
        else:
            file = _FILE.match(block["text"])
            assert file is not None, f"a block without the name of its file: {block['text']}"
            yield file["name"], block["text"]


def lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.strip("\n").splitlines() if line.strip()]


def is_shown(page: str, printed: str) -> bool:
    """Whether the page shows what was printed, but for what it says is left out."""
    parts = ["(?:.*\n)*" if line.strip() == _SHORTENED else re.escape(line) + "\n" for line in lines(page)]
    return re.fullmatch("".join(parts), "".join(f"{line}\n" for line in lines(printed))) is not None


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "tests").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    return tmp_path


@pytest.mark.whole
def test_a_reader_sees_what_the_page_shows(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = []
    for what, text in steps():
        if not what.startswith("$ "):
            (folder / what).write_text(text, encoding="utf-8")
            continue
        assert main(what.split()[2:]) == 0
        printed = capsys.readouterr().out
        assert is_shown(text, printed), f"{PAGE.name} tells otherwise of `{what}`, which prints:\n{printed}"
        shown.append(printed)
    _, first, before, second, after = shown
    # told twice, so that nobody who brings the page up to date can lose its point
    assert "13  packing.py:10  reverse" in first
    assert "13  packing.py:10  reverse" not in second
    assert "round 1: S survived" in before
    assert "round 1: C killed by a check" in after


def test_a_reader_who_mistypes_a_name_gets_an_error_that_names_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for what, text in steps():
        if not what.startswith("$ "):
            (folder / what).write_text(text.replace('Arm.move_by"', 'Arm.move_bye"'), encoding="utf-8")
    assert main(["check"]) == 2
    (message,) = re.findall(r"^(mutabot: .*)$", TEXT, re.MULTILINE)
    assert message in capsys.readouterr().err
