"""The cells of the page on notebooks print what stands there."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest

from docs.test_tutorial import steps
from mutabot.cli.app import main

PAGE = Path(__file__).parents[2] / "docs" / "notebook.md"
CELLS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def test_a_reader_sees_what_the_page_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tests").mkdir()
    for what, text in steps():
        if what == "$ mutabot run":
            break
        if not what.startswith("$ "):
            (tmp_path / what).write_text(text, encoding="utf-8")
    assert main(["run"]) == 0
    page = doctest.DocTestParser().get_doctest("".join(CELLS), {}, PAGE.name, str(PAGE), 0)
    assert len(page.examples) > 12
    told: list[str] = []
    result = doctest.DocTestRunner().run(page, out=told.append)
    assert result.failed == 0, "".join(told)
