"""How source files are compiled while they are imported: whatever changes them takes its turn here.

Every way to import a source file asks ``SourceFileLoader.get_code`` for the code: the import statement,
``importlib``, ``runpy.run_module``. That is the one place that is patched; loader, spec and module stay what
they are without it. Files that are run without being imported come here by way of ``scripts``. Of a file that
a step wants, no compiled form is read or written.
"""

from __future__ import annotations

import ast
import warnings
from importlib.machinery import SourceFileLoader
from types import CodeType
from typing import Protocol


class Step(Protocol):
    """Something that changes source files on their way.

    One with an attribute ``is_optional`` leaves files alone whose loader compiles them in a way of its own.
    """

    def wants(self, path: str) -> bool:
        """Whether it has anything to do with a file."""

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Change the tree of a file that it wants, in place.

        Raises RecursionError, SyntaxError or ValueError if it cannot.
        """

    def give_up(self, path: str, error: Exception) -> None:
        """A file that it was to change is compiled without it; it may raise the error instead."""


#: in the order of their turns
_steps: list[Step] = []
_original = SourceFileLoader.get_code


def add(step: Step) -> None:
    """Let a step take the last turn at all files that are imported from now on."""
    _steps.append(step)
    # get_code is inherited; it is put where the inherited one is found last
    SourceFileLoader.get_code = _get_code  # type: ignore[method-assign, assignment]


def remove(step: Step) -> None:
    """Import without a step from now on."""
    _steps.remove(step)
    if not _steps and "get_code" in vars(SourceFileLoader):
        del SourceFileLoader.get_code


def is_wanted(path: str) -> bool:
    """Whether any step has anything to do with a file."""
    return any(step.wants(path) for step in _steps)


def compile_tree(tree: ast.Module, path: str) -> CodeType:
    """The code of a changed file. Raises what ``compile`` raises."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # what was put in may look as if it were a slip
        return compile(tree, path, "exec", dont_inherit=True)


def _get_code(self: SourceFileLoader, fullname: str) -> CodeType | None:
    path = self.get_filename(fullname)
    is_plain = type(self).source_to_code is SourceFileLoader.source_to_code
    steps = [step for step in _steps if step.wants(path) and (is_plain or not hasattr(step, "is_optional"))]
    while steps:
        source = self.get_data(path)
        try:
            tree = ast.parse(source, path)
            for step in steps:
                step.change(tree, source, path)
            return compile_tree(tree, path)
        except (RecursionError, SyntaxError, ValueError) as error:
            steps.pop(0).give_up(path, error)
    return _original(self, fullname)
