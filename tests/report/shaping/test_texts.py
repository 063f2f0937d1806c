"""Texts that may leave the machine."""

from __future__ import annotations

import pytest

from mutabot.report.texts import Cleaner, escaped, legible


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("/srv/cell/tests/a.py:3", "tests/a.py:3"),
        ("in '/srv/cell'", "in '.'"),
        ("file:///srv/cell/log.txt", "log.txt"),
        ("/srv/cellar/a.py", "…/a.py"),
        ("No such file: '/home/me/models/arm.urdf'", "No such file: '…/arm.urdf'"),
        ("file:///tmp/pytest-of-me/x.log, again", "…/x.log, again"),
        ("/usr/lib/python3.12/json/decoder.py:355", "…/decoder.py:355"),
        ("(/opt/ros/kilted/share)", "(…/share)"),
        ("/arm/move_by told nothing", "/arm/move_by told nothing"),
        ("topic /robot/tmp/pose", "topic /robot/tmp/pose"),
        ("1/2 and a/tmp/b and https://example.org/home/x", "1/2 and a/tmp/b and https://example.org/home/x"),
        ("\x1b[31mred\x1b[0m", "red"),
    ],
)
def test_paths_of_the_machine_become_relative_and_topics_stay(text: str, wanted: str) -> None:
    assert Cleaner("/srv/cell")(text) == wanted


def test_without_a_root_nothing_is_taken_for_it() -> None:
    assert Cleaner(None)("/a/b") == Cleaner("/")("/a/b") == "/a/b"


def test_a_text_is_as_long_as_before_so_that_columns_stay() -> None:
    odd = "a\x00b\ud800c\ufffe\td\ne"
    assert legible(odd) == "a\ufffdb\ufffdc\ufffd\td\ne"


@pytest.mark.parametrize("text", ["83.3 %", "-0.2 m", "mission.py:3", "a - b", "1.5"])
def test_markdown_is_not_escaped_without_need(text: str) -> None:
    assert escaped(text) == text


def test_no_link_is_made_of_an_address() -> None:
    assert "://" not in escaped("https://example.org")
    assert "www." not in escaped("www.example.org")
