"""Imports that checks need stand where isort and ruff put them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot_suggest.imports import with_imports

FILE = '''"""Tests."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from pytest_bdd import given

import mission
from expected import HOME, Pose, is_within

X = math.pi
'''
OWN = {"expected", "mission", "sensors"}


@pytest.mark.parametrize(
    ("line", "before", "after"),
    [
        (
            "from expected import TABLE_TOP",
            "import HOME, Pose, is_within",
            "import HOME, TABLE_TOP, Pose, is_within",
        ),
        ("from expected import Box", "import HOME, Pose, is_within", "import HOME, Box, Pose, is_within"),
        (
            "from expected import height",
            "import HOME, Pose, is_within",
            "import HOME, Pose, height, is_within",
        ),
        ("from sensors import place", "Pose, is_within\n", "Pose, is_within\nfrom sensors import place\n"),
        ("import cell", "import pytest\n", "import cell\nimport pytest\n"),
        ("import os", "import math\n", "import math\nimport os\n"),
        ("from os import path", "Callable\n", "Callable\nfrom os import path\n"),
        ("import numpy", "import pytest\n", "import numpy\nimport pytest\n"),
        ("import sensors", "import mission\n", "import mission\nimport sensors\n"),
    ],
)
def test_an_import_stands_in_its_block_and_in_its_order(line: str, before: str, after: str) -> None:
    assert with_imports(FILE, [line], OWN) == FILE.replace(before, after, 1)


@pytest.mark.parametrize("line", ["import pytest", "from expected import HOME", "import math"])
def test_what_is_imported_already_is_not_imported_twice(line: str) -> None:
    assert with_imports(FILE, [line], OWN) == FILE


def test_an_import_over_several_lines_stays_one() -> None:
    names = "from robot import (\n    HOME,\n    move,\n)\n"
    wanted = "from robot import (\n    HOME,\n    Arm,\n    move,\n)\n"
    assert with_imports(names, ["from robot import Arm"]) == wanted


def test_names_in_another_order_keep_it() -> None:
    text = "from robot import arm, Box, cell\n"
    assert with_imports(text, ["from robot import Belt"]) == "from robot import arm, Belt, Box, cell\n"


def test_a_file_without_imports_gets_them_below_its_docstring() -> None:
    assert (
        with_imports('"""Text."""\n\nX = 1\n', ["import pytest"]) == '"""Text."""\n\nimport pytest\n\nX = 1\n'
    )
    assert with_imports("X = 1\n", ["import pytest"]) == "import pytest\n\nX = 1\n"


def test_ends_of_lines_stay() -> None:
    assert with_imports("import a\r\n\r\nX = 1\r\n", ["import b"]) == "import a\r\nimport b\r\n\r\nX = 1\r\n"


def test_ruff_has_nothing_to_change(tmp_path: Path) -> None:
    lines = [
        "from expected import world",
        "from expected import Box",
        "import os",
        "from sensors import place",
    ]
    file = tmp_path / "test_it.py"
    for name in OWN:
        (tmp_path / f"{name}.py").touch()
    file.write_text(with_imports(FILE, lines, OWN))
    ruff = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", "I", str(file)]
    done = subprocess.run(ruff, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
