"""Commands on the pages have names and options that there are."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator

import pytest
import typer.main

import pages
from mutabot.cli.app import app

PAGES = pages.pages()
COMMAND = typer.main.get_command(app)

#: words before a command: variables, and other ways to start it
_BEFORE = re.compile(r"(?:\w+=\S* )*(?:\S*python -m |\S*bin/)?(?=(?:mutabot|make) )")
#: what ends a command in a line of a shell
_ENDS = {";", "&&", "||", "|", ">", ">>", "&"}
_PROMPT = "$ "


def targets_of_make() -> set[str]:
    """The targets in the Makefile, with its variables filled in."""
    text = (pages.ROOT / "Makefile").read_text(encoding="utf-8")
    variables = re.findall(r"^(\w+)\s*:= (.*)$", text, re.MULTILINE)
    for name, value in reversed(variables):  # later ones are made of earlier ones
        text = text.replace(f"$({name})", value)
    return set(re.findall(r"^([\w./-]+):", text, re.MULTILINE))


MAKE = targets_of_make()


def lines_typed(block: pages.Block) -> Iterator[str]:
    """The lines of a block that go to a shell."""
    lines = block.text.replace("\\\n", " ").splitlines()
    if block.language == "console":
        yield from (line.removeprefix(_PROMPT) for line in lines if line.startswith(_PROMPT))
    elif block.language == "bash":
        yield from lines
    elif block.language == "yaml":
        yield from (re.sub(r"^[\s-]*(?:run: )?", "", line) for line in lines)


def words_of(command: str) -> list[str]:
    """The words of a command of ours, up to a pipe or the like; none if it is another's."""
    before = _BEFORE.match(command.strip())
    if before is None:
        return []
    lexer = shlex.shlex(command.strip()[before.end() :], posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    words = list(lexer)
    ends = [at for at, word in enumerate(words) if word in _ENDS]
    return words[: ends[0]] if ends else words


def commands(page: str) -> list[list[str]]:
    """Our commands in a page's blocks and sentences."""
    text = (pages.ROOT / page).read_text(encoding="utf-8")
    lines = [line for block in pages.blocks(text) for line in lines_typed(block)]
    return [words for line in [*lines, *pages.codes(text)] if len(words := words_of(line)) > 1]


def fault(words: list[str]) -> str:
    """What is wrong with the names and options of a command; empty if nothing is."""
    name, *rest = words
    if name == "make":
        unknown = [word for word in rest if word not in MAKE and not re.match(r"-|\w+=", word)]
        return f"no target {' '.join(unknown)}" if unknown else ""
    context = COMMAND.context_class(COMMAND, info_name=name)
    try:
        _, rest, _ = COMMAND.make_parser(context).parse_args(rest)
        if rest:
            _, command, rest = COMMAND.resolve_command(context, rest)  # type: ignore[attr-defined]
            command.make_parser(command.context_class(command, parent=context)).parse_args(rest)
    except Exception as error:  # the parser's own, which have no public name in typer
        return getattr(error, "message", repr(error))
    return ""


def test_every_command_is_one_of_ours_with_options_that_it_has() -> None:
    faults = {(page, *words): fault(words) for page in PAGES for words in commands(page)}
    assert {command: what for command, what in faults.items() if what} == {}


@pytest.mark.parametrize("file", ["ci/github.yml", "ci/gitlab.yml"])
def test_every_command_of_a_file_for_ci_has_the_options_that_it_uses(file: str) -> None:
    block = pages.Block("yaml", (pages.ROOT / file).read_text(encoding="utf-8"), 1)
    found = [words for line in lines_typed(block) if len(words := words_of(line)) > 1]
    assert {words[1] for words in found} == {"run", "merge", "report"}
    faults = {" ".join(words): fault(words) for words in found}
    assert {command: what for command, what in faults.items() if what} == {}


def test_many_commands_are_looked_at() -> None:
    found = [words for page in PAGES for words in commands(page)]
    assert len(found) > 100
    assert {words[1] for words in found} >= {"run", "show", "report", "check", "demo"}
    assert sum(any(word.startswith("--") for word in words) for words in found) > 30


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("mutabot runn", "No such command 'runn'"),
        ("mutabot run --rouns 3 > x.txt", "No such option: --rouns"),
        ("mutabot --prject x run", "No such option: --prject"),
        ("A=1 ../.venv/bin/python -m mutabot show --verdict", "No such option: --verdict"),
        ("make tests", "no target tests"),
    ],
)
def test_a_wrong_command_is_seen(line: str, told: str) -> None:
    assert told in fault(words_of(line))


@pytest.mark.parametrize(
    "line",
    ["mutabot -C x run --only 5 -j 2 | less --nonsense", "make site", "make .venv-ros1/.ready  # first"],
)
def test_a_right_command_has_no_fault(line: str) -> None:
    assert len(words_of(line)) > 1
    assert fault(words_of(line)) == ""
