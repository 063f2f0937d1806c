"""Files are read without loss; what cannot be read is said where it stands, and the rest is read."""

from __future__ import annotations

import random

import pytest

from mutabot_languages.core.parser import ParsedFile
from mutabot_languages.core.text import SourceText, decode
from mutabot_languages.core.tokens import TRIVIA
from mutabot_languages.registry import language_for
from tests.packages.languages.programs import FILES

PROGRAMS = [(name, text) for files in FILES.values() for name, text in files.items()]


def read(name: str, text: str) -> ParsedFile:
    language = language_for(name)
    assert language is not None
    return language.read(name, text)


@pytest.mark.parametrize(("name", "text"), PROGRAMS)
def test_tokens_and_trivia_are_the_whole_text_to_the_byte(name: str, text: str) -> None:
    language = language_for(name)
    assert language is not None
    for content in (
        text.encode("latin-1"),
        ("\ufeff" + text).encode(),
        b"\x00\xff \r" + text.encode("latin-1"),
    ):
        decoded, encoding = decode(content)
        tokens = language.parser.lexis.pattern.finditer(decoded)
        assert "".join(token.group() for token in tokens).encode(encoding) == content


@pytest.mark.parametrize(("name", "text"), PROGRAMS)
def test_programs_are_read_without_diagnostics(name: str, text: str) -> None:
    assert [diagnostic.text for diagnostic in read(name, text).diagnostics] == []


@pytest.mark.parametrize(("name", "text"), PROGRAMS)
def test_a_file_without_any_token_is_read_to_its_end(name: str, text: str) -> None:
    language = language_for(name)
    assert language is not None
    found = [
        candidate
        for candidate in language.parser.lexis.pattern.finditer(text)
        if candidate.lastgroup not in TRIVIA
    ]
    chosen = random.Random(0).sample(found, min(60, len(found)))
    for token in chosen:
        cut = text[: token.start()] + text[token.end() :]
        parsed = read(name, cut)
        for node in parsed.tree.walk():
            assert 0 <= node.start <= node.end <= len(cut)


def test_a_diagnostic_names_place_expectation_and_routine() -> None:
    text = "MODULE M\n  PROC main()\n    WaitTime 1;\n    n := ;\n    Reset d;\n  ENDPROC\nENDMODULE\n"
    parsed = read("m.mod", text)
    assert [diagnostic.text for diagnostic in parsed.diagnostics] == [
        "m.mod:4:10: expected an expression, found ';' (in PROC main)"
    ]
    kinds = [node.kind for node in parsed.tree.bodies[0][0].bodies[0][0].bodies[0]]
    assert kinds == ["call", "opaque", "call"]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.script", "def f():\n  x = 1\n"),
        ("a.mod", "MODULE M\nPROC f()\n  Set d;\nPROC g()\nENDPROC\nENDMODULE\n"),
        ("a.src", "DEF f()\nIF x THEN\n$OUT[1]=TRUE\nEND\n"),
        ("a.script", "((((" * 300),
        ("a.mod", "IF a THEN\n" * 300),
        ("a.src", "x=" + "-" * 400 + "1"),
        ("a.script", "end\nend\nelse\n"),
    ],
)
def test_what_is_open_or_too_deep_is_said(name: str, text: str) -> None:
    assert read(name, text).diagnostics


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.script", "def f(p, k):\n  p[0] = p[0] * k\n  return p\nend\n"),
        ("a.script", "def f(a, b):\n  return (a == 1) and\n    (b == 2)\nend\n"),
        ("a.mod", "MODULE M\n\u3000PROC main()\n\u3000\u3000n:=1;\nENDPROC\nENDMODULE\n"),
    ],
)
def test_what_public_programs_do_is_read(name: str, text: str) -> None:
    assert [diagnostic.text for diagnostic in read(name, text).diagnostics] == []


def test_a_single_number_behind_p_is_an_element_of_a_variable() -> None:
    target, value = read("a.script", "p[0] = p[1]\n").tree.bodies[0][0].parts
    assert [target.kind, value.kind] == ["index", "index"]
    (point,) = read("a.script", "x = p[0, 0, 0, 0, 0, 0]\n").tree.bodies[0][0].parts[1:]
    assert point.kind == "pose"


def test_columns_of_places_count_bytes() -> None:
    source = SourceText("x", "aé\r\nbü = 1\rc")
    assert source.extent(7, 8) == (2, 4, 2, 5)
    assert source.line_of(len(source.text)) == 3
