"""Places in program text and what could stand there instead."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import cast

import libcst as cst
from libcst.metadata import MetadataWrapper, ParentNodeProvider, PositionProvider

from mutabot.languages.front_end import front_end_of
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.python import extent_of
from mutabot.model.mutant import Alternative, Extent, ProgramText, Span, TextPlace

from . import registry
from .extension import CONVENTIONAL
from .index import Index, ScopedNode
from .nodes import Extents, is_variable, shortened, shown, surroundings, template
from .operator import ConventionalOperator, Draft

#: characters of the longest expression that is worth an alternative; tables are longer
LONGEST = 1000


def find_texts(
    root: Path, files: Iterable[str], operators: Iterable[str] | None = None, *, first: int = 1
) -> tuple[ProgramText, ...]:
    """The places of these files (relative to ``root``), numbered from ``first`` on over all of them.

    ``operators``: names; all of family ``conventional`` if left out.

    Raises SyntaxError for a file that is no Python, OperatorError for an unknown operator.
    """
    rules = registry.chosen(registry.names(CONVENTIONAL) if operators is None else operators)
    texts: list[ProgramText] = []
    number = first - 1
    for file in files:
        if front_end_of(file) is not PYTHON:
            raise SyntaxError("it is no Python, the only language that has operators on its text")
        source = (root / file).read_bytes()
        index = Index.of(ast.parse(source, file))
        places = list(find_places(source, file, rules, index, first=number + 1))
        number += len(places)
        texts.append(ProgramText(file, sha256(source).hexdigest(), tuple(places), index.declared))
    return tuple(texts)


def find_places(
    source: bytes, file: str, rules: Iterable[ConventionalOperator], index: Index, *, first: int = 1
) -> Iterator[TextPlace]:
    """The places of one file that any of the rules has to do with, in the order of the text."""
    finder = _Finder(_decoded(source), file, list(rules), index)
    finder.wrapper.visit(finder)
    counts: dict[tuple[str, str, str], int] = {}
    number = first
    for seed in sorted(finder.seeds, key=_order):
        place = seed.place(number, file, finder.extents)
        key = (place.span.function, place.node, place.text)
        counts[key] = counts.get(key, 0) + 1
        yield replace(place, occurrence=counts[key])
        number += 1


@dataclass(slots=True)
class _Seed:
    """A place in the making."""

    found: ScopedNode
    extent: Extent
    variable: bool
    kept: list[Extent] = field(default_factory=list)
    alternatives: list[Alternative] = field(default_factory=list)

    def place(self, number: int, file: str, extents: Extents) -> TextPlace:
        text = extents.segment(self.extent)
        statement = isinstance(self.found.node, ast.stmt)
        scope = self.found.scope
        return TextPlace(
            number=number,
            span=Span(file, *self.extent, scope.name),
            text=shortened(text.splitlines()[0] if statement else text),
            occurrence=1,
            node=type(self.found.node).__name__,
            statement=statement,
            kept=tuple(self.kept),
            alternatives=tuple(self.alternatives),
            variable=self.variable,
            at_import=scope.at_import,
        )


def _order(seed: _Seed) -> tuple[int, int, int, int]:
    line, column, end_line, end_column = seed.extent
    return (line, column, -end_line, -end_column)  # what is around something comes first


class _Finder(cst.CSTVisitor):
    METADATA_DEPENDENCIES = (PositionProvider, ParentNodeProvider)

    def __init__(self, text: str, file: str, rules: list[ConventionalOperator], index: Index) -> None:
        super().__init__()
        self.wrapper = MetadataWrapper(cst.parse_module(text), unsafe_skip_copy=True)
        ranges = self.wrapper.resolve(PositionProvider)
        # positions are simple code ranges unless asked for lazily
        self.extents = Extents(text, cast("dict[cst.CSTNode, cst.metadata.CodeRange]", ranges))
        self.seeds: list[_Seed] = []
        self._rules = rules
        self._index = index
        self._variables = any(rule.asks_variables for rule in rules)
        self._elifs: set[cst.CSTNode] = set()

    def on_visit(self, node: cst.CSTNode) -> bool:
        if isinstance(node, cst.Annotation):
            return False
        if isinstance(node, cst.If) and isinstance(node.orelse, cst.If):
            self._elifs.add(node.orelse)
        if isinstance(node, cst.BaseExpression | cst.BaseStatement | cst.BaseSmallStatement):
            self._look_at(node)
        return True

    def _look_at(self, node: cst.CSTNode) -> None:
        around = surroundings(node, self._parent)
        drafts = [(rule, draft) for rule in self._rules for draft in rule.drafts(node, around)]
        variable = self._variables and is_variable(node, around)
        if (not drafts and not variable) or node in self._elifs:
            return
        found = self._found(node)
        if found is None:
            return
        extent = extent_of(found.node)
        if isinstance(found.node, ast.expr) and len(self.extents.segment(extent)) > LONGEST:
            return
        seed = _Seed(found, extent, variable and isinstance(found.node, ast.Name))
        for rule, draft in drafts:
            self._add(seed, rule, draft)
        if seed.alternatives or seed.variable:
            self.seeds.append(seed)

    def _parent(self, node: cst.CSTNode) -> cst.CSTNode | None:
        return self.get_metadata(ParentNodeProvider, node, None)

    def _found(self, node: cst.CSTNode) -> ScopedNode | None:
        """The same in ``ast``; None if it is not evaluated."""
        extent = self.extents.of(node)
        if isinstance(node, cst.BaseExpression):
            return self._index.expression(extent)
        return self._index.statements.get(extent[:2])

    def _add(self, seed: _Seed, rule: ConventionalOperator, draft: Draft) -> None:
        nodes = [part for part in draft.parts if not isinstance(part, str)]
        extents = [self.extents.of(node) for node in nodes]
        if any(self._index.expressions.get(extent) is None for extent in extents):
            return
        seed.kept += [extent for extent in extents if extent not in seed.kept]
        made = template(draft.parts, lambda node: seed.kept.index(self.extents.of(node)))
        text = shown(draft.shown or draft.parts, lambda node: self.extents.segment(self.extents.of(node)))
        seed.alternatives.append(
            Alternative(rule.name, draft.variant, made, text, draft.needs, rule.family, draft.raises)
        )


def _decoded(source: bytes) -> str:
    encoding, _ = tokenize.detect_encoding(io.BytesIO(source).readline)
    return source.decode(encoding)
