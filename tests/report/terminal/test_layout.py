"""Lines on the terminal: no blanks at their ends, and breaks at the joints of names."""

from __future__ import annotations

import io

import pytest

from mutabot.model import LeftOut
from mutabot.model.left_out import NOTHING
from mutabot.report.sections import Section, skipped
from mutabot.report.terminal.console import Breakable, make_console, print_section

NAME = "tests/test_cell.py::test_the_box_goes_from_the_conveyor_to_the_target"


def printed(width: int) -> str:
    out = io.StringIO()
    console = make_console(out, width=width)
    section = Section("Title", (">no.", "*fault", "*effect", ">of"), [("1", NAME, "little", "2")], [NAME])
    print_section(console, section)
    return out.getvalue()


def test_a_table_of_short_columns_breaks_between_words_where_there_is_too_little_room() -> None:
    out = io.StringIO()
    names = ("family · role", ">mutants", ">check score", ">accepted")
    section = Section("Scores", names, [("robot · program", "37", "30.6 %", "1")])
    print_section(make_console(out, width=40), section)
    words = set(out.getvalue().split())
    assert {"family", "role", "mutants", "check", "score", "accepted", "program", "30.6"} <= words


@pytest.mark.parametrize("width", [30, 40, 80, 200])
def test_no_line_ends_in_blanks(width: int) -> None:
    lines = printed(width).splitlines()
    assert len(lines) > 4
    assert [line for line in lines if line != line.rstrip()] == []


@pytest.mark.parametrize("width", [40, 50, 60, 80])
def test_a_name_that_is_too_long_breaks_behind_a_sign_that_joins_its_parts(width: int) -> None:
    parts = Breakable(NAME).wrap(make_console(width=width), width)
    assert "".join(part.plain for part in parts) == NAME
    assert all(part.plain[-1] in "_/.:" for part in parts[:-1])


def test_a_part_that_is_longer_than_the_line_is_cut_and_nothing_of_it_is_lost() -> None:
    text = Breakable("x" * 25 + "_y")
    assert (
        "".join(part.plain for part in text.wrap(make_console(width=10), 10, overflow="fold")) == text.plain
    )


def test_short_words_stay_whole() -> None:
    parts = Breakable("reads tracker.robot_position here").wrap(make_console(width=24), 24)
    assert [part.plain.strip() for part in parts] == ["reads", "tracker.robot_position", "here"]


def test_mutants_of_one_kind_of_reason_that_are_left_out_take_one_line() -> None:
    left_out = [LeftOut(f"a{calls}", "x", f"{NOTHING} in any of {calls} calls") for calls in range(5)]
    (section,) = skipped([*left_out])
    assert section.title == f"5 mutants left out that {NOTHING}"


def test_what_lists_each_mutant_that_is_left_out_is_said_once_and_not_above_that_list() -> None:
    left_out = [LeftOut("a", "x", f"{NOTHING} in any of 3 calls"), LeftOut("b", "x", "it is always 0")]
    assert [bool(section.lines) for section in skipped(left_out)] == [False, True]
    assert [bool(section.lines) for section in skipped(left_out, are_listed=True)] == [False, False]


def test_rows_that_are_left_out_are_counted_below_the_rows_and_lines_below_the_lines() -> None:
    out = io.StringIO()
    section = Section("Title", ("no.",), [(str(row),) for row in range(5)], ["first line", "second", "third"])
    print_section(make_console(out, width=80), section, 2)
    told = [line.strip() for line in out.getvalue().splitlines() if line.strip()]
    assert told == ["Title", "no.", "───", "0", "1", "and 3 more", "first line", "second", "and 1 more"]
