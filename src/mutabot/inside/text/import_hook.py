"""Import hook: program files are compiled with their alternatives in them."""

from __future__ import annotations

import ast
import hashlib
import os
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

from mutabot.model.alternative import Instrumentation, ProgramText

from . import loading, scripts
from .foresee import Forms
from .instrument import MismatchError, forms_of, instrumented
from .sightings import Sightings
from .switches import Alternatives


class _ChangedError(MismatchError):
    """A file is no longer what the plan was made for."""


class ImportHook:
    """The hook for one process.

    Attributes:
        alternatives: the switches of the instrumented text; idle where places are only looked at.
        sightings: what is seen at each place, if places are only looked at; else None.
        imported: files that were instrumented, relative to the root.
        problems: files that were not, with the reason.

    ``on_problem`` is told the file and the reason at once.
    """

    def __init__(
        self,
        root: str,
        instrumentation: Instrumentation,
        on_problem: Callable[[str, str], None] = lambda file, reason: None,
    ) -> None:
        texts = instrumentation.texts
        places = [place for text in texts for place in text.places]
        size = max((place.number for place in places), default=0)
        self.alternatives = Alternatives(size)
        self.alternatives.activate(*instrumentation.active)
        self.imported: list[str] = []
        self.problems: dict[str, str] = {}
        self.sightings: Sightings | None = None
        if instrumentation.record:
            self.sightings = Sightings(size, {place.number: place.text for place in places if place.variable})
        self._places = {place.number: place for place in places}
        self._originals: dict[int, ast.expr] = {}
        self.alternatives.forms = self._forms
        self._texts = {os.path.realpath(os.path.join(root, text.file)): text for text in texts}
        self._real_paths: dict[str, str] = {}
        self._on_problem = on_problem

    def install(self) -> None:
        """Instrument the program's files from now on; files imported before are told as problems."""
        (self.sightings or self.alternatives).install()
        for module in list(sys.modules.values()):
            text = self._text_of(_file_of(module))
            if text is not None:
                self._refuse(text, "it was imported before mutabot could look at it")
        loading.add(self)
        scripts.hook_runpy()

    def remove(self) -> None:
        """Import as ever from now on; text that is instrumented goes on as the original."""
        loading.remove(self)
        (self.sightings or self.alternatives).remove()

    def wants(self, path: str) -> bool:
        """Whether there are alternatives for a file."""
        return self._text_of(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Put the alternatives of a file into its tree. Raises MismatchError if they do not belong there."""
        text = self._text_of(path)
        assert text is not None
        if hashlib.sha256(source).hexdigest() != text.digest:
            raise _ChangedError("it has changed since its mutants were made")
        record = self.sightings is not None
        instrumented(tree, text.places, record=record, originals=self._originals)
        self.imported.append(text.file)

    def give_up(self, path: str, error: Exception) -> None:
        """A file is compiled without its alternatives."""
        text = self._text_of(path)
        assert text is not None
        if text.file in self.imported:
            self.imported.remove(text.file)
        is_known = isinstance(error, _ChangedError)
        self._refuse(text, str(error) if is_known else f"it cannot be instrumented: {error}")

    def _text_of(self, path: str) -> ProgramText | None:
        real = self._real_paths.get(path)
        if real is None:
            real = self._real_paths[path] = os.path.realpath(path)
        return self._texts.get(real)

    def _forms(self, place: int) -> Forms | None:
        original = self._originals.get(place)
        return forms_of(self._places[place], original) if original is not None else None

    def _refuse(self, text: ProgramText, reason: str) -> None:
        self.problems[text.file] = reason
        self._on_problem(text.file, reason)


def _file_of(module: Any) -> str:
    """A module's file; empty if it has none. Modules that are loaded when first used stay asleep."""
    if not isinstance(module, ModuleType):
        return ""
    try:
        file = object.__getattribute__(module, "__dict__").get("__file__")
    except AttributeError:  # libraries of cffi claim to be modules
        return ""
    return file if isinstance(file, str) else ""
