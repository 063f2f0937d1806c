"""Whose call it is, and exactly where it stands: from the frames of the running program."""

from __future__ import annotations

import os
from types import CodeType, FrameType

from mutabot.languages.front_end import Position
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.registry import front_ends
from mutabot.model import Role, Span


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
        # By the identity of code: the code of equal functions in two files is equal, though they are two
        # places. It is kept beside its span, so that no other code can get its address.
        self._spans: dict[tuple[int, int], tuple[Span, CodeType]] = {}
        # every other frame is Python's: asking its front end for each would cost each call
        self._interpreted = [one for one in front_ends() if one is not PYTHON]
        self._real: dict[str, str] = {}

    def locate(self, frame: FrameType | None) -> tuple[Span, Role] | None:
        """Span and role of the call that is running in ``frame`` or the nearest frame around it."""
        interpreted = self._interpreted
        while frame is not None:
            if interpreted:
                found = self._in_interpreter(frame)
                if found is not None:
                    return found
            role = self.role(frame.f_code.co_filename)
            if role is not None:
                return self._span(frame), role
            frame = frame.f_back
        return None

    def locate_definition(self, code: CodeType) -> tuple[Span, Role] | None:
        """Span and role of a function's definition; None for one of neither the program nor the oracle."""
        role = self.role(code.co_filename)
        if role is None:
            return None
        return self._span_at(code.co_filename, PYTHON.definition_of(code)), role

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

    def _in_interpreter(self, frame: FrameType) -> tuple[Span, Role] | None:
        """The same for a frame in which an interpreter carries out a file of the program or the oracle."""
        for front_end in self._interpreted:
            filename = front_end.file_of(frame)
            role = self.role(filename) if filename is not None else None
            if filename is not None and role is not None:
                return self._span_at(filename, front_end.position_of(frame)), role
        return None

    def _span(self, frame: FrameType) -> Span:
        code = frame.f_code
        key = (id(code), frame.f_lasti)
        known = self._spans.get(key)
        if known is None:
            span = self._span_at(code.co_filename, PYTHON.position_of(frame))
            known = self._spans[key] = (span, code)
        return known[0]

    def _span_at(self, filename: str, position: Position) -> Span:
        return Span(self.relative(filename), *position.extent, position.function)
