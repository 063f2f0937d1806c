"""Audit events reach those that asked for them."""

from __future__ import annotations

import sys
from typing import Any

from mutabot.runtime.processes.environment import FRAMES, listen


def test_a_listener_hears_what_it_asked_for_and_nothing_else() -> None:
    heard: list[tuple[str, tuple[Any, ...]]] = []
    listen(["test.asked"], lambda event, arguments: heard.append((event, arguments)))
    sys.audit("test.asked", 1)
    sys.audit("test.other", 2)
    assert heard == [("test.asked", (1,))]


def test_a_listener_that_another_adds_hears_the_same_event() -> None:
    heard: list[str] = []

    def first(event: str, arguments: tuple[Any, ...]) -> None:
        if not heard:
            listen(["test.added"], lambda event, arguments: heard.append("second"))
        heard.append("first")

    listen(["test.added"], first)
    sys.audit("test.added")
    assert heard == ["first", "second"]


def test_a_listener_finds_the_frame_of_what_caused_an_event() -> None:
    found: list[str] = []
    listen(["test.frame"], lambda event, arguments: found.append(sys._getframe(FRAMES).f_code.co_name))
    sys.audit("test.frame")
    assert found == ["test_a_listener_finds_the_frame_of_what_caused_an_event"]
