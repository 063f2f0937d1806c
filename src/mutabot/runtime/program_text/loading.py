"""Change source files while Python compiles them, imported or run as scripts.

Every way to import a source file asks ``SourceFileLoader.get_code`` for the code: the import statement,
``importlib``, ``runpy.run_module``. That one place is patched; loader, spec and module stay as they are. Of
a file that a step wants, no compiled form is read or written.

Python compiles the script of a process, and ``runpy.run_path`` its file, without a loader. Python runs a
script by a loader if a path hook claims it, as it does with a zip file; what the script sees of itself is
then put right before its first statement. ``runpy`` compiles in one function, which is patched.
"""

from __future__ import annotations

import ast
import os
import runpy
import sys
import warnings
from collections.abc import Callable
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from types import CodeType, ModuleType
from typing import Any, Protocol

from mutabot.languages.python import head_size


class SourceStep(Protocol):
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
        return


#: in the order of their turns
_steps: list[SourceStep] = []
_original = SourceFileLoader.get_code


def add(step: SourceStep) -> None:
    """Let a step take the last turn at all files that are imported from now on."""
    _steps.append(step)
    # get_code is inherited; it is put where the inherited one is found last
    SourceFileLoader.get_code = _get_code  # type: ignore[method-assign, assignment]


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


#: told the tree of a file, its source and its path
Change = Callable[[ast.Module, bytes, str], None]


def hook_pytest(wants: Callable[[str], bool], change: Change, look: Change | None = None) -> None:
    """Show wanted files that pytest rewrites to ``look`` before pytest, and to ``change`` after it."""
    rewriting: Any = sys.modules.get("_pytest.assertion.rewrite")
    if rewriting is None:
        return
    rewrite, read = rewriting.rewrite_asserts, rewriting._read_pyc

    def rewrite_asserts(tree: ast.Module, source: bytes, path: str | None = None, *rest: Any) -> None:
        wanted = path if path is not None and wants(path) else None
        if wanted is not None and look is not None:
            look(tree, source, wanted)
        rewrite(tree, source, path, *rest)
        if wanted is not None:
            change(tree, source, wanted)

    def read_pyc(source: Any, *rest: Any, **named: Any) -> Any:
        # what pytest compiled in earlier sessions tells nothing
        return None if wants(str(source)) else read(source, *rest, **named)

    rewriting.rewrite_asserts, rewriting._read_pyc = rewrite_asserts, read_pyc


def hook_runpy() -> None:
    """Let ``runpy`` compile files that it runs as files are compiled that are imported."""
    module: Any = runpy
    original = module._get_code_from_file
    if getattr(original, "is_of_mutabot", False):
        return

    def code_of(*arguments: Any) -> Any:  # the name of the module came before the file in older versions
        path = os.path.abspath(os.fspath(arguments[-1]))
        if not is_wanted(path):
            return original(*arguments)
        code = SourceFileLoader("__main__", path).get_code("__main__")
        return (code, arguments[-1]) if len(arguments) > 1 else code

    code_of.is_of_mutabot = True  # type: ignore[attr-defined]
    module._get_code_from_file = code_of


def hook_script() -> None:
    """If the script that this process is about to run is wanted, let it be compiled as modules are.

    To be called before Python looks for the script: while it is still setting itself up.
    """
    script = getattr(sys, "argv", [""])[0]
    if script in ("", "-c", "-m") or not is_wanted(os.path.abspath(script)):
        return
    path = os.path.abspath(script)
    own = _Script(path)
    add(own)

    def claim(entry: str) -> _Script:
        if entry not in (script, path):  # as it was given, or as newer versions complete it
            raise ImportError(entry)
        return own

    sys.path_hooks.insert(0, claim)
    for entry in (script, path):
        sys.path_importer_cache.pop(entry, None)


class _Script(SourceStep):
    """Finds one module, the script, and lets it see itself as a script: not as a module that was found."""

    def __init__(self, path: str) -> None:
        self._path = path

    def find_spec(self, name: str, target: ModuleType | None = None) -> ModuleSpec | None:
        """The script, if it is asked for."""
        if name != "__main__":
            return None
        if sys.path and os.path.abspath(sys.path[0]) == self._path:  # where a script has its own folder
            sys.path[0] = os.path.dirname(os.path.realpath(self._path))
        return spec_from_file_location(name, self._path, loader=SourceFileLoader(name, self._path))

    def wants(self, path: str) -> bool:
        """Only that script."""
        return path == self._path

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Forget its spec before its first statement."""
        forget = ast.parse("__spec__ = __package__ = __cached__ = None").body  # in the first line
        size = head_size(tree.body)
        tree.body[size:size] = forget
