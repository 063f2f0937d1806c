"""Import hook: program files are compiled with their alternatives in them.

Every way to import a source file asks ``SourceFileLoader.get_code`` for the code: the import statement,
``importlib``, ``runpy.run_module``. That is where the hook sits; loader, spec and module stay what they
are without it. No compiled file is read or written for an instrumented module.
"""

from __future__ import annotations

import ast
import hashlib
import os
import sys
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from types import CodeType, ModuleType
from typing import Any, cast

from mutabot.model.alternative import Instrumentation, ProgramText

from .foresee import Forms
from .instrument import MismatchError, compile_text, forms_of
from .sightings import Recording
from .switches import Alternatives

GetCode = Callable[[SourceFileLoader, str], CodeType | None]


class ImportHook:
    """The hook for one process.

    Attributes:
        alternatives: the switches of the instrumented text; idle in a recording.
        recording: what was seen, if this is a recording; else None.
        imported: files that were instrumented, relative to the root.
        problems: files that were not, with the reason.

    ``on_problem`` is told the file and the reason at once; ``finish`` may change the tree of a file at last.
    """

    def __init__(
        self,
        root: str,
        instrumentation: Instrumentation,
        on_problem: Callable[[str, str], None] = lambda file, reason: None,
        finish: Callable[[ast.Module, str], None] = lambda tree, path: None,
    ) -> None:
        texts = instrumentation.texts
        places = [place for text in texts for place in text.places]
        size = max((place.number for place in places), default=0)
        self.alternatives = Alternatives(size)
        self.alternatives.activate(*instrumentation.active)
        self.imported: list[str] = []
        self.problems: dict[str, str] = {}
        self.recording: Recording | None = None
        if instrumentation.record:
            self.recording = Recording(size, {place.number: place.text for place in places if place.variable})
        self._places = {place.number: place for place in places}
        self._originals: dict[int, ast.expr] = {}
        self.alternatives.forms = self._forms
        self._texts = {os.path.realpath(os.path.join(root, text.file)): text for text in texts}
        self._real_paths: dict[str, str] = {}
        self._original: GetCode | None = None
        self._on_problem = on_problem
        self._finish = finish

    def install(self) -> None:
        """Instrument the program's files from now on; files imported before are told as problems."""
        (self.recording or self.alternatives).install()
        for module in list(sys.modules.values()):
            text = self._text_of(_file_of(module))
            if text is not None:
                self._refuse(text, "it was imported before mutabot could look at it")
        # get_code is inherited; it is put where the inherited one is found last
        self._original = cast(GetCode, SourceFileLoader.get_code)
        original, hook = self._original, self

        def get_code(self: SourceFileLoader, fullname: str) -> CodeType | None:
            path = self.get_filename(fullname)
            text = hook._text_of(path)
            if text is None:
                return original(self, fullname)
            return hook._compiled(text, self.get_data(path), path) or original(self, fullname)

        SourceFileLoader.get_code = get_code  # type: ignore[method-assign, assignment]

    def remove(self) -> None:
        """Import as ever from now on; text that is instrumented goes on as the original."""
        if self._original is not None:
            if "get_code" in vars(SourceFileLoader):
                del SourceFileLoader.get_code
            self._original = None
        (self.recording or self.alternatives).remove()

    def _text_of(self, path: str) -> ProgramText | None:
        real = self._real_paths.get(path)
        if real is None:
            real = self._real_paths[path] = os.path.realpath(path)
        return self._texts.get(real)

    def _compiled(self, text: ProgramText, source: bytes, path: str) -> CodeType | None:
        if hashlib.sha256(source).hexdigest() != text.digest:
            self._refuse(text, "it has changed since its mutants were made")
            return None
        try:
            record = self.recording is not None

            def finish(tree: ast.Module) -> None:
                self._finish(tree, path)

            code = compile_text(source, path, text, record=record, originals=self._originals, finish=finish)
        except (MismatchError, RecursionError, SyntaxError, ValueError) as error:
            self._refuse(text, f"it cannot be instrumented: {error}")
            return None
        self.imported.append(text.file)
        return code

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
    file = object.__getattribute__(module, "__dict__").get("__file__")
    return file if isinstance(file, str) else ""
