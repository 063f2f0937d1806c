"""The referee of changes of the code finds every kind of difference between two records."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

import same_results
import witness

RECORD: dict[str, Any] = {
    "plan": [["a", "skip"], ["b", "reverse"]],
    "left_out": [["c", "it changes nothing"]],
    "outcomes": {
        "a [1]": {"verdict": "killed", "test": "tests/test_it.py::test_a", "hits": 1},
        "b [1]": {"verdict": "survived", "test": None, "hits": 3},
    },
}


def changed(**parts: Any) -> dict[str, Any]:
    return copy.deepcopy(RECORD) | parts


def outcomes(**changes: Any) -> dict[str, Any]:
    found = copy.deepcopy(RECORD["outcomes"])
    found["a [1]"] |= changes
    return {"outcomes": found}


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (changed(plan=[["a", "skip"]]), "plan: b is gone"),
        (changed(plan=[*RECORD["plan"], ["d", "noise"]]), "plan: d is new"),
        (changed(plan=RECORD["plan"][::-1]), "plan: the order differs"),
        (changed(plan=[["a", "skip"], ["b", "repeat"]]), "plan: b: 'reverse' → 'repeat'"),
        (changed(left_out=[]), "left_out: c is gone"),
        (changed(outcomes={}), "a [1]: was run and is not"),
        (changed(**outcomes(verdict="survived")), "a [1]: verdict 'killed' → 'survived'"),
        (changed(**outcomes(hits=2)), "a [1]: hits 1 → 2"),
        (changed(**outcomes(test="tests/test_it.py::test_b")), "a [1]: test "),
    ],
)
def test_a_planted_difference_is_found(other: dict[str, Any], said: str) -> None:
    found = list(same_results.differences(RECORD, other))
    assert any(line.startswith(said) for line in found), found


def test_equal_records_do_not_differ(tmp_path: Path) -> None:
    witness.write(tmp_path / "a.json.gz", RECORD)
    assert list(same_results.differences(RECORD, witness.read(tmp_path / "a.json.gz"))) == []


def test_what_differs_between_equal_runs_is_not_recorded() -> None:
    first = witness.told(["at 0x7f33aabbcc, in /home/a/demo/x.py", "/tmp/tmpab12/f"], "/home/a/demo")
    second = witness.told(["at 0x7f00aabbcc, in /root/demo/x.py", "/tmp/tmpcd34/f"], "/root/demo")
    assert first == second


def test_mutants_are_drawn_by_their_ids_alone() -> None:
    mutants = [{"id": f"m{number}", "family": "conventional"} for number in range(50)]
    few = witness.drawn(mutants, {"conventional": 5})
    assert len(few) == 5
    assert set(few) <= set(
        witness.drawn([*mutants, {"id": "new", "family": "conventional"}], {"conventional": 6})
    )
    assert witness.drawn(mutants, {"robot": 5}) == []
