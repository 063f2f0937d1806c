"""The recipes of the documentation hold whole projects; ``make foreign`` runs them."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ROOT / "docs" / "recipes"


def load_benchmark() -> ModuleType:
    spec = importlib.util.spec_from_file_location("foreign", ROOT / "benchmarks" / "foreign_programs.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


FOREIGN = load_benchmark()


@pytest.mark.parametrize("name", FOREIGN.RECIPES)
def test_every_recipe_is_a_project_with_tests(name: str) -> None:
    files = FOREIGN.files_of(PAGES / f"{name}.md")
    assert FOREIGN.RECIPES[name]["program"] in files
    assert any(Path(file).name.startswith("test_") for file in files)
    for file, text in files.items():
        compile(text, file, "exec")


@pytest.mark.parametrize("name", FOREIGN.RECIPES)
def test_every_mutant_made_by_hand_changes_the_program_and_leaves_it_one(name: str) -> None:
    recipe = FOREIGN.RECIPES[name]
    text = FOREIGN.files_of(PAGES / f"{name}.md")[recipe["program"]]
    for edit in recipe["edit"]:
        assert any(edit["line"] in line for line in text.splitlines()), edit
        edited = text.replace(edit["old"], edit["new"], 1)
        assert edited != text, edit
        compile(edited, name, "exec")
