"""Units of Python files: what they say, by which lines they are recorded, and where their lines go."""

from __future__ import annotations

import ast
import gc
from textwrap import dedent

import pytest

from mutabot.model.source_units import MODULE, WHOLE, File, together

TEXT = """
    import functools

    FAR = 0.5

    class Arm:
        reach = 1.0

        def move(self, dx):
            return dx

        @registered
        def stop(self):
            pass

    @functools.cache
    def far():
        return FAR
"""


def file(text: str, name: str = "mission.py") -> File:
    return File(name, dedent(text).encode())


def changed(old: str, new: str, name: str = "mission.py") -> set[str]:
    before, now = file(old, name).digests, file(new, name).digests
    return {unit for unit in {*before, *now} if before.get(unit) != now.get(unit)}


def test_functions_are_units_but_for_those_with_decorators_that_nobody_knows() -> None:
    source_file = file(TEXT)
    assert set(source_file.digests) == {"", "Arm.move", "far"}
    lines = source_file.lines_of({"", "Arm.move"})
    assert lines == (MODULE, 9)
    assert source_file.names_at(lines) == {"", "Arm.move"}
    assert source_file.names_at((WHOLE,)) is None
    assert source_file.names_at((3,)) is None  # no unit begins there


@pytest.mark.parametrize(
    ("old", "new", "units"),
    [
        ("return dx", "return -dx", {"Arm.move"}),
        ("return dx", "return dx  # a comment", set()),
        ("    pass", "    return 1", {""}),
        ("FAR = 0.5", "FAR = 0.6", {""}),
        ("reach = 1.0", "reach = 2.0", {""}),
        ("def move(self, dx)", "def move(self, dx=0)", {"", "Arm.move"}),
        ("@functools.cache", "@functools.lru_cache", {"", "far"}),
        ("def far()", "def near()", {"", "far", "near"}),
    ],
)
def test_a_change_is_one_of_its_unit(old: str, new: str, units: set[str]) -> None:
    assert changed(TEXT, TEXT.replace(old, new)) == units


@pytest.mark.parametrize(
    ("added", "units"),
    [
        ("\ndef test_new():\n    pass\n", {"test_new"}),
        ("\n@pytest.mark.slow\ndef test_new():\n    pass\n", {"test_new"}),
        ("\n@pytest.mark.skipif(slow())\ndef test_new():\n    pass\n", {""}),
        ("\nclass TestNew:\n    def test_it(self):\n        pass\n", {"TestNew.test_it"}),
        ("\nclass TestNew:\n    x = 1\n    def test_it(self):\n        pass\n", {"", "TestNew.test_it"}),
        ("\ndef helper():\n    pass\n", {"", "helper"}),
        ("\n@pytest.fixture\ndef arm():\n    pass\n", {"", "arm"}),
    ],
)
def test_a_new_test_changes_nothing_else_of_its_file(added: str, units: set[str]) -> None:
    text = "import pytest\n\ndef test_old():\n    pass\n"
    assert changed(text, text + added, "tests/test_mission.py") == units


def test_an_example_in_a_docstring_is_a_test_and_counts_for_all() -> None:
    text = 'def far():\n    """Gives {}."""\n    return 1\n'
    assert changed(text.format("1"), text.format("2")) == {"far"}
    assert changed(text.format(">>> 1"), text.format(">>> 2")) == {"", "far"}


def test_who_reads_program_text_depends_on_all_of_the_file() -> None:
    text = "import inspect\n\ndef own():\n    return inspect.getsource(own)\n"
    assert changed(text, text + "# a comment\n") == {"own"}


def test_what_cannot_be_parsed_counts_whole() -> None:
    source_file = file("def (:\n")
    assert not source_file.is_python
    assert source_file.names_at((MODULE,)) is None
    assert source_file.lines_of({"x"}) == (WHOLE,)


def test_a_file_keeps_no_syntax_tree() -> None:
    source_file = file("def only_here():\n    pass\n")
    assert source_file.is_python
    assert "only_here" in source_file.digests
    kept = (node for node in gc.get_objects() if isinstance(node, ast.FunctionDef))
    assert not any(node.name == "only_here" for node in kept)


def test_lines_move_where_the_unit_says_the_same() -> None:
    moved = file(TEXT).moves_to(
        file(TEXT.replace("FAR =", "# a comment\n\n    FAR =").replace("n dx", "n  dx"))
    )
    assert moved[(10,)] == (12,)


@pytest.mark.parametrize(
    ("text", "is_quiet"),
    [
        ("import mission\n\nLONG = 1.0\n\ndef test_it():\n    pass\n", True),
        ("import mission\n\nmission.start()\n", False),
        ("class TestIt:\n    x = 1\n    def test_it(self):\n        pass\n", True),
        ("class TestIt(mission.Base):\n    x = 1\n    def test_it(self):\n        pass\n", False),
    ],
)
def test_a_test_file_is_quiet_if_its_import_does_nothing(text: str, is_quiet: bool) -> None:
    assert file(text, "test_it.py").is_quiet is is_quiet


def test_units_that_are_not_known_make_the_whole_unknown() -> None:
    assert together([{"a.py": (3,)}, {"a.py": (MODULE,), "b.py": (1,)}]) == {
        "a.py": (MODULE, 3),
        "b.py": (1,),
    }
    assert together([{"a.py": (3,)}, None]) is None
