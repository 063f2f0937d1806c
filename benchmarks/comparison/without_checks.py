"""A pytest plug-in that switches off what the tests check, to see how much of a score is left without them.

Assertions in the tests' own files are compiled to nothing, as ``python -O`` does, so that the test goes on
after them; so are the comparisons of unittest and numpy.testing. A check that ends the test all the same (a
monitor, ``pytest.fail``) counts as passed. Assertions of the program stay. ``ENVIRONMENT`` says which files
are whose.
"""

from __future__ import annotations

import ast
import json
import os
import sys
from collections.abc import Generator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import wrapt

from mutabot.model import Role
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.program_text import loading
from mutabot.runtime.targets.target import is_named

#: variable with JSON: root, program, oracle, and checks (exceptions that are verdicts of a check)
ENVIRONMENT = "COMPARISON_WITHOUT_CHECKS"
#: of unittest and numpy.testing: these run what they are given, and so they stay
_RUNS_SOMETHING = ("raises", "warn", "logs", "gc_cycles")


class WithoutChecks:
    """The checks of one process, switched off.

    Args:
        root: absolute path of the project.
        locator: knows the program's and the oracle's files.
        checks: names of exceptions that are verdicts of a check.
    """

    def __init__(self, root: str, locator: Locator, checks: tuple[str, ...]) -> None:
        self._root = os.path.realpath(root)
        self._locator = locator
        self._checks = checks
        self._folders: set[str] = set()

    def install(self) -> None:
        """Switch off checks in all that is imported from now on."""
        self._switch_off_rewriting()
        loading.add(self)
        wrapt.register_post_import_hook(_silence_unittest, "unittest.case")
        wrapt.register_post_import_hook(_silence, "numpy.testing")

    def note_tests(self, path: str) -> None:
        """Tests are about to be collected here: helpers in the same folder are the tests' own."""
        self._folders.add(f"{Path(path).resolve().parent}{os.sep}")

    def wants(self, path: str) -> bool:
        """Whether the assertions of a file are the tests' own checks."""
        role = self._locator.role(path)
        if role is not None:
            return role is Role.ORACLE
        real = Path(path).resolve()
        if real.name == "conftest.py":
            if str(real.parent) != self._root:  # else all of the project would be the tests' own
                self.note_tests(str(real))
            return True
        return str(real).startswith(tuple(self._folders))

    @pytest.hookimpl(tryfirst=True)
    def pytest_pycollect_makemodule(self, module_path: Any) -> None:
        """A test file is about to be imported."""
        self.note_tests(str(module_path))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, None, None]:
        """A check that ends the test counts as passed."""
        try:
            yield
        except (Exception, pytest.fail.Exception) as error:
            if not self._is_check(error):
                raise

    def _is_check(self, error: BaseException) -> bool:
        if isinstance(error, pytest.fail.Exception) or is_named(error, self._checks):
            return True
        return isinstance(error, AssertionError) and not self._is_of_the_program(error)

    def _is_of_the_program(self, error: BaseException) -> bool:
        """Whether the innermost frame that is the tests' or the program's is the program's."""
        frames = []
        traceback = error.__traceback__
        while traceback is not None:
            frames.append(traceback.tb_frame.f_code.co_filename)
            traceback = traceback.tb_next
        for file in reversed(frames):
            if self._locator.role(file) is Role.PROGRAM:
                return True
            if self.wants(file):
                return False
        return False

    def _switch_off_rewriting(self) -> None:
        """Pytest compiles test files itself; what it compiled in earlier sessions is not used."""
        rewrite: Any = sys.modules["_pytest.assertion.rewrite"]
        original = rewrite.rewrite_asserts

        def rewrite_asserts(tree: ast.Module, source: bytes, path: str | None = None, *rest: Any) -> None:
            if path is not None and self.wants(path):
                self.change(tree, source, path)
            original(tree, source, path, *rest)

        rewrite.rewrite_asserts = rewrite_asserts
        rewrite._read_pyc = lambda *arguments, **named: None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Take the assertions out of a file of the tests."""
        _Remover().visit(tree)

    def give_up(self, path: str, error: Exception) -> None:
        """A file whose checks stay on would say something about them: its import fails instead."""
        raise error


class _Remover(ast.NodeTransformer):
    """Takes assertions out of a tree."""

    def visit_Assert(self, node: ast.Assert) -> ast.stmt:  # the name that ast looks for
        return ast.copy_location(ast.Pass(), node)


def _silence_unittest(module: ModuleType) -> None:
    _silence(module.TestCase)


def _silence(owner: Any) -> None:
    """Let the comparisons of a module or class do nothing."""
    for name in dir(owner):
        if name.startswith("assert") and not any(part in name.lower() for part in _RUNS_SOMETHING):
            setattr(owner, name, _nothing)


def _nothing(*arguments: Any, **named: Any) -> None:
    """A check that is switched off."""


def pytest_configure(config: pytest.Config) -> None:
    """Switch the checks off before any test file is imported."""
    given = json.loads(os.environ[ENVIRONMENT])
    locator = Locator(given["root"], tuple(given["program"]), tuple(given["oracle"]))
    plugin = WithoutChecks(given["root"], locator, tuple(given["checks"]))
    plugin.install()
    config.pluginmanager.register(plugin)
