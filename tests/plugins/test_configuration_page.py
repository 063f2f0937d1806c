"""The page about the configuration is generated; here is what keeps it true."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import configuration_page
from mutabot.settings.configuration import Settings

PAGE = Path(__file__).parents[2] / "docs" / "configuration.md"
#: what must be given
LEAST = {"program": ["mission.py"], "vocabulary": ["robot.toml"]}


def test_docs_configuration_md_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == configuration_page.page(), "run python tools/make_docs.py"


@pytest.mark.parametrize("key", Settings.model_fields)
def test_every_key_has_a_text_and_an_example_that_says_something_else_than_the_default(key: str) -> None:
    text, example = configuration_page.documented()[key]
    assert text.endswith(".")
    data = tomllib.loads(example)
    assert list(data) == [key]
    settings = Settings.model_validate({**LEAST, **data})
    assert getattr(settings, key) != Settings.model_fields[key].default


def test_a_key_without_a_text_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    class More(Settings):
        another: int = 1

    monkeypatch.setattr(configuration_page, "Settings", More)
    with pytest.raises(ValueError, match=r"missing below .*another"):
        configuration_page.documented()
