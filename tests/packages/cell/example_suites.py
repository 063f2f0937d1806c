"""Runs the suites of the projects in ``examples``, on programs as they are and after an edit by hand."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

EXAMPLES = Path(__file__).parents[3] / "examples"
STRENGTHS = ("weak", "medium", "strong")


def run_suite(project: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run an example's tests on its program as it stands in a copy."""
    return subprocess.run(
        [sys.executable, "-B", "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *words],
        cwd=project,
        env=os.environ | {"MUTABOT_SEED": "7"},
        capture_output=True,
        text=True,
        check=False,
    )


def noticing(project: Path, file: str, before: str, after: str) -> tuple[str, ...]:
    """Return which of the three suites notice that a text in a file of the copy is another one."""
    program = project / file
    text = program.read_text(encoding="utf-8")
    assert text.count(before) == 1
    program.write_text(text.replace(before, after), encoding="utf-8")
    return tuple(name for name in STRENGTHS if run_suite(project, f"tests/{name}").returncode)
