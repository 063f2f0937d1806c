"""Lines of keys in TOML texts."""

from __future__ import annotations

import tomllib
from typing import Any

from mutabot.config.document import KeyPath, key_lines

TEXT = '''# a comment with [brackets] = and "quotes"
title = "a # b" # c
[tool.mutabot]
program = [
  "a.py", # first
  'b.py',
]
"quoted key".x = 1
text = """
[no.table]
key = 1 \\""" still text
"""
raw = \'\'\'
[no]\'\'\'
date = 1979-05-27 07:32:00
[[operation]]
call = "a:b"
arguments."x[0]" = { kind = "label", values = [1, { deep = [[]] }], "odd ] } key" = {} }
[operation.result.".pose.x"]
unit = "m"
[[operation.patterns]]
text = "p"
[[operation.patterns]]
text = "q"
[[operation]]
call = "a:c"
[operation.result]
kind = "flag"
[[operation.patterns]]
text = "r"
'''

EXPECTED: dict[KeyPath, int] = {
    ("title",): 2,
    ("tool", "mutabot"): 3,
    ("tool", "mutabot", "program", 0): 5,
    ("tool", "mutabot", "program", 1): 6,
    ("tool", "mutabot", "quoted key", "x"): 8,
    ("tool", "mutabot", "text"): 9,
    ("tool", "mutabot", "raw"): 13,
    ("tool", "mutabot", "date"): 15,
    ("operation", 0): 16,
    ("operation", 0, "arguments", "x[0]", "values", 1, "deep"): 18,
    ("operation", 0, "arguments", "x[0]", "odd ] } key"): 18,
    ("operation", 0, "result", ".pose.x", "unit"): 20,
    ("operation", 0, "patterns", 1, "text"): 24,
    ("operation", 1): 25,
    ("operation", 1, "result", "kind"): 28,
    ("operation", 1, "patterns", 0, "text"): 30,
}


def test_every_key_has_the_line_it_is_written_in() -> None:
    lines = key_lines(TEXT)
    assert {place: lines.get(place) for place in EXPECTED} == EXPECTED


def test_every_value_that_the_standard_library_reads_is_found() -> None:
    lines = key_lines(TEXT)
    known = {place[:length] for place in lines for length in range(1, len(place) + 1)}
    assert [place for place in places(tomllib.loads(TEXT)) if place not in known] == []


def places(value: Any, place: KeyPath = ()) -> list[KeyPath]:
    items: Any = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    inner = [found for key, item in items for found in places(item, (*place, key))]
    return [place, *inner] if place else inner
