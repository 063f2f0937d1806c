"""Blocks of code on the pages name their language and are of it."""

from __future__ import annotations

import ast
import doctest
import json
import shlex
import tomllib
from collections.abc import Callable

import pytest
import yaml

import pages

PAGES = pages.pages()
TEXTS = {page: (pages.ROOT / page).read_text(encoding="utf-8") for page in PAGES}
BLOCKS = [(page, block) for page in PAGES for block in pages.blocks(TEXTS[page])]
_PROMPT = "$ "


def _check_python(text: str) -> None:
    if ">>> " in text:
        for example in doctest.DocTestParser().get_examples(text):
            ast.parse(example.source)
    else:
        ast.parse(text)


def _check_toml(text: str) -> None:
    """A file or a part of one; or one key several times, each line a way to write it."""
    lines = text.splitlines()
    ways = len(lines) > 1 and len({line.partition("=")[0].strip() for line in lines}) == 1
    for part in lines if ways else [text]:
        tomllib.loads(part)


def _check_console(text: str) -> None:
    assert text.startswith(_PROMPT), "a console begins with a command"


#: what a language's blocks must be; text is what is printed, and may be anything
CHECKS: dict[str, Callable[[str], object]] = {
    "bash": lambda text: shlex.split(text, comments=True),
    "console": _check_console,
    "json": json.loads,
    "python": _check_python,
    "text": str,
    "toml": _check_toml,
    "yaml": yaml.safe_load,
}


def test_every_block_names_a_language() -> None:
    unknown = [f"{page}:{block.line}" for page, block in BLOCKS if block.language not in CHECKS]
    assert unknown == [], f"put it between ``` and name one of {', '.join(CHECKS)}"


def test_every_block_is_of_its_language() -> None:
    wrong = []
    for page, block in BLOCKS:
        try:
            CHECKS[block.language](block.text)
        except (SyntaxError, ValueError, AssertionError, yaml.YAMLError) as error:
            wrong.append(f"{page}:{block.line}: {error}")
    assert wrong == []


def test_blocks_of_most_languages_are_on_the_pages() -> None:
    assert {block.language for _, block in BLOCKS} >= CHECKS.keys() - {"json"}


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("python", "def f(:\n"),
        ("python", ">>> f(\n"),
        ("toml", "a = b\n"),
        ("toml", "[[operation]\ncall = 'x'\n"),
        ("toml", "a = 1\nb = 2\na = 3\n"),
        ("bash", "mutabot 'run\n"),
        ("console", "mutabot run\n"),
        ("json", "{'a': 1}"),
        ("yaml", "a: [1\n"),
    ],
)
def test_a_block_of_another_language_is_seen(language: str, text: str) -> None:
    with pytest.raises((SyntaxError, ValueError, AssertionError, yaml.YAMLError)):
        CHECKS[language](text)
