"""Determines which files belong to the tests: a patch to the suite is no mutant of the program."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import PurePosixPath

#: what configures pytest, wherever it lies
_CONFIGURATION = {
    "conftest.py", "pytest.ini", ".pytest.ini", "pytest.toml", ".pytest.toml", "tox.ini", "setup.cfg",
}  # fmt: skip
#: what configures pytest or the project as a whole, in its folder
_OF_PROJECT = ("pyproject.toml", "mutabot.toml", "mutabot-accepted.toml")


class FilesOfTests:
    """The files of the tests.

    Args:
        tests: node ids of the tests.
        program: files of the program: a folder that has some belongs to the program, also if it has tests.
    """

    def __init__(self, tests: Iterable[str], program: Collection[str]) -> None:
        self._files = {test.partition("::")[0] for test in tests} - {*program}  # it may have doctests
        of_program = {folder for file in program for folder in PurePosixPath(file).parents}
        folders = {PurePosixPath(file).parent for file in self._files}
        self._folders = folders - of_program - {PurePosixPath()}

    def has(self, file: str) -> bool:
        """Return whether a file belongs to the tests, given by its path in the project."""
        path = PurePosixPath(file)
        return (
            file in self._files
            or path.name in _CONFIGURATION
            or file in _OF_PROJECT
            or not self._folders.isdisjoint(path.parents)
        )


def looks_like_tests(file: str) -> bool:
    """Return whether a file belongs to the tests by its name and folder alone."""
    path = PurePosixPath(file)
    is_named = path.suffix == ".py" and (path.stem.startswith("test_") or path.stem.endswith("_test"))
    in_tests = {"test", "tests", "testing"} & {part.lower() for part in path.parts[:-1]}
    return is_named or bool(in_tests) or path.name in _CONFIGURATION or file in _OF_PROJECT
