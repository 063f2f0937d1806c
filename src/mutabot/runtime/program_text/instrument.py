"""Instrument program text: compile it with its alternatives beside the original, in memory only.

Works on ``ast`` nodes and never on text, so lines, columns and names stay the user's. There is no function
around anything, so ``await``, ``yield``, ``:=``, ``super()``, ``locals()``, class bodies and comprehensions
keep their meaning. The original is in the code once; alternatives hold plain copies of the parts they keep,
with the positions these have in the text.

``SessionText`` is the text of a session: which alternatives stand in it, what they did, what was seen of it.
"""

from __future__ import annotations

import ast
import builtins
import copy
import os
import sys
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from types import CodeType, ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from mutabot.languages.python import extent_of, head_size, placed
from mutabot.model.events import NotInstrumented, PlacesReached, TextsSeen
from mutabot.model.mutant import Extent
from mutabot.model.program_text import RUNTIME, Alternative
from mutabot.model.source_units import digest
from mutabot.runtime.activity import Activity
from mutabot.runtime.event_file import EventWriter, Held
from mutabot.runtime.paths import real_path
from mutabot.runtime.processes.environment import listen
from mutabot.runtime.program_text import compiling, loading
from mutabot.runtime.program_text.compiling import content_of
from mutabot.runtime.program_text.prediction import Forms, PredictedForm
from mutabot.runtime.program_text.switches import Alternatives, Sightings

if TYPE_CHECKING:
    from mutabot.model import Instrumentation, ProgramText, TextPlace
    from mutabot.model.job import Job


_ExpressionKey = tuple[str, Extent]
#: expressions by the numbers of their places
_Nodes = dict[int, ast.expr]
_Node = TypeVar("_Node", bound=ast.AST)
_KEPT = Alternative.kept_name(0).partition("0")[0]
#: number of places in a file up to which it pays to find them before anything is changed
_FEW = 20


class MismatchError(ValueError):
    """A place is not where the plan expects it."""


def instrumented(
    tree: ast.Module, places: Iterable[TextPlace], *, record: bool = False, originals: _Nodes | None = None
) -> ast.Module:
    """Change a tree so that its places have all alternatives, or witnesses, and return it.

    ``originals`` takes the expressions at the places as they stand in the text, by number.

    Raises MismatchError if a place cannot be found.
    """
    instrumenter = _Instrumenter(places, record, originals)
    instrumenter.look_near(tree)
    instrumenter.visit(tree)
    instrumenter.check()
    declare_global(tree, RUNTIME)
    return tree


class _Instrumenter(ast.NodeTransformer):
    def __init__(self, places: Iterable[TextPlace], record: bool, originals: _Nodes | None) -> None:
        self._places: dict[_ExpressionKey, TextPlace] = {
            (place.node, place.extent): place for place in places
        }
        self._found: set[_ExpressionKey] = set()
        self._record = record
        self._originals = originals
        self._lines: list[int] | None = None

    def look_near(self, tree: ast.Module) -> None:
        """Restrict the search to statements around the places, if these are few.

        Nodes in f-strings may say wrong lines.
        """
        if len(self._places) <= _FEW:
            lines = sorted({extent[0] for _, extent in self._places})
            nodes = (node for node in _near(tree, lines) if isinstance(node, ast.expr | ast.stmt))
            if self._places.keys() <= {(type(node).__name__, extent_of(node)) for node in nodes}:
                self._lines = lines

    def check(self) -> None:
        """Raise MismatchError unless every place was found."""
        for key in self._places.keys() - self._found:
            span = self._places[key].span
            raise MismatchError(f"there is no {key[0]} at {span.file}:{span.line}:{span.column + 1}")

    def visit(self, node: ast.AST) -> ast.AST | list[ast.stmt]:
        if self._lines is not None and not _is_around(node, self._lines):
            return node
        place = self._place_of(node)
        if place is None:
            return self.generic_visit(node)
        if isinstance(node, ast.stmt):
            return self._statement(node, place)
        assert isinstance(node, ast.expr)
        return self._expression(node, place)

    def _place_of(self, node: ast.AST) -> TextPlace | None:
        is_evaluated = isinstance(getattr(node, "ctx", None), ast.Load | None)
        if not isinstance(node, ast.expr | ast.stmt) or not is_evaluated:
            return None
        key = (type(node).__name__, extent_of(node))
        place = self._places.get(key)
        if place is not None:
            if key in self._found:
                raise MismatchError(f"two nodes {key[0]} at {place.span.file}:{place.span.line}")
            self._found.add(key)
        return place

    def _expression(self, node: ast.expr, place: TextPlace) -> ast.expr:
        if self._record:
            self.generic_visit(node)
            return _seen(node, place, node)
        others = [_filled(_expression(alternative), place, node) for alternative in place.alternatives]
        if not others:
            self.generic_visit(node)
            return node
        if self._originals is not None:
            self._originals[place.number] = copy.deepcopy(node)
        *firsts, tree = others
        for index in reversed(range(len(firsts))):
            tree = placed(ast.IfExp(_is_index(place, index), firsts[index], tree), node)
        tree = _observed(tree, place, node)
        self.generic_visit(node)
        return placed(ast.IfExp(_is_chosen(place), tree, node), node)

    def _statement(self, node: ast.stmt, place: TextPlace) -> list[ast.stmt]:
        if self._record and isinstance(node, ast.AugAssign):  # what is added shows the type
            self.generic_visit(node)
            node.value = _seen(node.value, place, node.value)
            return [node]
        if self._record:
            self.generic_visit(node)
            return [placed(ast.Expr(_seen(ast.Constant(None), place, node)), node), node]
        others = [
            _filled(ast.parse(alternative.template).body[0], place, node)
            for alternative in place.alternatives
        ]
        self.generic_visit(node)
        if not others:
            return [node]
        raising = all(alternative.raises for alternative in place.alternatives)
        chain: list[ast.stmt] = [others[-1]]
        for index in reversed(range(len(others) - 1)):
            chain = [placed(ast.If(_is_index(place, index), [others[index]], chain), node)]
        if raising:
            return [placed(ast.If(_is_chosen(place), chain, []), node), node]
        return [
            placed(
                ast.If(_is_chosen(place), [placed(ast.Expr(_asked(0, "act")), node), *chain], [node]), node
            )
        ]


def _near(node: ast.AST, lines: list[int]) -> Iterator[ast.AST]:
    """Yield the nodes below a node, skipping statements that none of these lines belongs to."""
    for child in ast.iter_child_nodes(node):
        if _is_around(child, lines):
            yield child
            yield from _near(child, lines)


def _is_around(node: ast.AST, lines: list[int]) -> bool:
    """Return whether a statement spans one of these sorted lines; always true for expressions."""
    if not isinstance(node, ast.stmt):
        return True
    first = min([node.lineno, *(decorator.lineno for decorator in getattr(node, "decorator_list", ()))])
    index = bisect_left(lines, first)
    return index < len(lines) and lines[index] <= (node.end_lineno or first)


def _seen(value: ast.expr, place: TextPlace, node: ast.AST) -> ast.expr:
    """Return an expression that notes a place before its value is computed, and shows it to a witness."""
    entered = ast.Call(_switch(0), [ast.Constant(place.number)], [])
    return placed(ast.BoolOp(ast.Or(), [entered, ast.Call(_switch(place.number), [value], [])]), node)


def _observed(other: ast.expr, place: TextPlace, node: ast.expr) -> ast.expr:
    """Return an alternative that reports its value."""
    return placed(_asked(place.number, "became", other), node)


def _switch(number: int) -> ast.expr:
    return ast.Subscript(ast.Name(RUNTIME, ast.Load()), ast.Constant(number), ast.Load())


def _asked(number: int, method: str, *given: ast.expr) -> ast.expr:
    return ast.Call(ast.Attribute(_switch(number), method, ast.Load()), list(given), [])


def _is_chosen(place: TextPlace) -> ast.expr:
    return ast.BoolOp(ast.And(), [_switch(place.number), _asked(place.number, "chosen")])


def _is_index(place: TextPlace, index: int) -> ast.expr:
    actual = ast.Attribute(_switch(place.number), "index", ast.Load())
    return ast.Compare(actual, [ast.Eq()], [ast.Constant(index)])


def _expression(alternative: Alternative) -> ast.expr:
    return ast.parse(alternative.template, mode="eval").body


def _filled(made: _Node, place: TextPlace, node: ast.AST, *, observed: bool = True) -> _Node:
    """Return a template at the position of its place, with the kept parts inserted.

    ``observed``: whether the value of the whole original is reported, where a template keeps it.
    """
    if not place.kept:
        return _moved(made, node)
    wanted = set(place.kept)
    parts: dict[Extent, ast.expr] = {}
    for part in ast.walk(node):
        if isinstance(part, ast.expr) and extent_of(part) in wanted:
            parts.setdefault(extent_of(part), part)
    missing = wanted - parts.keys()
    if missing:
        raise MismatchError(f"{place.span.file}: no expression at {min(missing)}")
    filler = _Filler({Alternative.kept_name(index): parts[extent] for index, extent in enumerate(place.kept)})
    if observed and isinstance(node, ast.expr) and place.extent in parts:
        whole = placed(_asked(place.number, "was", parts[place.extent]), node)
        filler.parts[Alternative.kept_name(place.kept.index(place.extent))] = whole
    result: _Node = filler.visit(_moved(made, node))
    return result


class _Filler(ast.NodeTransformer):
    def __init__(self, parts: dict[str, ast.expr]) -> None:
        self.parts = parts

    def visit_Name(self, node: ast.Name) -> ast.expr:  # the name that ast looks for
        return copy.deepcopy(self.parts[node.id]) if node.id.startswith(_KEPT) else node


def _moved(made: _Node, node: ast.AST) -> _Node:
    for part in ast.walk(made):
        if hasattr(part, "lineno"):
            ast.copy_location(part, node)
    return made


def is_switch(test: ast.expr) -> bool:
    """Return whether an expression is a condition of the instrumentation, before an original."""
    if isinstance(test, ast.BoolOp):
        test = test.values[0]
    return is_instrumentation(test.left if isinstance(test, ast.Compare) else test)


def is_instrumentation(function: ast.expr) -> bool:
    """Return whether a function is part of the instrumentation."""
    while isinstance(function, ast.Attribute | ast.Subscript):
        function = function.value
    return isinstance(function, ast.Name) and function.id == RUNTIME


def declare_global(tree: ast.Module, name: str) -> None:
    """Declare a name as global, so that class bodies and modules skip their own namespace."""
    for node in [tree, *_statements(tree)]:
        if isinstance(node, ast.Module | ast.ClassDef) and node.body:
            position = head_size(node.body)
            near = node.body[min(position, len(node.body) - 1)]
            node.body.insert(position, placed(ast.Global([name]), near))


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """Yield all statements below a node, without entering expressions."""
    for name in ("body", "handlers", "cases", "orelse", "finalbody"):
        for statement in getattr(node, name, ()):
            if isinstance(statement, ast.stmt):
                yield statement
            yield from _statements(statement)


class _ChangedError(MismatchError):
    """A file is no longer the one that the plan was made for."""


_CHANGED = "it has changed since its mutants were made"
_ELSEWHERE = "its code is not compiled from its text here, but read from elsewhere, such as a .pyc file"
_OTHER = "other text than the file holds is compiled under its name"


class SessionText:
    """Compiles program files with their alternatives, or with witnesses that note their values.

    What happens while the program is imported, before any test, holds for every test after it: each test
    counts it as its own. See ``compiling.SourceStep``.

    Args:
        root: absolute path of the project.
        instrumentation: what is to stand in the text.
        writer: where reports go; a copy of a fork server gets its own.
        on_act: called when the active alternative changes something for the first time in a test.

    Attributes:
        alternatives: the switches of the instrumented text; idle where places are only looked at.
        sightings: what is seen at each place, if places are only looked at; else None.
        imported: files that were instrumented, relative to the root.
        problems: files that were not, with the reason.
    """

    def __init__(
        self,
        root: str,
        instrumentation: Instrumentation,
        writer: EventWriter | None = None,
        on_act: Callable[[], None] = lambda: None,
    ) -> None:
        texts = instrumentation.texts
        self._places = {place.number: place for text in texts for place in text.places}
        size = max(self._places, default=0)
        self.alternatives = Alternatives(size)
        self.alternatives.forms = cache(self._forms)
        self.alternatives.on_act = on_act
        self.sightings: Sightings | None = None
        if instrumentation.record:
            self.sightings = Sightings(size, self._places)
        self.writer: EventWriter = writer or Held()
        self.imported: list[str] = []
        self.problems: dict[str, str] = {}
        self._originals: _Nodes = {}
        self._texts = {os.path.realpath(os.path.join(root, text.file)): text for text in texts}
        self._test: str | None = None

    @classmethod
    def of(cls, job: Job, writer: EventWriter, on_act: Callable[[], None]) -> SessionText | None:
        """Instrument the program from now on; return None if the job has no places in its text."""
        if job.instrumentation is None:
            return None
        text = cls(job.root, job.instrumentation, writer, on_act)
        text.install()
        return text

    def install(self) -> None:
        """Instrument the program's files from now on; report files that were imported before."""
        setattr(builtins, RUNTIME, (self.sightings or self.alternatives).switches)
        for module in list(sys.modules.values()):
            text = self._text_of(_file_of(module))
            if text is not None:
                self._refuse(text, "it was imported before mutabot could look at it")
        loading.add(self)
        loading.hook_pytest_first(self)
        listen(("exec",), self._on_audit_event)

    def leave_out(self, file: str) -> None:
        """Compile a file, given by its path in the project, as it stands from now on."""
        self._texts = {path: text for path, text in self._texts.items() if text.file != file}

    def wants(self, path: str) -> bool:
        """Return whether there are alternatives for a file."""
        return self._text_of(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Put the alternatives of a file into its tree. Raises MismatchError if they do not belong there."""
        text = self._text_of(path)
        assert text is not None
        if digest(source) != text.digest:
            raise _ChangedError(_CHANGED if digest(content_of(path)) != text.digest else _OTHER)
        record = self.sightings is not None
        instrumented(tree, text.places, record=record, originals=self._originals)
        self.imported.append(text.file)

    def give_up(self, path: str, error: Exception) -> None:
        """Note that a file is compiled without its alternatives."""
        text = self._text_of(path)
        assert text is not None
        if text.file in self.imported:
            self.imported.remove(text.file)
        is_known = isinstance(error, _ChangedError)
        self._refuse(text, str(error) if is_known else f"it cannot be instrumented: {error}")

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Note that a module is executed, whose text may have been compiled elsewhere."""
        code = arguments[0]
        if not isinstance(code, CodeType) or code.co_name != "<module>":
            return
        text = self._text_of(code.co_filename)
        is_known = text is None or text.file in self.imported or text.file in self.problems
        if text is not None and not is_known and self in compiling.steps:
            self._refuse(text, _ELSEWHERE)

    def _text_of(self, path: str) -> ProgramText | None:
        return self._texts.get(real_path(path))

    def _forms(self, number: int) -> Forms | None:
        """Return the original and the alternatives of a place, for prediction; None if there are none."""
        original = self._originals.get(number)
        if original is None:
            return None
        place = self._places[number]
        others = [
            _filled(_expression(alternative), place, original, observed=False)
            for alternative in place.alternatives
        ]
        return Forms(PredictedForm(original), tuple(map(PredictedForm, others)))

    def _refuse(self, text: ProgramText, reason: str) -> None:
        self.problems[text.file] = reason
        self.writer.send(NotInstrumented(text.file, reason))

    def start_test(self, test: str) -> None:
        """Begin a test."""
        if self._test is None:  # what happened before any test
            if self.sightings is not None:
                self._report_reached()
            self.alternatives.keep()
        self._test = test
        (self.sightings or self.alternatives).start()

    def watch(
        self, on_place: Callable[[int, frozenset[int]], None], live: Mapping[int, frozenset[int]]
    ) -> None:
        """Call ``on_place`` with the ``live`` alternatives that may differ, in a fork parent."""
        self.alternatives.on_place = on_place
        self.alternatives.watch(live)

    def end_test(self) -> None:
        """End the test."""
        if self.sightings is not None:
            self._report_reached()
        elif self.alternatives.on_place is not None and self.alternatives.active is None:
            self.alternatives.watch({})  # what is reached between tests belongs to none

    def finish(self, others: Iterable[TextsSeen] = ()) -> None:
        """Report, after all tests, what was observed here and in processes below (``others``)."""
        if self.sightings is not None:
            others = list(others)
            self._note_unseen()
            imported = dict.fromkeys([*self.imported, *(file for other in others for file in other.imported)])
            seen = [*self.sightings.seen(), *(seen for other in others for seen in other.sightings)]
            self.writer.send(TextsSeen(tuple(imported), tuple(seen)))

    def _note_unseen(self) -> None:
        """Report files that were imported without being compiled here."""
        for module in list(sys.modules.values()):
            text = self._text_of(_file_of(module))
            if text is not None and text.file not in {*self.imported, *self.problems}:
                loader = getattr(module, "__loader__", None)
                self._refuse(text, f"{loading.UNSEEN} ({loading.loader_name(loader)})")

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        return Activity(
            hits=self.alternatives.hits.get(self.alternatives.place, 0),
            acted=self.alternatives.acted,
            example=self.alternatives.example,
        )

    def _report_reached(self) -> None:
        assert self.sightings is not None
        self.writer.send(PlacesReached(self._test or "", tuple(sorted(self.sightings.entered))))


def _file_of(module: Any) -> str:
    """Return a module's file; empty if it has none. Lazily loaded modules are not loaded."""
    if not isinstance(module, ModuleType):
        return ""
    try:
        file = object.__getattribute__(module, "__dict__").get("__file__")
    except AttributeError:  # libraries of cffi claim to be modules
        return ""
    return file if isinstance(file, str) else ""
