"""Exit codes: one list of them, and the page for users says the same."""

from __future__ import annotations

import re
from pathlib import Path

from mutabot import errors
from mutabot.errors import ExitCode

PAGE = Path(__file__).parents[2] / "docs" / "verdicts.md"
_ROW = re.compile(r"^\| (\d+) \| (.*) \|$", re.MULTILINE)


def test_the_page_for_users_says_what_each_number_means() -> None:
    section = PAGE.read_text(encoding="utf-8").partition("## Exit codes")[2].partition("\n## ")[0]
    assert _ROW.findall(section) == [(str(int(code)), code.meaning) for code in ExitCode]


def test_every_error_ends_the_command_with_one_of_these_numbers() -> None:
    kinds = [kind for kind in vars(errors).values() if isinstance(kind, type)]
    raised = [kind for kind in kinds if issubclass(kind, errors.MutabotError)]
    assert len(raised) > 10
    assert {type(kind.exit_code) for kind in raised} == {ExitCode}


def test_the_tree_of_errors_names_the_numbers_as_they_are() -> None:
    told = re.findall(r"[├└]── (\w+) .*\(exit (\d+)\)$", errors.__doc__ or "", re.MULTILINE)
    assert len(told) > 5
    assert [(name, int(code)) for name, code in told] == [
        (name, int(getattr(errors, name).exit_code)) for name, _ in told
    ]
