"""The page about the configuration is generated; here is what keeps it true."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import configuration_page
from mutabot.config.configuration import Settings
from mutabot.config.table import Table

PAGE = Path(__file__).parents[2] / "docs" / "configuration.md"
#: what must be given
LEAST = {"program": ["mission.py"], "vocabulary": ["robot.toml"]}


@pytest.mark.needs("dask")
def test_docs_configuration_md_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == configuration_page.page(), "run python tools/make_docs.py"


MODELS: list[type[Table]] = [Settings, *configuration_page.tables_of_ours().values()]


@pytest.mark.parametrize(("model", "key"), [(model, key) for model in MODELS for key in model.model_fields])
def test_every_key_has_a_text_and_an_example_that_says_something_else_than_the_default(
    model: type[Table], key: str
) -> None:
    text, example = configuration_page.documented(model)[key]
    assert text.endswith(".")
    data = tomllib.loads(example)
    assert list(data) == [key]
    settings = model.model_validate({**(LEAST if model is Settings else {}), **data})
    assert getattr(settings, key) != model.model_fields[key].default


def test_a_key_without_a_text_is_named() -> None:
    class More(Settings):
        another: int = 1

    with pytest.raises(ValueError, match=r"missing below .*another"):
        configuration_page.documented(More)
