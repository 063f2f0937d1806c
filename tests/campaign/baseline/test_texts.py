"""Sites are named by the text as the compiler reads it, whatever its bytes are."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

from mutabot.campaign.baseline.baseline import Sources
from mutabot.languages.python import FRONT_END, extent_of
from mutabot.languages.read_parts import read_parts
from mutabot.model import Span
from mutabot.model.events import SiteSeen
from mutabot.model.mutant import Extent

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


class Arm:
    """Notes what it is told, and where the caller's text stands."""

    def __init__(self) -> None:
        self.places: list[tuple[str, Extent]] = []

    def _note(self, what: str) -> Arm:
        self.places.append((what, FRONT_END.position_of(sys._getframe(2))[0]))
        return self

    def move(self, to: float) -> Arm:
        return self._note(f"move {to}")

    def grüße(self) -> Arm:  # noqa: PLC2401  # bytes and characters differ
        return self._note("grüße")

    @property
    def at(self) -> Arm:
        return self._note("at")

    def __iadd__(self, by: float) -> Arm:
        return self._note(f"add {by}")


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("(arm\n  .move(1)\n  .move(2))", {"move 1": ("arm .move", 1), "move 2": ("arm .move(1) .move", 1)}),
        ("arm.move(\n  1\n).move(2)", {"move 1": ("arm.move", 1), "move 2": ("arm.move( 1 ).move", 1)}),
        ("arm.\\\n  move(1)", {"move 1": ("arm. move", 1)}),
        ("(arm\n  .grüße().grüße())", {"grüße": ("arm .grüße().grüße", 1)}),
        ("(arm\n  .at)", {"at": ("arm .at", 1)}),
        ("arm += 1; arm += 2; arm += 1", {"add 1": ("arm += 1", 2), "add 2": ("arm += 2", 1)}),
    ],
)
def test_what_the_interpreter_does_elsewhere_in_a_text_has_a_name(
    text: str, names: dict[str, tuple[str, int]]
) -> None:
    arm = Arm()
    exec(text, {"arm": arm})
    found = FRONT_END.names(text)
    assert {what: found[place] for what, place in arm.places} == names
