"""The page about tasks is generated from campaigns that were run, and says what these found."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import tasks as tool
from comparison.across import (
    alone,
    is_ordered,
    mean_over_tasks,
    operator_scores,
    rank_correlation,
    scores,
)
from comparison.ends import End
from comparison.tasks_page import LEAST, ORDER, mutants_of, page
from mutabot.model import By, Kill, Outcome, Verdict
from mutabot.results.results import MutantResult

DATA = Path(__file__).parents[2] / "docs" / "data" / "tasks"


def mutant(*noticed: str | None, operator: str = "skip", end: End = End.CHECK) -> dict[str, Any]:
    """A mutant that these suites notice, one in each round."""
    ends = [end.value if name is not None or end is End.REFUSED else End.SURVIVED.value for name in noticed]
    return {"operator": operator, "place": "a.py:1", "fault": "", "ends": ends, "noticed": [*noticed]}


def test_the_page_is_what_its_data_say() -> None:
    assert tool.main(["--check"]) == 0


def test_a_page_that_differs_from_its_data_is_noticed(tmp_path: Path) -> None:
    kept = tmp_path / "data" / "tasks"
    kept.mkdir(parents=True)
    (kept / "paper.json").write_bytes((DATA / "paper.json").read_bytes())
    assert tool.main(["--check"], tmp_path) == 1
    assert tool.main([], tmp_path) == 0
    assert tool.main(["--check"], tmp_path) == 0
    (tmp_path / "tasks.md").write_text("# Something else\n")
    assert tool.main(["--check"], tmp_path) == 1


def test_what_is_kept_of_a_task_is_of_complete_campaigns_with_an_end_in_each_round() -> None:
    kept = tool.load(DATA)
    assert kept
    for name, task in kept.items():
        for family, campaign in task["campaigns"].items():
            assert campaign["state"] == "complete", (name, family)
            rounds = campaign["meta"]["rounds"]
            assert {len(candidate["ends"]) for candidate in campaign["mutants"]} == {rounds}, (name, family)
            assert {len(candidate["noticed"]) for candidate in campaign["mutants"]} == {rounds}, (
                name,
                family,
            )


def test_a_suite_notices_what_the_weaker_ones_beside_it_do() -> None:
    those = [mutant("weak", "weak"), mutant("medium", "strong"), mutant("strong", None), mutant(None, None)]
    assert scores(those, "weak") == [(1, 4), (1, 4)]
    assert scores(those, "medium") == [(2, 4), (1, 4)]
    assert scores(those, "strong") == [(3, 4), (2, 4)]
    assert alone(those, "strong")[:2] == (2, 8)


def test_where_it_is_not_known_which_suite_notices_no_suite_counts_it_but_all_tests_do() -> None:
    those = [mutant("weak", "weak"), mutant("unknown", "unknown", end=End.TIMEOUT)]
    assert scores(those, "weak") == scores(those, "strong") == [(1, 1), (1, 1)]
    assert operator_scores(those, LEAST) == {"skip": 1.0}


@pytest.mark.parametrize(
    ("tests", "complete", "weakest"),
    [
        (["tests/strong/test_a.py::t", "tests/weak/test_a.py::t"], True, "weak"),
        (["tests/strong/test_a.py::t", "tests/medium/test_a.py::t"], True, "medium"),
        (["tests/medium/test_a.py::t"], False, "unknown"),
        (["tests/weak/test_a.py::t"], False, "weak"),
        (["tests/test_a.py::t"], False, "all"),
    ],
)
def test_the_weakest_suite_is_known_if_every_test_was_run(
    tests: list[str], complete: bool, weakest: str
) -> None:
    kills = tuple(Kill(test, By.CHECK, None, "no") for test in tests)
    outcome = Outcome("m", 0, Verdict.KILLED, test=tests[0], kills=kills, complete=complete)
    result = MutantResult(mutant=None, rounds=(outcome, None), quantity=None, why="")  # type: ignore[arg-type]
    assert tool.noticed(result) == [weakest, None]


def test_what_the_robot_refuses_is_outside_every_suites_score() -> None:
    those = [mutant("weak", "weak"), mutant(None, None, end=End.REFUSED)]
    assert scores(those, "strong") == [(1, 1), (1, 1)]


@pytest.mark.parametrize(
    ("rounds", "ordered"),
    [
        ([("weak", "medium", "strong")] * 2, True),
        ([("weak", "medium", "strong"), ("weak", "weak", "strong")], False),
    ],
)
def test_suites_are_ordered_only_if_each_round_says_so(rounds: Any, ordered: bool) -> None:
    assert is_ordered([mutant(*noticed) for noticed in zip(*rounds, strict=True)]) is ordered


def test_an_operator_has_a_score_from_enough_mutants_that_count() -> None:
    few = [mutant("weak", None)] * (LEAST - 1) + [mutant(None, None, end=End.REFUSED)]
    assert operator_scores(few, LEAST) == {}
    assert operator_scores([*few, mutant("all", "all")], LEAST) == {"skip": pytest.approx(0.75)}


def test_the_rank_correlation_is_spearmans() -> None:
    found = rank_correlation([1, 2, 3, 4, 5], [20, 10, 40, 30, 50])
    assert found is not None
    assert found[0] == pytest.approx(1 - 6 * 4 / (5 * 24))
    tied = rank_correlation([1, 1, 2], [1, 1, 2])
    assert tied is not None
    assert tied[0] == pytest.approx(1.0)
    assert rank_correlation([1, 1, 1], [1, 2, 3]) is None


def test_the_mean_over_tasks_has_students_interval() -> None:
    found = mean_over_tasks([0.1, 0.2, 0.3])
    assert found == pytest.approx((0.2, 0.2 - 4.303 * 0.1 / 3**0.5, 0.2 + 4.303 * 0.1 / 3**0.5))
    assert mean_over_tasks([0.1]) is None


def test_the_page_names_every_task_that_was_run_and_no_other() -> None:
    kept = tool.load(DATA)
    task = json.loads(json.dumps(kept["paper"]))
    text = page({"paper": task})
    assert "| paper |" in text
    others = [name for name in ORDER if name != "paper"]
    assert all(f"| {name} |" not in text for name in others)
    assert f"Not run: {', '.join(others)}." in text
    assert len(mutants_of(task)) == sum(len(campaign["mutants"]) for campaign in task["campaigns"].values())
