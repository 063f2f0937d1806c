"""The operators' own examples, run as tests."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from mutabot.runtime.program_text.compiling import compile_tree
from mutabot.runtime.program_text.instrument import instrumented
from mutabot_source.operator import TextExample
from mutabot_source.registry import names, operator
from tests.packages.source.build import choices, refined, spliced, text_of

CASES = [(name, index) for name in names() for index in range(len(operator(name).examples))]


def example_of(name: str, index: int) -> TextExample:
    return operator(name).examples[index]


@pytest.mark.parametrize(("name", "index"), CASES)
def test_the_example_makes_exactly_these_texts(name: str, index: int, tmp_path: Path) -> None:
    example = example_of(name, index)
    text = refined(text_of(tmp_path, example.before, name), example)
    made = [spliced(example.before, place, alternative) for _, place, alternative in choices(text)]
    assert made == list(example.after)
    for after in made:
        ast.parse(after)


@pytest.mark.parametrize(("name", "index"), CASES)
def test_the_example_compiles_with_all_its_alternatives(name: str, index: int, tmp_path: Path) -> None:
    example = example_of(name, index)
    text = refined(text_of(tmp_path, example.before, name), example)
    for record in (False, True):
        compile_tree(instrumented(ast.parse(example.before), text.places, record=record), text.file)


@pytest.mark.parametrize("name", names())
def test_every_operator_shows_where_it_acts_and_where_it_stays_away(name: str) -> None:
    examples = operator(name).examples
    assert operator(name).summary
    assert any(example.after for example in examples)
    assert any(not example.after for example in examples)
