"""Instrumentation: program text compiled with its alternatives beside the original, in memory only.

Works on ``ast`` nodes and never on text, so lines, columns and names stay the user's. There is no function
around anything, so ``await``, ``yield``, ``:=``, ``super()``, ``locals()``, class bodies and comprehensions
keep their meaning. The original is in the code once; alternatives hold plain copies of the parts they keep,
with the positions these have in the text.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterable
from typing import TypeVar

from mutabot.languages.python import extent_of, head_size, placed
from mutabot.model.mutant import RUNTIME, Alternative, Extent, TextPlace, kept_name
from mutabot.runtime.program_text.foresee import ForeseenForm, Forms

_Key = tuple[str, Extent]
_Node = TypeVar("_Node", bound=ast.AST)
#: expressions without effects; attributes and items may be readings of a robot
_PURE = (ast.Name, ast.Constant, ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Tuple)
_KEPT = kept_name(0).partition("0")[0]


class MismatchError(ValueError):
    """A place is not where the plan says."""


def instrumented(
    tree: ast.Module,
    places: Iterable[TextPlace],
    *,
    record: bool = False,
    originals: dict[int, ast.expr] | None = None,
) -> ast.Module:
    """The tree with all alternatives of its places in it, or with witnesses; the tree itself is changed.

    ``originals`` takes the expressions at the places as they stand in the text, by number.

    Raises MismatchError if a place cannot be found.
    """
    instrumenter = _Instrumenter(places, record, originals)
    instrumenter.visit(tree)
    instrumenter.check()
    declare_global(tree, RUNTIME)
    return tree


def forms_of(place: TextPlace, original: ast.expr) -> Forms:
    """The original and the alternatives, for a look ahead; the tree of the original is changed."""
    others = [_filled(_expression(one), place, original, observed=False) for one in place.alternatives]
    return Forms(ForeseenForm(original), tuple(map(ForeseenForm, others)))


class _Instrumenter(ast.NodeTransformer):
    def __init__(
        self, places: Iterable[TextPlace], record: bool, originals: dict[int, ast.expr] | None
    ) -> None:
        self._places: dict[_Key, TextPlace] = {(place.node, place.extent): place for place in places}
        self._found: set[_Key] = set()
        self._record = record
        self._originals = originals

    def check(self) -> None:
        """Every place was met."""
        for key in self._places.keys() - self._found:
            span = self._places[key].span
            raise MismatchError(f"there is no {key[0]} at {span.file}:{span.line}:{span.column + 1}")

    def visit(self, node: ast.AST) -> ast.AST | list[ast.stmt]:
        place = self._place_of(node)
        if place is None:
            return self.generic_visit(node)
        if isinstance(node, ast.stmt):
            return self._statement(node, place)
        assert isinstance(node, ast.expr)
        return self._expression(node, place)

    def _place_of(self, node: ast.AST) -> TextPlace | None:
        if not isinstance(node, ast.expr | ast.stmt) or not isinstance(
            getattr(node, "ctx", None), ast.Load | None
        ):
            return None  # it is not evaluated
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
        others = [_filled(_expression(one), place, node) for one in place.alternatives]
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
        if self._record:
            return self._statement_seen(node, place)
        others = [_filled(ast.parse(one.template).body[0], place, node) for one in place.alternatives]
        self.generic_visit(node)
        if not others:
            return [node]
        raising = all(one.raises for one in place.alternatives)
        tells = ast.Call(ast.Attribute(_switch(0), "tell", ast.Load()), [ast.Constant(place.number)], [])
        chain: list[ast.stmt] = [others[-1]]
        for index in reversed(range(len(others) - 1)):
            chain = [placed(ast.If(_is_index(place, index), [others[index]], chain), node)]
        if raising:
            return [placed(ast.If(_is_chosen(place), chain, []), node), node]
        return [placed(ast.If(_is_chosen(place), [placed(ast.Expr(tells), node), *chain], [node]), node)]

    def _statement_seen(self, node: ast.stmt, place: TextPlace) -> list[ast.stmt]:
        self.generic_visit(node)
        if isinstance(node, ast.AugAssign):  # what is added tells the type
            node.value = _seen(node.value, place, node.value)
            return [node]
        return [placed(ast.Expr(_seen(ast.Constant(None), place, node)), node), node]


def _seen(value: ast.expr, place: TextPlace, node: ast.AST) -> ast.expr:
    """A value that its witness is shown, once it is noted that it is about to be computed."""
    entered = ast.Call(_switch(0), [ast.Constant(place.number)], [])
    return placed(ast.BoolOp(ast.Or(), [entered, ast.Call(_switch(place.number), [value], [])]), node)


def _observed(other: ast.expr, place: TextPlace, node: ast.expr) -> ast.expr:
    """Alternatives that say what they became, and how to compute the original where that has no effect."""
    became = ast.Attribute(_switch(place.number), "became", ast.Load())
    original: list[ast.expr] = [ast.Constant(ast.unparse(node))] if _is_pure(node) else []
    return placed(ast.Call(became, [other, *original], []), node)


def _is_pure(node: ast.expr) -> bool:
    """Whether computing an expression once more has no effect: names, constants and what operators make."""
    return all(isinstance(part, _PURE) for part in ast.walk(node) if isinstance(part, ast.expr))


def _switch(number: int) -> ast.expr:
    return ast.Subscript(ast.Name(RUNTIME, ast.Load()), ast.Constant(number), ast.Load())


def _is_chosen(place: TextPlace) -> ast.expr:
    chosen = ast.Call(ast.Attribute(_switch(place.number), "chosen", ast.Load()), [], [])
    return ast.BoolOp(ast.And(), [_switch(place.number), chosen])


def _is_index(place: TextPlace, index: int) -> ast.expr:
    actual = ast.Attribute(_switch(place.number), "index", ast.Load())
    return ast.Compare(actual, [ast.Eq()], [ast.Constant(index)])


def _expression(alternative: Alternative) -> ast.expr:
    return ast.parse(alternative.template, mode="eval").body


def _filled(made: _Node, place: TextPlace, node: ast.AST, *, observed: bool = True) -> _Node:
    """A template at the position of its place, with the kept parts put in.

    ``observed``: whether the value of the whole original is told, where a template keeps it.
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
    filler = _Filler({kept_name(index): parts[extent] for index, extent in enumerate(place.kept)})
    if observed and isinstance(node, ast.expr) and place.extent in parts:
        was = ast.Attribute(_switch(place.number), "was", ast.Load())
        whole = placed(ast.Call(was, [parts[place.extent]], []), node)
        filler.parts[kept_name(place.kept.index(place.extent))] = whole
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


def is_ours(function: ast.expr) -> bool:
    """Whether what is called was put in here."""
    while isinstance(function, ast.Attribute | ast.Subscript):
        function = function.value
    return isinstance(function, ast.Name) and function.id == RUNTIME


def declare_global(tree: ast.Module, name: str) -> None:
    """Class bodies and modules look names up in their own namespace first; spare them that."""
    for node in list(ast.walk(tree)):
        if isinstance(node, ast.Module | ast.ClassDef) and node.body:
            position = head_size(node.body)
            near = node.body[min(position, len(node.body) - 1)]
            node.body.insert(position, placed(ast.Global([name]), near))
