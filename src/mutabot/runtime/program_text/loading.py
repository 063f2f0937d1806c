"""Change source files when they are loaded, imported or run as scripts.

Every loader that reads source inherits ``get_code``, which asks the loader for the code of its file. What is
compiled meanwhile is that file (``compiling``); loader, spec and module stay as they are. Of a file that a
step wants, no compiled form is read or written.

Python compiles the script of a process without a loader. It runs a script by a loader if a path hook claims
it, as it does with a zip file; what the script sees of itself is then put right before its first statement.
"""

from __future__ import annotations

import ast
import copy
import os
import sys
from collections.abc import Callable
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from types import CodeType, ModuleType
from typing import Any

from mutabot.errors import error_text
from mutabot.languages.python import head_size
from mutabot.runtime.paths import look_again
from mutabot.runtime.program_text import compiling
from mutabot.runtime.program_text.compiling import LoaderRequest, SourceStep, is_wanted

#: where ``get_code`` stands that loaders of source files inherit, those of other packages as well
_SourceLoader: Any = next(cls for cls in SourceFileLoader.__mro__ if "get_code" in vars(cls))
_original = _SourceLoader.get_code


def add(step: SourceStep) -> None:
    """Apply a step, after all others, to files that are compiled from now on."""
    compiling.steps.append(step)
    compiling.install()
    _SourceLoader.get_code = _get_code


def _get_code(self: Any, fullname: str) -> CodeType | None:
    path = self.get_filename(fullname)
    look_again(path)
    if not is_wanted(path):
        found: CodeType | None = _original(self, fullname)
        return found
    request = LoaderRequest(path, self.get_data(path))
    code, why = _loaded_code(self, request)
    if why is not None:
        for step in compiling.steps:
            if step.wants(path):
                step.give_up(path, ValueError(f"{why} ({loader_name(self)})"))
    return code


def _loaded_code(loader: Any, request: LoaderRequest) -> tuple[CodeType, str | None]:
    """Return the code that a loader makes of its file, and why it does not contain the change, if so."""
    compiling.requests.open.append(request)
    why = None
    try:
        code = loader.source_to_code(request.data, request.path)
    except Exception as error:
        if not request.is_changed:
            raise
        request.is_off = True  # the loader may well take the text as it stands
        code = loader.source_to_code(request.data, request.path)
        why = f"its loader fails with instrumented text: {error_text(error)}"
    finally:
        compiling.requests.open.pop()
    return code, why if why is not None or request.is_met else UNSEEN


#: why nothing of a file can be changed
UNSEEN = "its loader compiles it in a way that mutabot cannot follow"


def loader_name(loader: Any) -> str:
    """Return the name of a loader's class."""
    kind = loader if isinstance(loader, type) else type(loader)
    return f"{kind.__module__}.{kind.__qualname__}"


#: called with the tree of a file, its source and its path
Change = Callable[[ast.Module, bytes, str], None]


def hook_pytest(wants: Callable[[str], bool], change: Change, look: Change | None = None) -> None:
    """Show wanted files that pytest rewrites to ``look`` before, and to ``change`` after it."""
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
            setattr(tree, compiling.DONE, True)

    def read_pyc(source: Any, *rest: Any, **named: Any) -> Any:
        # what pytest compiled in earlier sessions is of no use
        return None if wants(str(source)) else read(source, *rest, **named)

    rewriting.rewrite_asserts, rewriting._read_pyc = rewrite_asserts, read_pyc


def hook_pytest_first(step: SourceStep) -> None:
    """Let a step change files that pytest rewrites, before pytest does."""

    def look(tree: ast.Module, source: bytes, path: str) -> None:
        changed = copy.deepcopy(tree)
        try:
            step.change(changed, source, path)
        except (RecursionError, SyntaxError, ValueError) as error:
            step.give_up(path, error)
        else:
            tree.body = changed.body

    hook_pytest(step.wants, lambda *_: None, look)


def hook_script() -> None:
    """Compile the script that this process is about to run like a module, if it is wanted.

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
    """Loads one module as a script, with a script's attributes."""

    def __init__(self, path: str) -> None:
        self._path = path

    def find_spec(self, name: str, target: ModuleType | None = None) -> ModuleSpec | None:
        """Return the script's spec if the script is asked for."""
        if name != "__main__":
            return None
        if sys.path and os.path.abspath(sys.path[0]) == self._path:  # where a script has its own folder
            sys.path[0] = os.path.dirname(os.path.realpath(self._path))
        return spec_from_file_location(name, self._path, loader=SourceFileLoader(name, self._path))

    def wants(self, path: str) -> bool:
        """Return whether the path is that of the script."""
        return path == self._path

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Remove the module's spec before its first statement."""
        forget = ast.parse("__spec__ = __package__ = __cached__ = None").body  # in the first line
        size = head_size(tree.body)
        tree.body[size:size] = forget
