"""Copies of the program count as the program if they are made while the session runs."""

from __future__ import annotations

import os
import shutil
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent
from types import CodeType

import pytest

from mutabot.runtime import paths
from mutabot.runtime.executed_text import file_of, look_at, original_code
from mutabot.runtime.paths import look_again, real_path, watch_copies

TEXT = "def main(arm):\n    arm.move(10)\n"


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Path]:
    """A program of two files, older than the session."""
    folder = tmp_path / "project"
    (folder / "cell").mkdir(parents=True)
    (folder / "cell" / "__init__.py").touch()
    (folder / "cell" / "mission.py").write_text(TEXT)
    before = paths._copies
    watch_copies(str(folder), ["cell"], since_now(tmp_path))
    yield folder / "cell" / "mission.py"
    paths._copies = before
    paths.forget()


def since_now(folder: Path) -> int:
    """A time after all that was written until now: file systems know it by ticks of a clock."""
    first = now = written(folder)
    while now == first:
        now = written(folder)
    return now


def written(folder: Path) -> int:
    """When a file that is written now was written, ns."""
    (folder / "tick").write_text(str(time.time_ns()))
    return (folder / "tick").stat().st_ctime_ns


def test_a_copy_stands_for_its_original(program: Path, tmp_path: Path) -> None:
    copy = shutil.copy2(program, tmp_path / "other.py")
    assert real_path(str(copy)) == str(program)


def test_an_older_file_with_the_same_text_is_another_one(program: Path, tmp_path: Path) -> None:
    older = tmp_path / "older.py"
    older.write_text(TEXT)
    watch_copies(str(program.parents[1]), ["cell"], since_now(tmp_path))
    assert real_path(str(older)) == str(older)


def test_a_file_of_the_program_is_itself(program: Path) -> None:
    program.with_name("second.py").write_text(TEXT)
    assert real_path(str(program.with_name("second.py"))) == str(program.with_name("second.py"))


def test_of_originals_with_the_same_text_it_is_the_one_with_the_same_name(
    program: Path, tmp_path: Path
) -> None:
    program.with_name("second.py").write_text(TEXT)
    copied = shutil.copytree(program.parent, tmp_path / "copied" / "cell")
    for name in ("mission.py", "second.py"):
        assert real_path(str(copied / name)) == str(program.with_name(name))


def test_an_empty_file_is_no_copy(program: Path, tmp_path: Path) -> None:
    (tmp_path / "__init__.py").touch()
    assert real_path(str(tmp_path / "__init__.py")) == str(tmp_path / "__init__.py")


def test_line_ends_and_encodings_do_not_matter(program: Path, tmp_path: Path) -> None:
    (tmp_path / "other.py").write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    assert real_path(str(tmp_path / "other.py")) == str(program)


def test_a_member_of_a_zip_file_is_a_copy(program: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "app.pyz", "w") as archive:
        archive.write(program, "parts/mission.py")
        archive.writestr("other.py", "x = 1\n")
    assert real_path(str(tmp_path / "app.pyz" / "parts" / "mission.py")) == str(program)
    for name in ("other.py", "missing.py"):
        assert real_path(str(tmp_path / "app.pyz" / name)) == str(tmp_path / "app.pyz" / name)


def test_what_is_written_again_is_looked_at_again(program: Path, tmp_path: Path) -> None:
    file = tmp_path / "variant.py"
    file.write_text(TEXT.replace("10", "200"))
    assert real_path(str(file)) == str(file)
    file.write_text(TEXT)
    look_again(str(file))
    assert real_path(str(file)) == str(program)
    file.unlink()
    look_again(str(file))
    assert real_path(str(file)) == str(file)


def test_a_copy_of_what_a_mutant_has_changed_stands_for_its_original(program: Path, tmp_path: Path) -> None:
    program.write_text(TEXT.replace("10", "-10"))
    copy = shutil.copy(program, tmp_path / "other.py")
    assert real_path(str(copy)) == str(program)


def test_a_pipe_is_no_copy(program: Path, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.py")
    assert real_path(str(tmp_path / "pipe.py")) == str(tmp_path / "pipe.py")


@pytest.mark.parametrize("name", ["<string>", "<mission>"])
def test_text_that_is_run_has_the_file_that_holds_it(program: Path, name: str) -> None:
    same, other = (compile(text, name, "exec") for text in (TEXT, TEXT.replace("10", "20")))
    for code in (same, other):
        look_at(code)
    assert file_of(same) == file_of(inner(same)) == str(program)
    assert file_of(other) == file_of(inner(other)) == name


def test_a_function_that_a_changed_text_has_taken_over_is_the_program_s(
    program: Path, tmp_path: Path
) -> None:
    text = f"import math\n\n\n{TEXT}\n\ndef other():\n    arm.move(10)\n"
    (tmp_path / "changed.py").write_text(text)
    for name in ("<string>", str(tmp_path / "changed.py")):
        code = compile(text, name, "exec")
        look_at(code)
        main, other = (part for part in code.co_consts if hasattr(part, "co_code"))
        assert original_code(main).co_firstlineno == 1
        assert (file_of(main), file_of(other), file_of(code)) == (str(program), name, name)


def test_of_functions_with_the_same_name_the_equal_one_is_meant_and_of_equal_ones_none(program: Path) -> None:
    method = "    def main(self, arm):\n        arm.move(20)\n"
    program.write_text(f"{TEXT}\n\nclass Cell:\n{method}\n\nclass Line:\n{method.replace('20', '30')}")
    for text, line in (
        ("import math\n" + TEXT, 1),
        (dedent(method), 6),
        (dedent(method.replace("20", "30")), 11),
    ):
        code = compile(text, "<string>", "exec")
        look_at(code)
        assert original_code(inner(code)).co_firstlineno == line
    program.with_name("second.py").write_text("import sys\n" + TEXT)
    code = compile("import math\n" + TEXT, "<string>", "exec")
    look_at(code)
    assert file_of(inner(code)) == "<string>"


def test_an_older_text_that_has_a_function_of_the_program_is_another_one(
    program: Path, tmp_path: Path
) -> None:
    (tmp_path / "older.py").write_text(f"import math\n{TEXT}")
    watch_copies(str(program.parents[1]), ["cell"], since_now(tmp_path))
    code = compile(f"import math\n{TEXT}", str(tmp_path / "older.py"), "exec")
    look_at(code)
    assert file_of(inner(code)) == str(tmp_path / "older.py")


def inner(code: CodeType) -> CodeType:
    """The only function in code."""
    return next(part for part in code.co_consts if isinstance(part, CodeType))
