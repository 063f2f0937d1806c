"""Code of the program that tests run from a text of their own: all of it, or functions taken over from it.

``exec(Path("program.py").read_text())`` runs code whose file is ``<string>``, and a test may change a text of
the program before it runs it, or take one function by ``inspect.getsource``. What the program's files hold as
well, compiled, is the program: it is mutated at the same places. Where it stands in the text is of no matter.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from sys import _getframe
from types import CodeType, FrameType
from typing import Any

from mutabot.runtime.paths import is_young, program_texts
from mutabot.runtime.processes.environment import listen
from mutabot.runtime.program_text.compiling import INHERITED, compile_plainly

#: by the identity of code, which is kept beside it, the equal code of a file of the program
executed: dict[int, tuple[CodeType, CodeType]] = {}
#: what equal code has in common: all but its file, and where in that it stands
_SAME = (
    "co_code", "co_name", "co_names", "co_varnames", "co_freevars", "co_cellvars", "co_argcount",
    "co_posonlyargcount", "co_kwonlyargcount", "co_flags", "co_exceptiontable",
)  # fmt: skip


def original_code(code: CodeType) -> CodeType:
    """Return the code of the program that this is equal to, if it was run from a text; else the code."""
    known = executed.get(id(code))
    return code if known is None else known[1]


def file_of(code: CodeType) -> str:
    """Return the name of the file that code comes from."""
    return original_code(code).co_filename


def install() -> None:
    """Look at all text that is being run, by this thread, or is run from now on."""
    listen(("exec",), lambda event, arguments: look_at(arguments[0]))
    frame: FrameType | None = _getframe()
    while frame is not None:
        look_at(frame.f_code)
        frame = frame.f_back


def look_at(code: Any) -> None:
    """Find out of code that is run which parts of it come from the program."""
    if not isinstance(code, CodeType) or code.co_name != "<module>" or not is_young(code.co_filename):
        return
    if all(name.startswith("__") for name in code.co_names):  # what dataclasses and the like define
        return
    originals = list(_originals(code))
    for part in _parts(code):
        same = [found for found in originals if found.co_name == part.co_name and _is_same(part, found)]
        exact = [found for found in same if found.co_qualname == part.co_qualname]
        if not exact and not part.co_name.startswith("<"):
            exact = same  # a method taken out of its class
        if len(exact) == 1 and id(part) not in executed:  # of several, it is unknown which it was
            pairs = zip(_parts(part), _parts(exact[0]), strict=True)
            executed.update((id(mine), (mine, yours)) for mine, yours in pairs)


def _originals(code: CodeType) -> Iterator[CodeType]:
    """Yield the code of all files of the program from which parts of this code may come, and its parts."""
    for path, text in program_texts():
        if any(_may_be_of(part, text) for part in _parts(code)):
            with suppress(SyntaxError, ValueError):
                yield from _parts(compile_plainly(text, path, code.co_flags & INHERITED))


def _may_be_of(code: CodeType, text: str) -> bool:
    name = () if code.co_name.startswith("<") else (code.co_name,)
    return all(word in text for word in (*name, *code.co_names))


def _is_same(one: CodeType, other: CodeType) -> bool:
    if any(getattr(one, name) != getattr(other, name) for name in _SAME):
        return False
    mine, yours = one.co_consts, other.co_consts
    return len(mine) == len(yours) and all(map(_is_same_constant, mine, yours))


def _is_same_constant(one: Any, other: Any) -> bool:
    if isinstance(one, CodeType) and isinstance(other, CodeType):
        return _is_same(one, other)
    return type(one) is type(other) and bool(one == other)


def _parts(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _parts(constant)
