"""What counts as a line of code, and as a link of a chain of imports."""

from __future__ import annotations

from pathlib import Path

import measure_code

TEXT = '''"""A docstring
of two lines."""

import os  # one
from pathlib import (
    Path,
)

#: a comment


class A:
    """Another."""

    name: str = "not a docstring"
    """What the field is."""

    text = """one
two"""
'''


def test_docstrings_comments_and_blank_lines_are_no_code() -> None:
    assert measure_code.lines_of_code(TEXT) == 8
    assert measure_code.import_lines(TEXT) == 4


def test_a_chain_is_as_long_as_the_files_that_import_one_another(tmp_path: Path) -> None:
    package = tmp_path / "package"
    (package / "inner").mkdir(parents=True)
    for name, text in {
        "__init__.py": "",
        "a.py": "from .inner import b\n",
        "inner/__init__.py": "",
        "inner/b.py": "from package.c import x\n",
        "c.py": "x = 1\n",
        "d.py": "if False:\n    import package.a\n",
    }.items():
        (package / name).write_text(text)
    assert measure_code.longest_chain(measure_code.imported(package)) == 3
