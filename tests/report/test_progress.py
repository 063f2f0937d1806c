"""Progress: a bar on a terminal, now and then a plain line elsewhere."""

from __future__ import annotations

import io

from rich.console import Console

from mutabot.report.console import make_console
from mutabot.report.progress import Bar, Lines, make_progress


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
