"""The operators of textbooks on a program's text: those of the published table, and three that others add."""

from __future__ import annotations

from collections.abc import Iterator

from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit

from .differences import TextChange
from .rewriting import Rewriter

_Parents = tuple[ProgramNode, ...]
ORDERS = ("<", "<=", ">", ">=")
#: values that operators on a single value are about; a literal only gets or loses its sign
_SCALARS = frozenset({"name", "field", "index", "call", "binary"})
_DROPPED = frozenset({"assign", "return", "break", "continue", "goto", "call"})
_REPLACED = _DROPPED | {"exit", "raise", "retry", "trynext"}
_WITH_CONDITION = ("if", "while", "repeat")
#: other variables that a variable becomes, in the order in which the routine names them behind it
_MOST_VARIABLES = 4
#: from here on a number stands for none: an axis that a robot does not have
_NO_NUMBER = 8e9


class ConventionalOperators:
    """Makes the differences of these operators in a file.

    Args:
        rewriter: of the file.
    """

    def __init__(self, rewriter: Rewriter) -> None:
        self.rewriter, self.wording = rewriter, rewriter.wording
        self._named: dict[int, dict[str, str]] = {}

    def differences(self) -> Iterator[TextChange]:
        """Yield all differences in the file."""
        for node, parents in self.rewriter.nodes():
            yield from self._of_node(node, parents)

    def _of_node(self, node: ProgramNode, parents: _Parents) -> Iterator[TextChange]:
        is_statement = self.rewriter.is_statement(node, parents)
        if node.kind == "binary":
            yield from self._operators(node)
        elif node.kind == "number" and self.rewriter.is_plain_number(node, parents):
            yield from self._numbers(node)
        for operator, group in self.wording.functions.items() if node.kind == "call" else ():
            for other in group if node.name in _lower(group) else ():
                if other.lower() != node.name:
                    edits = (Edit(node.start, node.start + len(node.name), other),)
                    yield TextChange(operator, node, edits, other)
        if _is_read(node, parents) and not is_statement:
            yield from self._values(node, parents)
        if is_statement:
            yield from self._statements(node)

    # operators with two operands

    def _operators(self, node: ProgramNode) -> Iterator[TextChange]:
        wording, name = self.wording, node.name
        kinds = {self.rewriter.kind_of(part) for part in node.parts}
        if name in _lower(wording.arithmetic) and "text" not in kinds:
            others = wording.arithmetic if kinds <= {"number", ""} else ("+", "-")
            yield from self._replaced("replace-arithmetic", node, others, operands=True)
        elif name in ORDERS or (name in wording.equality and kinds == {"number"}):
            yield from self._replaced("replace-relation", node, (*ORDERS, *wording.equality), truth=True)
        elif name in wording.equality:
            yield from self._replaced("replace-relation", node, wording.equality, truth=True)
        elif name in _lower(wording.logic):
            yield from self._replaced("replace-logic", node, wording.logic, operands=True, truth=True)
        elif name in _lower(wording.bits):
            yield from self._replaced("replace-bitwise", node, wording.bits, operands=True)

    def _replaced(
        self,
        operator: str,
        node: ProgramNode,
        others: tuple[str, ...],
        *,
        operands: bool = False,
        truth: bool = False,
    ) -> Iterator[TextChange]:
        """Yield other operators in place of one, its operands alone, and constant conditions."""
        left, right = node.parts
        put = self.rewriter.put
        at = self.rewriter.text[left.end : right.start].lower().find(node.name)
        start = left.end + at
        for other in others:
            if other.lower() != node.name and at >= 0:
                text = f" {other} " if other.isalpha() and not node.name.isalpha() else other
                yield TextChange(operator, node, (Edit(start, start + len(node.name), text),), other)
        for variant, part in zip(("left", "right"), node.parts if operands else (), strict=False):
            yield TextChange(operator, node, put(node, self.rewriter.written(part)), variant)
        for word in self.wording.truth if truth else ():
            yield TextChange(operator, node, put(node, word), word.lower())

    # operators on single values

    def _values(self, node: ProgramNode, parents: _Parents) -> Iterator[TextChange]:
        rewriter, written = self.rewriter, self.rewriter.written(node)
        inner, parent = _in_groups(node, parents)
        if node.kind == "name":
            yield from self._variables(node, parents)
        is_owner = parent.kind == "index" and (parent.parts[0] is node or node.kind == "number")
        if parent.kind == "field" or is_owner:
            return  # the owner of a component or an element, or which of them is meant
        if node.kind == "unary" and rewriter.is_amount(node, parents):
            yield TextChange("delete-unary", node, rewriter.put(node, rewriter.written(node.parts[0])))
        is_condition = parent.kind in _WITH_CONDITION and any(part is inner for part in parent.parts)
        kind = rewriter.kind_of(node)
        if kind == "number" and not is_condition and node.kind in _SCALARS:
            yield from self._absolute(node, parents[-1])
        if parent.kind == "unary" or node.kind == "group":
            return
        is_subject = node.kind in _SCALARS or self._is_amount(node, parents)
        if is_condition or (kind == "truth" and is_subject):
            text = _inside(self.wording.negation.format(written), parents[-1])
            yield TextChange("insert-unary", node, rewriter.put(node, text), "not")
        elif kind == "number" and is_subject:
            text = _inside(f"-({written})" if node.kind == "binary" else f"-{written}", parents[-1])
            yield TextChange("insert-unary", node, rewriter.put(node, text), "neg")

    def _is_amount(self, node: ProgramNode, parents: _Parents) -> bool:
        """Return whether a literal says how much, and is another one with a sign."""
        is_other = node.kind == "constant" or (node.kind == "number" and 0 < node.value < _NO_NUMBER)
        return is_other and self.rewriter.is_amount(node, parents)

    def _absolute(self, node: ProgramNode, parent: ProgramNode) -> Iterator[TextChange]:
        written, put = self.rewriter.written(node), self.rewriter.put
        absolute = self.wording.absolute.format(written)
        yield TextChange("absolute-value", node, put(node, absolute), "abs")
        yield TextChange("absolute-value", node, put(node, _inside(f"-{absolute}", parent)), "negAbs")
        if not any(part.kind == "call" for part in node.walk()):  # what it does it would do three times
            value = f"({written})" if node.kind == "binary" else written
            text = f"({value}/({value}/{value}))"
            yield TextChange("absolute-value", node, put(node, text), "failOnZero")

    def _variables(self, node: ProgramNode, parents: _Parents) -> Iterator[TextChange]:
        """Yield the variables of the same type that the routine names as well, the next ones first."""
        rewriter = self.rewriter
        routines = [outer for outer in parents if outer.kind == "routine"]
        scope = routines[-1] if routines else rewriter.program.parsed.tree
        if id(scope) not in self._named:
            inside = (
                inner for inner in scope.walk() if inner.kind == "name" and inner.name in rewriter.types
            )
            self._named[id(scope)] = {inner.name: rewriter.written(inner) for inner in inside}
        named = self._named[id(scope)]
        type = rewriter.types.get(node.name)
        if not type or node.name not in named:
            return
        at = [*named].index(node.name)
        others = [name for name in (*[*named][at + 1 :], *[*named][:at]) if rewriter.types[name] == type]
        for other in [name for name in others if rewriter.has_value(name, node)][:_MOST_VARIABLES]:
            yield TextChange("replace-variable", node, rewriter.put(node, named[other]), other)

    def _numbers(self, node: ProgramNode) -> Iterator[TextChange]:
        for variant, text in (("0", "0"), ("plus", f"{node.value + 1:g}")):
            if float(text) != float(node.value):
                yield TextChange("replace-number", node, self.rewriter.put(node, text), variant)

    # operators on statements

    def _statements(self, node: ProgramNode) -> Iterator[TextChange]:
        rewriter = self.rewriter
        if node.kind in _DROPPED and not rewriter.is_of_robot(node):
            yield TextChange("drop-any", node, rewriter.without(node))
        if node.kind in _REPLACED:
            yield TextChange("replace-statement", node, rewriter.put(node, self.wording.failing))
        elif node.kind in ("if", "while", "for", "switch"):  # it fails where it begins
            text = "1/0>0" if node.kind in ("if", "while") else "1/0"
            yield TextChange("replace-statement", node, rewriter.put(node.parts[0], text))


def _is_read(node: ProgramNode, parents: _Parents) -> bool:
    """Return whether a node is not what an assignment or a declaration gives a value."""
    path = zip(parents, (*parents[1:], node), strict=True)
    return parents[-1].kind != "signal" and not any(
        outer.kind == "assign" and outer.parts[0] is inner for outer, inner in path
    )


def _in_groups(node: ProgramNode, parents: _Parents) -> tuple[ProgramNode, ProgramNode]:
    """Return a node with all parentheses around it, and what these stand in."""
    for outer in reversed(parents):
        if outer.kind != "group":
            return node, outer
        node = outer
    return node, parents[0]


def _inside(text: str, parent: ProgramNode) -> str:
    return f"({text})" if parent.kind in ("binary", "unary") else text


def _lower(words: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(word.lower() for word in words)
