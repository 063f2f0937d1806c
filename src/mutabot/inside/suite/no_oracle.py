"""Switching off what the tests check, to see what a score is worth that does not come from checks.

Assertions in the tests' own files are compiled to nothing, as ``python -O`` does, so that the test goes on
after them; so are the comparisons of unittest and numpy.testing. What is a check all the same (a monitor,
``pytest.fail``) ends the test as it ever did, and counts as passed. Assertions of the program stay.
"""

from __future__ import annotations

import ast
import os
import sys
from types import ModuleType
from typing import Any

import wrapt

from mutabot.inside.calls.locate import Locator
from mutabot.inside.text import loading
from mutabot.model import Role

#: of unittest and numpy.testing: these run what they are given, and so they stay
_RUNS_SOMETHING = ("raises", "warn", "logs", "gc_cycles")


class NoOracle:
    """The checks of one process, switched off.

    Args:
        root: absolute path of the project.
        locator: knows the program's and the oracle's files.
    """

    def __init__(self, root: str, locator: Locator) -> None:
        self._root = os.path.realpath(root)
        self._locator = locator
        self._folders: set[str] = set()

    def install(self) -> None:
        """Switch off checks in all that is imported from now on."""
        self._switch_off_rewriting()
        loading.add(self)
        wrapt.register_post_import_hook(_silence_unittest, "unittest.case")
        wrapt.register_post_import_hook(_silence, "numpy.testing")

    def note_tests(self, path: str) -> None:
        """Tests are about to be collected here: helpers in the same folder are the tests' own."""
        self._folders.add(os.path.dirname(os.path.realpath(path)) + os.sep)

    def wants(self, path: str) -> bool:
        """Whether the assertions of a file are the tests' own checks."""
        role = self._locator.role(path)
        if role is not None:
            return role is Role.ORACLE
        real = os.path.realpath(path)
        if os.path.basename(real) == "conftest.py":
            if os.path.dirname(real) != self._root:  # else all of the project would be the tests' own
                self.note_tests(real)
            return True
        return real.startswith(tuple(self._folders))

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
