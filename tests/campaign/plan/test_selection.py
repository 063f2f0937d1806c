"""Selecting mutants: what words mean, and that a typing mistake never selects nothing in silence."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.errors import SelectionError
from mutabot.faults import brought_providers
from mutabot.model.mutant_pattern import is_like
from mutabot.model.selection import select
from mutabot.operators import registry
from tests.results.samples import BY_TO, LEFT_OUT, MUTANTS, NEGATE, NOISE, REVERSE, SKIP


@pytest.mark.parametrize(
    ("word", "chosen"),
    [
        (REVERSE.id, [REVERSE]),
        ("3", [BY_TO]),
        ("skip", [SKIP]),
        ("robot", list(MUTANTS)),
        ("oracle", [NEGATE, NOISE]),
        ("mission.py", [REVERSE, SKIP, BY_TO]),
        ("*.py", list(MUTANTS)),
        ("tests", [NEGATE, NOISE]),
        ("tests/", [NEGATE, NOISE]),
        ("mission.py:*:reverse", [REVERSE]),
        ("2-4", [SKIP, BY_TO, NEGATE]),
        ("1,4-5", [REVERSE, NEGATE, NOISE]),
        ("mission.py:3", [REVERSE]),
        ("mission.py:3-9", [REVERSE, BY_TO]),
        ("tests/sensors.py:2", [NEGATE, NOISE]),
        ("sensors.py:2", [NEGATE, NOISE]),
        ("*.py:2", [SKIP, NEGATE, NOISE]),
        ("mission.py:?", [REVERSE, SKIP, BY_TO]),
        ("mission.py:3*", [REVERSE]),
    ],
)
def test_only_and_skip_take_ids_numbers_names_and_globs(word: str, chosen: list[object]) -> None:
    assert select(MUTANTS, [word]) == chosen
    assert select(MUTANTS, (), [word]) == [mutant for mutant in MUTANTS if mutant not in chosen]


def test_only_adds_up_and_skip_takes_away() -> None:
    assert select(MUTANTS, ["mission.py", "noise"], ["by-to"]) == [REVERSE, SKIP, NOISE]


def test_words_may_come_from_an_iterator() -> None:
    assert select(MUTANTS, iter(["1"]), iter([])) == [REVERSE]


@pytest.mark.parametrize("word", ["6-9", "4-3", "mission.py:40", "ission.py:3"])
def test_a_range_or_line_without_a_mutant_is_an_error(word: str) -> None:
    with pytest.raises(SelectionError, match=re.escape(repr(word))):
        select(MUTANTS, [word])


@pytest.mark.parametrize("option", ["only", "skip"])
def test_a_word_that_fits_nothing_names_the_nearest_that_does(option: str) -> None:
    with pytest.raises(SelectionError, match=f"--{option}.*'revers'.*'reverse'"):
        select(MUTANTS, **{option: ["revers"]})


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("gripper,conveyor", "give --only once for each name"),
        ("qqq[ab]", r"only \* and \? are wildcards"),
        ("qqq{a}", r"only \* and \? are wildcards"),
        ("qqq", "`mutabot list` shows what there is"),
    ],
)
def test_a_word_that_is_like_nothing_is_answered_with_how_words_are_written(word: str, hint: str) -> None:
    with pytest.raises(SelectionError, match=hint):
        select(MUTANTS, [word])


def test_a_selection_file_chooses_mutants_which_keep_their_numbers(tmp_path: Path) -> None:
    file = tmp_path / "published.txt"
    file.write_text(f"# the published ones\n\n{NEGATE.id}   # no. 1\nmission.py:*:skip\n{NEGATE.id}\n")
    assert select(MUTANTS, [f"@{file}"]) == [SKIP, NEGATE]
    assert select(MUTANTS, [f"@{file}"], [str(SKIP.number)]) == [NEGATE]


def test_a_selection_file_with_an_unknown_id_names_the_nearest(tmp_path: Path) -> None:
    file = tmp_path / "published.txt"
    file.write_text(f"{REVERSE.id}\n{SKIP.id}x\nnowhere.py:f\n")
    with pytest.raises(SelectionError) as error:
        select(MUTANTS, [f"@{file}"])
    assert "'nowhere.py:f'" in str(error.value)
    assert repr(SKIP.id) in str(error.value)
    assert str(file) in str(error.value)


def test_a_selection_file_may_name_what_the_plan_leaves_out(tmp_path: Path) -> None:
    file = tmp_path / "published.txt"
    file.write_text(f"{LEFT_OUT[0].id}\n{SKIP.id}\n")
    assert [chosen.id for chosen in select(MUTANTS, [f"@{file}"], left_out=LEFT_OUT)] == [SKIP.id]


@pytest.mark.parametrize("content", [None, b"\xff\xfe"])
def test_a_selection_file_that_cannot_be_read_is_a_usage_error(tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "published.txt"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(SelectionError, match="cannot read the selection file"):
        select(MUTANTS, [f"@{file}"])


def test_brackets_in_ids_are_just_brackets() -> None:
    assert is_like("a.py:f:read#1:[0].x:*", "a.py:f:read#1:[0].x:negate")
    assert not is_like("a.py:[ab]", "a.py:a")


@pytest.mark.parametrize(
    ("pattern", "text", "fits"),
    [
        ("*", "", True),
        ("**", "a", True),
        ("a*", "a", True),
        ("a*a", "a", False),
        ("a*b*c", "a-b-b-c", True),
        ("a*b*c", "a-c-b", False),
        ("?*?", "ab", True),
        ("?*?", "a", False),
        ("*?b?*", "xabc", True),
        ("*?b?*", "bxb", False),
        ("a*b", "a\nb", True),
        ("*.py", "a.py", True),
        ("*.py", "a_py", False),
        ("a?c", "abc", True),
        ("a?c", "ac", False),
    ],
)
def test_stars_stand_for_any_text_and_question_marks_for_one_sign(
    pattern: str, text: str, fits: bool
) -> None:
    assert is_like(pattern, text) is fits


@pytest.mark.parametrize("pattern", ["*" * 3000 + "x", "*a" * 3000 + "*b", "?*" * 3000 + "x", "*?a" * 1000])
def test_no_pattern_takes_long(pattern: str) -> None:
    """One that tries all ways to share a text among its stars never ends."""
    assert not is_like(pattern, "a" * 1000)


OPERATORS = [
    *(("robot", name) for name in registry.names()),
    *((rule.family, rule.name) for provider in brought_providers() for rule in provider.rules()),
]


@pytest.mark.needs("source")
def test_operators_of_all_families_can_be_chosen_by_name() -> None:
    mutants = [
        replace(REVERSE, number=number, family=family, operator=name, quantity=f"q{number}")
        for number, (family, name) in enumerate(OPERATORS, start=1)
    ]
    assert len({name for _, name in OPERATORS}) == len(OPERATORS) > 15
    for mutant in mutants:
        assert select(mutants, [mutant.operator]) == [mutant]
        assert mutant not in select(mutants, (), [mutant.operator])
    for family in ("robot", "conventional", "text"):
        assert select(mutants, [family]) == [candidate for candidate in mutants if candidate.family == family]
