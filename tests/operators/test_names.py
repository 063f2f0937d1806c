"""Nothing outside of the operators' own rooms knows one by name."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import mutabot
from mutabot import operators
from mutabot.campaign.faults.providers import operators_of_packages
from mutabot.operators.command import CONTROLS

SOURCE = Path(mutabot.__file__).parent
#: packages beside the core, where they are installed: they draft vocabularies and checks for any operator
BESIDE = ("mutabot_init", "mutabot_suggest")
ROOMS = {"operators"}
NAMES = {*operators.names(), *operators_of_packages(), *CONTROLS}
#: words that name something else as well, where they do: keys of vocabularies, an option of the command line
OTHERWISE = {
    "opposite": {"mutabot_init", "config/vocabulary"},
    "noise": {"config/vocabulary"},
    "skip": {"cli"},
    "reverse": {"campaign/baseline/writes.py"},  # a method of lists
    "drop": {"mutabot_init"},
    "patch": {"mutabot_init"},  # a method of HTTP
    "delay": {"mutabot_init"},
    "offset": {"mutabot_init", "thresholds"},  # what a demand means that names none
}
#: what an id ends with, and what a selection may be made of
AT_THE_END = re.compile(r"^(?:.*:)?(?P<name>[\w-]+)(?:=.*)?$", re.DOTALL)
FILES = {
    file.relative_to(home).as_posix(): file
    for home, folder in [(SOURCE, SOURCE), *((SOURCE.parent, SOURCE.parent / name) for name in BESIDE)]
    for file in sorted(folder.rglob("*.py"))
    if file.relative_to(home).parts[0] not in ROOMS
}


def literals(tree: ast.AST) -> Iterator[ast.Constant]:
    """Texts of a program that are no docstrings."""
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            yield node


def named(text: str) -> str | None:
    """The operator that a text names, by itself or as the end of a mutant's id."""
    found = AT_THE_END.match(text)
    return found["name"] if found is not None and found["name"] in NAMES else None


def knows(tree: ast.AST, file: str = "") -> list[tuple[int, str]]:
    """Lines in which an operator is named."""
    found = ((node.lineno, named(node.value)) for node in literals(tree))
    return [(line, name) for line, name in found if name is not None and not is_otherwise(name, file)]


def is_otherwise(name: str, file: str) -> bool:
    return any(file == place or file.startswith(f"{place}/") for place in OTHERWISE.get(name, ()))


def test_no_operator_is_named() -> None:
    assert len(FILES) > 100
    for name, file in FILES.items():
        assert not knows(ast.parse(file.read_text(encoding="utf-8")), name), name


@pytest.mark.parametrize(
    "text", ['rule.name == "skip"', 'Mutant("SVR")', 'f"{site}:BSR"', 'id.endswith(":noise")', '{"by-to": 1}']
)
@pytest.mark.needs("source")
def test_a_name_in_the_code_is_found(text: str) -> None:
    assert knows(ast.parse(text))


@pytest.mark.parametrize("text", ['"""skip"""', '"noise of the sensor"', '"do it by repeat or not"'])
def test_words_of_sentences_are_no_names(text: str) -> None:
    assert not knows(ast.parse(text))
