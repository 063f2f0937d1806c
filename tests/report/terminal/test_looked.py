"""``mutabot show`` --all`` tells which checks ran with a survivor, and of other mutants nothing."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest

from mutabot.journal.journal import Journal
from mutabot.model import Mutant
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from mutabot.results.results import find_mutant, read_results
from results import samples


def shown(folder: Path, mutant: Mutant, width: int = 120) -> str:
    with Journal.open(samples.write_journal(folder / "journal.sqlite")) as journal:
        result = find_mutant(read_results(journal), str(mutant.number))
    file = io.StringIO()
    print_mutant(make_console(file, width=width), result, samples.SENSORS, everything=True)
    return file.getvalue()


def test_each_check_is_told_with_its_values_and_its_margin(tmp_path: Path) -> None:
    text = shown(tmp_path, samples.NEGATE)
    assert "tests/test_box.py::test_arrives: 2 checks held, the nearest by 0.08" in text
    line = next(line for line in text.splitlines() if "test_box.py:7" in line)
    assert re.search(r"x == approx\(0.5, abs=0.1\) \(2 times\) +0.08 +0.48 == approx\(0.5\)", line)
    assert "box.colour == [red]" in text  # as it is, and no markup
    assert "tests/test_box.py::test_leaves: the mutant changed nothing in it" in text


@pytest.mark.parametrize("width", [40, 80, 200])
def test_no_line_is_longer_than_the_terminal(tmp_path: Path, width: int) -> None:
    assert all(len(line) <= width for line in shown(tmp_path, samples.NEGATE, width).splitlines())


def test_a_mutant_that_was_killed_has_no_such_section(tmp_path: Path) -> None:
    assert "Checks that ran" not in shown(tmp_path, samples.REVERSE)
