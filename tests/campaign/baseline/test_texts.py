"""Sites are named by the text as the compiler reads it, whatever its bytes are."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from mutabot.campaign.baseline.baseline import Sources
from mutabot.languages.python import extent_of
from mutabot.languages.read_parts import read_parts
from mutabot.model import Span
from mutabot.model.events import SiteSeen

PROGRAM = """\
def go(arm):
    arm.move(1.0); arm.move(2.0); arm.grip(True)
    return arm.pos() + arm.pos()
"""
OTHER = PROGRAM.replace("    arm", "    'ü'; arm")
TEXTS = {
    "byte order mark": b"\xef\xbb\xbf" + PROGRAM.encode(),
    "form feeds": b"\x0c\n" + PROGRAM.replace("    return", "\x0c    return").encode(),
    "carriage returns": PROGRAM.replace("\n", "\r\n").replace("    ", "\t").encode(),
    "another encoding": f"# coding: latin-1\n{OTHER}".encode("latin-1"),
    "characters that end lines elsewhere": f"K = 'a\u2028b\x85c\x1cd\x0b'\n{PROGRAM}".encode(),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_calls_are_named_and_counted_whatever_the_text_is_written_in(tmp_path: Path, text: bytes) -> None:
    (tmp_path / "mission.py").write_bytes(text)
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    calls.sort(key=extent_of)
    seen = [
        SiteSeen(number, Span("mission.py", *extent_of(node), "go"), False, "robot:Arm.move", None)
        for number, node in enumerate(calls)
    ]
    sources = Sources(tmp_path)
    sites = [place.site for place in sources.places(seen).values()]
    names = [(site.text, site.occurrence) for site in sites]
    assert names == [("arm.move", 1), ("arm.move", 2), ("arm.grip", 1), ("arm.pos", 1), ("arm.pos", 2)]
    unused = [sources.found_at(sighting.span, read_parts) == frozenset() for sighting in seen]
    assert unused == [True, True, True, False, False]
