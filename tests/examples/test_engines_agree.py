"""Both engines find the same: the differential command itself, and its smallest example in full."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from mutabot.model import By, Outcome, Verdict

COMMAND = Path(__file__).parents[2] / "benchmarks" / "differential.py"
KILLED = Outcome("a:b:c#1:x:reverse", 0, Verdict.KILLED, By.CHECK, "test_a", message="assert 1 == 2", tests=1)


@pytest.fixture(scope="module")
def differential() -> ModuleType:
    """The command as a module."""
    spec = importlib.util.spec_from_file_location("differential", COMMAND)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.whole
def test_every_mutant_of_scales_ends_the_same_in_both_engines() -> None:
    words = [sys.executable, str(COMMAND), "--examples", "scales", "--rounds", "1", "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (row,) = json.loads(done.stdout)
    assert row["disagreements"] == []
    assert row["mutants"] == row["mutant_rounds"] == 19
    assert row["outcomes"] > row["mutants"]
    assert row["fallen_back"] == 0


@pytest.mark.parametrize(
    ("fact", "value"),
    [("verdict", Verdict.SURVIVED), ("by", By.EXCEPTION), ("test", "test_b"), ("message", "assert 1 == 3"),
     ("acted", 2), ("tests", 2), ("divergence", ("box: 1 instead of 2",))],
)  # fmt: skip
def test_each_fact_that_differs_is_a_disagreement(differential: ModuleType, fact: str, value: object) -> None:
    key = (KILLED.mutant, KILLED.round)
    other = replace(KILLED, **{fact: value})
    found = differential.disagreements({key: KILLED}, {key: other})
    assert [disagreement.fact for disagreement in found] == [fact]


def test_what_an_outcome_cost_is_no_disagreement(differential: ModuleType) -> None:
    key = (KILLED.mutant, KILLED.round)
    other = replace(KILLED, wall=1.0, cpu=2.0, shared=3.0, engine="fork")
    assert differential.disagreements({key: KILLED}, {key: other}) == []


def test_an_outcome_that_only_one_engine_has_is_a_disagreement(differential: ModuleType) -> None:
    key = (KILLED.mutant, KILLED.round)
    found = differential.disagreements({key: KILLED}, {})
    assert {"verdict": ("killed", "no outcome")}.items() <= {
        disagreement.fact: (disagreement.fork, disagreement.replay) for disagreement in found
    }.items()
