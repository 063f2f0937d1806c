"""Progress: a bar on a terminal, now and then a plain line elsewhere."""

from __future__ import annotations

import io
import re

import pytest
from rich.cells import cell_len
from rich.console import Console

from mutabot.report.terminal.console import Bar, Lines, make_console, make_progress

_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[a-zA-Z]")


def test_a_pipe_gets_the_beginning_and_the_end_of_a_stage_and_little_between() -> None:
    out = io.StringIO()
    with Lines(make_console(out, width=80), every=60.0) as progress:
        progress.stage("mutants", 100)
        for number in range(100):
            progress.advance(f"#{number} survived")
        progress.note("something to know")
    assert out.getvalue().splitlines() == [
        "mutants: 100",
        "mutants 100/100, took 0 s (#99 survived)",
        "something to know",
    ]


def test_a_pipe_is_told_the_time_left() -> None:
    out = io.StringIO()
    with Lines(make_console(out), every=0.0) as progress:
        progress.stage("mutants", 2)
        progress.advance()
    assert "mutants 1/2, 0 s left" in out.getvalue()


def test_the_time_left_is_not_guessed_from_the_first_few() -> None:
    out = io.StringIO()
    with Lines(make_console(out), every=0.0) as progress:
        progress.stage("mutants", 100)
        for _ in range(10):
            progress.advance()
    *first, last = out.getvalue().splitlines()[1:]
    assert not any("left" in line for line in first)
    assert last == "mutants 10/100, 0 s left"


def test_a_stage_of_unknown_length_only_counts() -> None:
    out = io.StringIO()
    with Lines(make_console(out), every=0.0) as progress:
        progress.stage("baseline")
        progress.advance("round 1")
    assert out.getvalue().splitlines() == ["baseline", "baseline 1 (round 1)"]


def test_a_terminal_gets_a_bar() -> None:
    out = io.StringIO()
    console = Console(file=out, force_terminal=True, width=100)
    progress = make_progress(console)
    assert isinstance(progress, Bar)
    with progress:
        progress.stage("baseline")
        progress.stage("mutants", 2)
        progress.advance("[bold]#1[/bold] killed")
        progress.note("a note")
        progress.advance()
    assert "mutants" in out.getvalue()
    assert "2/2" in out.getvalue()
    assert "a note" in out.getvalue()


@pytest.mark.parametrize("width", [50, 60, 80, 120, 200])
def test_every_stage_is_one_line_with_a_whole_bar_count_and_time(width: int) -> None:
    out = io.StringIO()
    with Bar(Console(file=out, force_terminal=True, width=width)) as progress:
        progress.stage("a stage with a rather long name, as some of them have", 100)
        for _ in range(100):
            progress.advance("#123 mission.py:33 reverse arm.move_by: killed\nby a check in a test")
    last = [line for line in _ESCAPES.sub("", out.getvalue()).splitlines() if line.strip()][-1]
    assert cell_len(last) <= width - 3  # a ^C has its place there
    assert last.count("━") >= 10
    assert "100/100" in last
    assert re.search(r"0:00:\d\d", last)
    assert "killed" not in last  # what was told of the last step does not stay


def test_what_is_told_beside_the_bar_never_takes_a_second_line() -> None:
    out = io.StringIO()
    with Bar(Console(file=out, force_terminal=True, width=60)) as progress:
        progress.stage("mutants", 2)
        progress.advance("a line that is much longer than the terminal is wide " * 3)
        progress._progress.refresh()
        shown = out.getvalue()
    assert "\x1b[1A" not in shown  # nothing moves up: there is one line
