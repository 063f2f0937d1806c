"""Compile program files with their alternatives, or with witnesses that note which values occur.

In a baseline the text of a place ``E`` with number ``p`` becomes ``__mutabot__[0](p) or __mutabot__[p](E)``:
the first call notes that the place is reached, whatever becomes of ``E``. A place is examined a few times per
test; from then on the function there passes the value through, as cheaply as a call can.
"""

from __future__ import annotations

import ast
import builtins
import hashlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from types import FrameType, ModuleType
from typing import Any

from mutabot.model.mutant import RUNTIME, Instrumentation, ProgramText, Sighting
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text.foresee import Forms
from mutabot.runtime.program_text.instrument import MismatchError, forms_of, instrumented
from mutabot.runtime.program_text.switches import Alternatives, is_variable, kind_of

#: evaluations per test at which a place is looked at
LOOKS = 20
#: the same for the variables around a variable, which takes longer
LOOKS_AROUND = 3


def hand_through(value: Any) -> Any:
    """What stands at places that have been looked at often enough."""
    return value


class Sightings:
    """All places of the program, and what was seen there.

    Attributes:
        entered: places that were reached since the start of the test.
        switches: what instrumented program text calls, by number of the place; item 0 notes what is reached.
    """

    def __init__(self, size: int, variables: Mapping[int, str]) -> None:
        """``size``: the largest number of a place; ``variables``: names of the places that are variables."""
        self._witnesses = [_Witness(self, place, variables.get(place)) for place in range(1, size + 1)]
        self.entered: set[int] = set()
        self._on_first: Callable[[int], None] | None = None
        self.switches: list[Callable[[Any], Any]] = [self.entered.add, *self._witnesses]

    def tell_first(self, on_first: Callable[[int], None]) -> None:
        """Tell of each place when it is reached for the first time since the start of a test."""
        self._on_first = on_first
        self.switches[0] = self._enter

    def _enter(self, place: int) -> None:
        if place not in self.entered:
            self.entered.add(place)
            if self._on_first is not None:
                self._on_first(place)

    def install(self) -> None:
        """Let instrumented program text find its switches."""
        setattr(builtins, RUNTIME, self.switches)

    def remove(self) -> None:
        """Look no more."""
        self.switches[1:] = [hand_through] * len(self._witnesses)

    def start(self) -> None:
        """A new test begins: look at every place anew."""
        self.entered.clear()
        for witness in self._witnesses:
            witness.looks = witness.looks_around = 0
        self.switches[1:] = self._witnesses

    def reached(self) -> frozenset[int]:
        """Places that were reached since the start of the test."""
        return frozenset(self.entered)

    def seen(self) -> tuple[Sighting, ...]:
        """What was seen so far, over all tests, by place."""
        return tuple(witness.sighting() for witness in self._witnesses if witness.hits)


class _Witness:
    """Looks at one place.

    Attributes:
        place: its number.
        looks, looks_around: since the start of the test.
        hits: evaluations that were looked at, over all tests.
    """

    def __init__(self, owner: Sightings, place: int, variable: str | None) -> None:
        self._owner, self.place, self._variable = owner, place, variable
        self.hits = self.looks = self.looks_around = 0
        self._types: set[type] = set()
        self._kinds: set[str] = set()
        self._variables: set[str] | None = None

    def __call__(self, value: Any) -> Any:
        self.hits += 1
        self.looks += 1
        if self.looks >= LOOKS:
            self._owner.switches[self.place] = hand_through
        kind = type(value)
        if kind not in self._types:
            self._types.add(kind)
            self._kinds.add(kind_of(value))
            self.looks_around = 0
        if self._variable is not None and self.looks_around < LOOKS_AROUND:
            self.looks_around += 1
            self._look_around(value, sys._getframe(1))
        return value

    def sighting(self) -> Sighting:
        """What was seen."""
        kinds, variables = sorted(self._kinds), sorted(self._variables or ())
        return Sighting(self.place, self.hits, tuple(kinds), tuple(variables))

    def _look_around(self, value: Any, frame: FrameType) -> None:
        names = set(_alike(value, frame)) - {self._variable} if is_variable(value) else set()
        self._variables = names if self._variables is None else self._variables & names


def _alike(value: Any, frame: FrameType) -> Iterator[str]:
    """Names around a frame's instruction with a value of exactly this type.

    Of the function's own names and the module's: to mention a name of a function further out would make
    it a part of this one. So inside another function only such names of the module count as this one uses,
    since any other could be one of the function around it.
    """
    code = frame.f_code
    own = {*code.co_varnames, *code.co_cellvars, *code.co_freevars}
    allowed = code.co_names if "<locals>" in code.co_qualname else frame.f_globals
    others = [one for one in list(frame.f_globals.items()) if one[0] in allowed and one[0] not in own]
    for name, other in [*list(frame.f_locals.items()), *others]:
        # comprehensions have names of their own, which are no identifiers
        if type(other) is type(value) and name.isidentifier() and not name.startswith("__"):
            yield name


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
        loading.hook_runpy()

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
