"""Which file of the program is run where its text is handed to ``exec``, and so has no file of its own.

The code of ``exec(Path("program.py").read_text())`` has the file name ``<string>``, like that of dataclasses
and named tuples. What is run is the program all the same if the file, compiled, is equal code.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import CodeType
from typing import Any

from mutabot.runtime.paths import program_texts
from mutabot.runtime.processes.environment import listen
from mutabot.runtime.program_text.compiling import INHERITED, compile_plainly

#: by the identity of code, which is kept beside it: equal code may come from elsewhere
executed: dict[int, tuple[CodeType, str]] = {}


def file_of(code: CodeType) -> str:
    """Return the name of the file that code comes from."""
    known = executed.get(id(code))
    return code.co_filename if known is None else known[1]


def install() -> None:
    """Look at all text that is run from now on."""
    listen(("exec",), _on_audit_event)


def _on_audit_event(event: str, arguments: tuple[Any, ...]) -> None:
    code = arguments[0]
    if not isinstance(code, CodeType) or code.co_name != "<module>" or not code.co_filename.startswith("<"):
        return
    if all(name.startswith("__") for name in code.co_names):  # what dataclasses and the like define
        return
    path = next((path for path, text in program_texts() if _is_of(code, text)), None)
    if path is not None:
        executed.update((id(part), (part, path)) for part in _parts(code))


def _is_of(code: CodeType, text: str) -> bool:
    if not all(name in text for name in code.co_names):
        return False
    try:
        return code == compile_plainly(text, code.co_filename, code.co_flags & INHERITED)
    except (SyntaxError, ValueError):
        return False


def _parts(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _parts(constant)
