"""Ordinary Python with all alternatives in it passes its own tests; benchmarks/stdlib_corpus.py has more."""

from __future__ import annotations

import importlib.util
import runpy
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[3] / "benchmarks" / "stdlib_corpus.py"

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("test.test_textwrap") is None, reason="this Python came without its tests"
)


#: what takes longer
SLOW = [
    pytest.param(name, marks=pytest.mark.whole)
    for name in ("fractions", "heapq", "dataclasses", "contextlib", "shlex")
]


@pytest.mark.parametrize("record", [False, True], ids=["alternatives", "recording"])
@pytest.mark.parametrize("module", ["textwrap", *SLOW])
def test_a_module_of_the_standard_library_passes_its_own_tests(module: str, record: bool) -> None:
    assert runpy.run_path(str(SCRIPT))["compare"](module, record=record)
