"""``--operators common`` keeps the mutants of operators that are common, under their own numbers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot_source.registry import load_all
from tests.plugins.test_faults import write

PROJECT = {
    "mutabot.toml": """
        program = ["prog.py"]
        tests = ["test_prog.py"]
        families = ["conventional"]
        """,
    "prog.py": """
        def reach(a, b):
            return a + b
        """,
    "test_prog.py": """
        import prog

        def test_reach():
            assert prog.reach(1, 2) == 3
        """,
}


def listed(folder: Path, capsys: pytest.CaptureFixture[str], *words: str) -> dict[int, str]:
    """The operators of the mutants that a run would have, by the mutants' numbers."""
    assert main(["-C", str(folder), "list", "--json", *words]) == 0
    return {mutant["number"]: mutant["operator"] for mutant in json.loads(capsys.readouterr().out)["mutants"]}


def test_only_mutants_of_common_operators_are_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write(tmp_path, PROJECT)
    common = {rule.name for rule in load_all() if rule.is_common}
    everything, kept = listed(folder, capsys), listed(folder, capsys, "--operators", "common")
    assert {"ABS", "AOR"} <= set(everything.values())
    assert kept == {number: name for number, name in everything.items() if name in common}
    assert "AOR" in kept.values()
