"""Change source files when they are compiled, by whatever code.

All program text comes to ``compile``: from the import system, from loaders of others, which check types,
expand macros or rewrite text, from ``runpy`` and from ``exec(compile(text, path))``. That one place is
patched, so a loader makes of the changed text what it would make of any.

Text is changed when it is compiled. A loader that parses it first gets the changed tree, as long as the
import system asks it for code: code that parses a program at other times only reads it. A tree that comes
without the changes gets them when it is compiled. So do trees, in any case, what only asks about calls: a
loader that looks at calls sees those of the program alone.
"""

from __future__ import annotations
import __future__

import ast
import builtins
import copy
import os
import threading
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import decode_source
from sys import _getframe
from types import CodeType
from typing import Any, Protocol

from mutabot.runtime.paths import look_again


class SourceStep(Protocol):
    """A change of source files before they are compiled.

    One with an attribute ``is_optional`` leaves alone what is not compiled as it stands in its file; one with
    an attribute ``is_last`` takes its turn after all that rewrite a tree.
    """

    def wants(self, path: str) -> bool:
        """Return whether it applies to a file."""

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Change the tree of a file in place.

        ``source`` is what the file holds, or the text that is compiled under its name if that is another one.

        Raises RecursionError, SyntaxError or ValueError if it cannot.
        """

    def give_up(self, path: str, error: Exception) -> None:
        """Note that a file is compiled without the change, or raise the error."""
        return


@dataclass(slots=True, eq=False)
class LoaderRequest:
    """A request of the import system to a loader for code.

    Attributes:
        path: the file.
        data: what it holds.
        is_met: whether the steps were applied to it.
        is_changed: whether any has changed it.
        is_off: whether nothing is to be changed.
    """

    path: str
    data: bytes
    is_met: bool = False
    is_changed: bool = False
    is_off: bool = False


class _Requests(threading.local):
    def __init__(self) -> None:
        self.open: list[LoaderRequest] = []


#: in the order of their turns
steps: list[SourceStep] = []
#: of each thread those without an answer yet, the latest last
requests = _Requests()
_builtin = builtins.compile
#: flags of code that what it compiles inherits; those of two old features mean something else today
INHERITED = 0
for _name in {*__future__.all_feature_names} - {"nested_scopes", "generators"}:
    INHERITED |= getattr(__future__, _name).compiler_flag
#: how all names begin that are put into text
_OURS = "__mutabot"
#: attributes of trees: all steps are done with it; the file that a loader has parsed; whether it was changed
DONE, _PARSED, _CHANGED = "is_done_by_mutabot", "path_for_mutabot", "is_changed_by_mutabot"


def install() -> None:
    """Apply the steps to all files that are compiled from now on."""
    if builtins.compile is _builtin:
        builtins.compile = _compile


def is_wanted(path: str) -> bool:
    """Return whether any step applies to a file."""
    return any(step.wants(path) for step in steps)


def compile_plainly(text: str, name: str, flags: int) -> CodeType:
    """Return the code of a text as it stands. Raises SyntaxError or ValueError."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # reported when the program is compiled
        code: CodeType = _builtin(text, name, "exec", flags, True)
    return code


def compile_tree(tree: ast.Module, path: str, flags: int = 0, optimize: int = -1) -> CodeType:
    """Return the code of a changed file. Raises what ``compile`` raises."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)  # what was put in may look as if it were a slip
        code: CodeType = _builtin(tree, path, "exec", flags, True, optimize)
    return code


def _compile(
    source: Any, filename: Any, mode: str, flags: int = 0, dont_inherit: bool = False, optimize: int = -1,
    **more: Any,
) -> Any:  # fmt: skip
    """Compile a source, with the steps; the replacement of ``compile``."""
    if not dont_inherit:
        flags |= _getframe(1).f_code.co_flags & INHERITED
    plainly = partial(_builtin, source, filename, mode, flags, True, optimize, **more)
    request = requests.open[-1] if requests.open else None
    if mode != "exec" or (request is not None and request.is_off):
        return plainly()
    is_tree, is_parsed = isinstance(source, ast.AST), bool(flags & ast.PyCF_ONLY_AST)
    if request is not None and not is_tree and _is_same(source, request.data):
        path: str | None = request.path
    else:
        path = None if is_parsed else getattr(source, _PARSED, None) or _wanted(filename)
    if path is None or (is_tree and hasattr(source, DONE)):
        return plainly()
    is_met = is_tree and _is_instrumented(source)

    def is_due(step: SourceStep) -> bool:
        is_last = hasattr(step, "is_last")
        return not is_last if is_parsed else is_last or not is_met

    def parse() -> Any:
        if is_tree:
            return copy.deepcopy(source)
        return _builtin(source, filename, mode, flags | ast.PyCF_ONLY_AST, True, optimize, **more)

    def finish(tree: ast.Module) -> Any:
        return tree if is_parsed else compile_tree(tree, path, flags, optimize)

    is_own = request is not None and path == request.path
    data = request.data if request is not None and is_own else content_of(path)
    is_whole = not is_tree and _is_same(source, data)
    text = data if is_tree or is_whole else _bytes_of(source)
    is_plain = is_whole and not is_parsed
    due = [step for step in steps if step.wants(path) and is_due(step)]
    made = _through_steps(
        path, text, parse, finish, [step for step in due if is_plain or not hasattr(step, "is_optional")]
    )
    if request is not None and is_own:
        request.is_met, request.is_changed = True, request.is_changed or made is not None
    if not is_parsed:
        return plainly() if made is None else made
    tree = plainly() if made is None else made
    setattr(tree, _PARSED, path)
    if made is not None:
        setattr(tree, _CHANGED, True)
    return tree


def _through_steps(
    path: str,
    source: bytes,
    parse: Callable[[], Any],
    finish: Callable[[Any], Any],
    waiting: list[SourceStep],
) -> Any:
    """Apply steps to a file, and return the result of ``finish``; None if no step can change it."""
    while waiting:
        failing = waiting[0]
        try:
            tree = parse()
            for failing in waiting:  # the one that fails is looked at after the loop
                failing.change(tree, source, path)
            failing = waiting[0]
            return finish(tree)
        except (RecursionError, SyntaxError, ValueError) as error:
            waiting.remove(failing)
            failing.give_up(path, error)
    return None


def _wanted(filename: Any) -> str | None:
    """Return the path of a file that is compiled to be run, if steps apply to it."""
    if not isinstance(filename, str | bytes | os.PathLike):
        return None
    name = os.fsdecode(filename)
    if name.startswith("<"):
        return None
    path = name if os.path.isabs(name) else os.path.abspath(name)  # the folder may change before it runs
    look_again(path)
    return path if is_wanted(path) and not _is_kept() else None


def _is_kept() -> bool:
    """Return whether ``py_compile`` is compiling, whose output may be run outside the campaign."""
    frame = _getframe(2)
    for _ in range(6):
        if frame.f_globals.get("__name__") == "py_compile":
            return True
        if frame.f_back is None:
            return False
        frame = frame.f_back
    return False


def content_of(path: str) -> bytes:
    """Return the content of a file; empty if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError:
        return b""


def _is_same(source: Any, data: bytes) -> bool:
    """Return whether a text is that of a file, regardless of line ends and encoding."""
    if source is data or (isinstance(source, bytes) and source == data):  # ``python -bb`` minds a text there
        return True
    return _decoded(source) == _decoded(data)


def _decoded(source: Any) -> str | None:
    try:
        text = source if isinstance(source, str) else decode_source(bytes(source))
    except (SyntaxError, ValueError, TypeError):
        return None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _bytes_of(source: Any) -> bytes:
    return source.encode("utf-8", "surrogatepass") if isinstance(source, str) else bytes(source)


def _is_instrumented(tree: ast.AST) -> bool:
    """Return whether a tree has been changed before."""
    return hasattr(tree, _CHANGED) or any(
        isinstance(node, ast.Name) and node.id.startswith(_OURS) for node in ast.walk(tree)
    )
