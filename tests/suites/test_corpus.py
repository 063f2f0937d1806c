"""Both engines say what plain pytest says about small projects in the styles that people use.

Here a few of them, of the kinds that are hardest; ``benchmarks/judged.py`` runs all.
"""

from __future__ import annotations

import os

import pytest

from .agreement import compare
from .corpus import PROJECTS, corpus

#: the hardest: act once and assert many, files that tests share, answers that are objects, ends other than
#: passed; the first of them is in the short run
HARDEST = ("returns_objects", "growing_log_file", "welding_module_fixture", "strict_xfail_limits")
#: mutants of each, drawn by a fixed seed
MUTANTS = 3


@pytest.mark.parametrize(
    "name", [HARDEST[0], *(pytest.param(suite, marks=pytest.mark.whole) for suite in HARDEST[1:])]
)
def test_every_verdict_is_that_of_plain_pytest(name: str) -> None:
    found = compare(PROJECTS / name, only={"robot": MUTANTS}, jobs=len(os.sched_getaffinity(0)))
    assert found.disagreements == []
    assert len(found.compared) >= 2 * MUTANTS - 2  # by two engines; the judge may not know how to write one
    assert "fails" in {verdict.plain.state for verdict in found.compared}


@pytest.mark.whole
@pytest.mark.needs("catalogue")
def test_every_verdict_on_the_catalogue_is_that_of_plain_pytest() -> None:
    found = compare(
        PROJECTS / "fault_catalogue", families=("catalogue",), only={"catalogue": 2 * MUTANTS},
        jobs=len(os.sched_getaffinity(0)),
    )  # fmt: skip
    assert found.disagreements == []
    assert len(found.compared) >= 2 * MUTANTS


def test_the_corpus_has_at_least_forty_projects_that_can_be_read() -> None:
    folders = corpus()
    assert len(folders) >= 40
    assert {*HARDEST} <= {folder.name for folder in folders}
    for folder in folders:
        assert list(folder.rglob("test_*.py")) or list(folder.rglob("*.txt"))
