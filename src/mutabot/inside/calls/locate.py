"""Whose call it is, and exactly where it stands: from the frames of the running program."""

from __future__ import annotations

import os
from types import CodeType, FrameType

from mutabot.model import Role, Span

#: code objects that are part of the function around them
_COMPREHENSIONS = (
    ".<locals>.<listcomp>",
    ".<locals>.<setcomp>",
    ".<locals>.<dictcomp>",
    ".<locals>.<genexpr>",
)


class Locator:
    """Finds the nearest frame that lies in the configured program or oracle paths.

    Args:
        root: absolute path of the project.
        program, oracle: files and folders, relative to the root.
    """

    def __init__(self, root: str, program: tuple[str, ...], oracle: tuple[str, ...]) -> None:
        self._root = os.path.realpath(root)
        # Longer paths first: a file named as oracle inside a program folder is oracle.
        places = [(self._absolute(path), Role.PROGRAM) for path in program]
        places += [(self._absolute(path), Role.ORACLE) for path in oracle]
        self._places = sorted(places, key=lambda place: -len(place[0]))
        self._roles: dict[str, Role | None] = {}
        self._spans: dict[tuple[CodeType, int], Span] = {}
        self._real: dict[str, str] = {}

    def locate(self, frame: FrameType | None) -> tuple[Span, Role] | None:
        """Span and role of the call that is running in ``frame`` or the nearest frame around it."""
        while frame is not None:
            role = self.role(frame.f_code.co_filename)
            if role is not None:
                return self._span(frame.f_code, frame.f_lasti), role
            frame = frame.f_back
        return None

    def role(self, filename: str) -> Role | None:
        """Whose file it is; None for files of neither."""
        try:
            return self._roles[filename]
        except KeyError:
            role = self._roles[filename] = self._find_role(self.real(filename))
            return role

    def relative(self, filename: str) -> str:
        """The path relative to the root, with forward slashes."""
        return os.path.relpath(self.real(filename), self._root).replace(os.sep, "/")

    def real(self, filename: str) -> str:
        """The path without symbolic links; looked up once."""
        path = self._real.get(filename)
        if path is None:
            path = self._real[filename] = os.path.realpath(filename)
        return path

    def _find_role(self, path: str) -> Role | None:
        for place, role in self._places:
            if path == place or path.startswith(place + os.sep):
                return role
        return None

    def _absolute(self, path: str) -> str:
        return os.path.realpath(os.path.join(self._root, path))

    def _span(self, code: CodeType, instruction: int) -> Span:
        key = (code, instruction)
        span = self._spans.get(key)
        if span is None:
            span = self._spans[key] = self._new_span(code, instruction)
        return span

    def _new_span(self, code: CodeType, instruction: int) -> Span:
        line, end_line, column, end_column = list(code.co_positions())[instruction // 2]
        function = code.co_qualname
        for suffix in _COMPREHENSIONS:
            function = function.removesuffix(suffix)
        return Span(
            self.relative(code.co_filename),
            line or code.co_firstlineno,
            column or 0,
            end_line or line or code.co_firstlineno,
            end_column or 0,
            function,
        )
