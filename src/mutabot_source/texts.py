"""Finds the places in program text that operators can change, and their alternatives."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from importlib.util import decode_source
from itertools import chain
from pathlib import Path

from mutabot.api.faults import Alternative, ProgramText, Site, TextPlace

from . import registry
from .extension import CONVENTIONAL
from .index import Index, ScopedNode, TextExtent, extent_of
from .nodes import ModuleTree, is_variable, shortened, template, to_source
from .operator import ConventionalOperator, Draft

#: characters of the longest expression that is worth an alternative; tables are longer
LONGEST = 1000


def find_texts(
    root: Path, files: Iterable[str], operators: Iterable[str] | None = None, *, first: int = 1
) -> tuple[ProgramText, ...]:
    """Return the places of these files (relative to ``root``), numbered consecutively from ``first``.

    ``operators``: names; all of family ``conventional`` if left out.

    Raises SyntaxError for a file that is no Python, LookupError for an unknown operator.
    """
    rules = registry.select(registry.names(CONVENTIONAL) if operators is None else operators)
    texts: list[ProgramText] = []
    number = first - 1
    for file in files:
        source = (root / file).read_bytes()
        places, index = find_places(source, file, rules, first=number + 1)
        number += len(places)
        texts.append(ProgramText.of(file, source, places, index.declared))
    return tuple(texts)


def find_places(
    source: bytes, file: str, rules: Iterable[ConventionalOperator], *, first: int = 1
) -> tuple[list[TextPlace], Index]:
    """Return the places of one file that the rules can change, in the order of the text, and its index."""
    tree = ast.parse(source, file)
    index = Index.of(tree)
    finder = _TextFinder(ModuleTree(decode_source(source), tree), list(rules), index)
    counts: Counter[tuple[str, str, str]] = Counter()
    places: list[TextPlace] = []
    for number, seed in enumerate(sorted(finder.seeds(), key=_order), first):
        place = seed.place(number, file, finder.tree)
        key = (place.span.function, place.node, place.text)
        counts[key] += 1
        places.append(replace(place, occurrence=counts[key]))
    return places, index


@dataclass(slots=True)
class _Seed:
    """A place that is being built."""

    found: ScopedNode
    extent: TextExtent
    variable: bool
    kept: list[TextExtent] = field(default_factory=list)
    alternatives: list[Alternative] = field(default_factory=list)

    def place(self, number: int, file: str, tree: ModuleTree) -> TextPlace:
        text = tree.segment(self.extent)
        statement = isinstance(self.found.node, ast.stmt)
        scope = self.found.scope
        shown_text = shortened(text.splitlines()[0] if statement else text)
        site = Site.in_program(file, self.extent, scope.name, shown_text)
        return TextPlace(
            number=number,
            span=site.span,
            text=site.text,
            occurrence=site.occurrence,
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


class _TextFinder:
    def __init__(self, tree: ModuleTree, rules: list[ConventionalOperator], index: Index) -> None:
        self.tree = tree
        self._rules = rules
        self._index = index
        self._variables = any(rule.asks_variables for rule in rules)

    def seeds(self) -> Iterator[_Seed]:
        """Yield the places; a statement comes before the expression that it consists of."""
        for found in chain(self._index.statements.values(), self._index.read()):
            seed = self._seed(found)
            if seed is not None:
                yield seed

    def _seed(self, found: ScopedNode) -> _Seed | None:
        node = found.node
        around = self.tree.surroundings(node, found.scope)
        drafts = [(rule, draft) for rule in self._rules for draft in rule.drafts(node, around)]
        variable = self._variables and is_variable(node, around)
        if (not drafts and not variable) or self.tree.is_elif(node) or not self.tree.has_valid_extent(node):
            return None
        extent = extent_of(node)
        if isinstance(node, ast.expr) and len(self.tree.segment(extent)) > LONGEST:
            return None
        seed = _Seed(found, extent, variable)
        for rule, draft in drafts:
            self._add(seed, rule, draft)
        return seed if seed.alternatives or seed.variable else None

    def _add(self, seed: _Seed, rule: ConventionalOperator, draft: Draft) -> None:
        extents = [extent_of(part) for part in draft.parts if not isinstance(part, str)]
        if any(self._index.expressions.get(extent) is None for extent in extents):
            return
        seed.kept += [extent for extent in extents if extent not in seed.kept]
        made = template(draft.parts, lambda node: seed.kept.index(extent_of(node)))
        text = to_source(draft.shown or draft.parts, lambda node: self.tree.segment(extent_of(node)))
        seed.alternatives.append(
            Alternative(rule.name, draft.variant, made, text, draft.needs, rule.family, draft.raises)
        )
