"""What the controller costs is measured by a program that plays workers: it keeps up with the executors."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "controller.py"


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")  # the paper's tests need one
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_a_thousand_mutants_are_judged_and_written(engine: str) -> None:
    words = ["--engine", engine, "--mutants", "1000", "--sample", "2", "--json"]
    done = subprocess.run([sys.executable, BENCHMARK, *words], capture_output=True, text=True, check=False)
    found = json.loads(done.stdout)
    assert found["mutants"] == 1000
    assert found["real_verdicts"] == 2
    assert found["cpu_seconds"] > 0
