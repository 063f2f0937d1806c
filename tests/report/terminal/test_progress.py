"""Progress: a bar on a terminal, now and then a plain line elsewhere."""

from __future__ import annotations

import io
import re
import time
from dataclasses import replace
from typing import Any

import pytest
from rich.cells import cell_len
from rich.console import Console

from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.mutant_end import MutantEnd
from mutabot.model.suppression import Acceptance
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.progress import Bar, Lines, Pace, clock_text, make_progress
from results import samples

_ESCAPES = re.compile(r"\x1b\[[0-9;?]*[a-zA-Z]")


def without_times(text: str) -> list[str]:
    """The lines, with 0:00 for each time: how long a busy machine takes is no matter."""
    return re.sub(r"\d+:\d\d", "0:00", text).splitlines()


def test_a_pipe_gets_the_beginning_and_the_end_of_a_stage_and_little_between() -> None:
    out = io.StringIO()
    with Lines(make_console(out, width=80), every=60.0) as progress:
        progress.stage("mutants", 100)
        for number in range(100):
            progress.advance(f"#{number} survived")
        progress.note("something to know")
    assert without_times(out.getvalue()) == [
        "mutants 0/100",
        "mutants 100/100: took 0:00 (#99 survived)",
        "something to know",
    ]


def test_a_pipe_gets_the_time_left() -> None:
    out = io.StringIO()
    progress = Lines(make_console(out), every=0.0)
    progress.stage("mutants", 2)
    progress.advance()
    assert "mutants 1/2: 0:00 elapsed, 0:00 left" in without_times(out.getvalue())


def test_the_time_left_is_not_guessed_from_the_first_few() -> None:
    out = io.StringIO()
    progress = Lines(make_console(out), every=0.0)
    progress.stage("mutants", 100)
    for _ in range(10):
        progress.advance()
    *first, last = without_times(out.getvalue())[1:]
    assert not any("left" in line for line in first)
    assert last == "mutants 10/100: 0:00 elapsed, 0:00 left"


def test_a_stage_of_unknown_length_only_counts() -> None:
    out = io.StringIO()
    progress = Lines(make_console(out), every=0.0)
    progress.stage("baseline")
    progress.advance("round 1")
    assert without_times(out.getvalue()) == ["baseline", "baseline 1: 0:00 elapsed (round 1)"]


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
def test_every_stage_is_one_line_with_count_and_time_and_with_a_bar_where_there_is_room(width: int) -> None:
    out = io.StringIO()
    with Bar(Console(file=out, force_terminal=True, width=width)) as progress:
        progress.stage("a stage with a rather long name, as some of them have", 100)
        for _ in range(100):
            progress.advance("#123 mission.py:33 reverse arm.move_by: killed\nby a check in a test")
    last = [line for line in _ESCAPES.sub("", out.getvalue()).splitlines() if line.strip()][-1]
    assert cell_len(last) <= width - 3  # a ^C has its place there
    assert last.count("━") >= 10 or width < 70
    assert "100/100" in last
    assert re.search(r"took 0:\d\d", last)
    assert "killed" not in last  # what was told of the last step does not stay


def test_what_is_printed_beside_the_bar_never_takes_a_second_line() -> None:
    out = io.StringIO()
    with Bar(Console(file=out, force_terminal=True, width=60)) as progress:
        progress.stage("mutants", 2)
        progress.advance("a line that is much longer than the terminal is wide " * 3)
        progress._progress.refresh()
        shown = out.getvalue()
    assert "\x1b[1A" not in shown  # nothing moves up: there is one line


def end(mutant: Mutant, verdict: Verdict, round: int = 0, **changes: Any) -> MutantEnd:
    return MutantEnd(mutant, Outcome(mutant.id, round, verdict), **changes)


def told(*ends: MutantEnd) -> list[str]:
    out = io.StringIO()
    with Lines(make_console(out, width=80), every=60.0) as progress:
        progress.stage("mutants", len(ends))
        for outcome in ends:
            progress.mutant_ended(outcome)
            progress.advance()
    return without_times(out.getvalue())[1:]


def test_survivors_are_printed_as_they_are_found_and_once() -> None:
    first, second, last = told(
        end(samples.SKIP, Verdict.SURVIVED), end(samples.REVERSE, Verdict.KILLED),
        end(samples.SKIP, Verdict.SURVIVED, 1), end(samples.BY_TO, Verdict.NOT_COVERED),
    )  # fmt: skip
    assert first == "survived: 2 mission.py:2 skip: gripper.command: do nothing (round 1)"
    assert second == f"not covered: mission.py:4 {samples.BY_TO.site.text}: no test reaches it (round 1)"
    assert last == "mutants 4/4: took 0:00 (killed 1, survived 2, not covered 1)"


def test_mutants_of_one_place_that_no_test_reaches_are_reported_together() -> None:
    other = replace(samples.BY_TO, operator="skip")
    lines = told(end(samples.BY_TO, Verdict.NOT_COVERED), end(other, Verdict.NOT_COVERED))
    assert [line.partition(":")[0] for line in lines] == ["not covered", "mutants 2/2"]
    assert lines[-1].endswith("(not covered 2)")


def test_no_time_is_promised_while_no_step_is_done() -> None:
    now = 0.0
    pace = Pace(10, lambda: now)
    pace.advance()
    now = 4.0
    assert pace.left == 36.0
    now = 6.0
    assert pace.left is None
    now = 100.0
    pace.advance()
    assert pace.left == 400.0


def test_how_long_a_stage_took_does_not_grow_after_its_last_step() -> None:
    now = 0.0
    pace = Pace(1, lambda: now)
    now = 5.0
    pace.advance()
    now = 60.0
    assert (pace.text, pace.idle) == ("took 0:05", 55.0)


def test_a_sign_of_life_after_a_stage_says_how_long_ago_it_ended() -> None:
    out = io.StringIO()
    with Lines(make_console(out, width=80), every=0.01) as progress:
        progress.stage("baseline", 1)
        progress.advance()
        while "ago" not in out.getvalue():
            time.sleep(0.01)
    *_, last = without_times(out.getvalue())
    assert last == "baseline 1/1: took 0:00, 0:00 ago"


def test_accepted_survivors_and_those_of_earlier_campaigns_are_only_counted() -> None:
    accepted = end(samples.SKIP, Verdict.SURVIVED, acceptance=Acceptance("why", "a.toml:1"))
    reused = end(samples.NEGATE, Verdict.SURVIVED, is_reused=True)
    again = end(samples.NEGATE, Verdict.SURVIVED, 1)
    assert told(accepted, reused, again) == ["mutants 3/3: took 0:00 (survived 2, accepted 1)"]


def test_a_survivor_that_a_second_look_takes_back_is_named_and_counted_anew() -> None:
    first, second, last = told(end(samples.SKIP, Verdict.SURVIVED), end(samples.SKIP, Verdict.UNSTABLE))
    assert (first.partition(":")[0], second.partition(":")[0]) == ("survived", "unstable")
    assert last.endswith("(unstable 1)")


def test_a_stage_in_which_no_mutant_ends_shows_no_counts_of_the_one_before() -> None:
    out = io.StringIO()
    with Lines(make_console(out)) as progress:
        progress.stage("mutants", 1)
        progress.mutant_ended(end(samples.SKIP, Verdict.KILLED))
        progress.advance()
        progress.stage("proof", 1)
        progress.advance("round 3")
    assert without_times(out.getvalue())[1::2] == [
        "mutants 1/1: took 0:00 (killed 1)", "proof 1/1: took 0:00 (round 3)",
    ]  # fmt: skip


def test_a_bar_shows_the_counts_and_prints_survivors_above() -> None:
    out = io.StringIO()
    with Bar(Console(file=out, force_terminal=True, width=120)) as progress:
        progress.stage("mutants", 2)
        progress.mutant_ended(end(samples.SKIP, Verdict.SURVIVED))
        progress.advance("#2 round 1: survived")
        progress._progress.refresh()
    text = _ESCAPES.sub("", out.getvalue())
    assert "survived: 2 mission.py:2 skip" in text
    assert "1/2" in text
    assert "survived 1" in text


def test_a_pipe_hears_something_while_nothing_ends() -> None:
    out = io.StringIO()
    with Lines(make_console(out), every=0.02) as progress:
        progress.stage("mutants", 5)
        until = time.monotonic() + 20.0
        while "elapsed" not in out.getvalue() and time.monotonic() < until:
            time.sleep(0.01)
    assert re.match(r"mutants 0/5: 0:\d\d elapsed$", out.getvalue().splitlines()[1])


@pytest.mark.parametrize(("seconds", "text"), [(8.2, "0:08"), (125, "2:05"), (3723, "1:02:03")])
def test_times_are_written_as_clocks_show_them(seconds: float, text: str) -> None:
    assert clock_text(seconds) == text
