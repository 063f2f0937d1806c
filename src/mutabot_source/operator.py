"""The interface of an operator on program text.

An operator looks at one node of the syntax tree and says what could stand there instead. What it
keeps of the original it hands on as nodes, so that these keep their place, their line and their meaning.
A file in ``operators/`` with a subclass of ``ConventionalOperator`` is all that a new one takes; what several
share has a name that begins with ``_``.
"""

from __future__ import annotations

import ast
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import EllipsisType
from typing import ClassVar, TypeGuard

from mutabot.api.faults import Alternative, Rule

from .extension import CONVENTIONAL

#: what the helper object is called in templates; an operator may call, and names what it raises by itself:
#: ``absolute(value)``, whatever the program calls ``abs``; ``fail(name, text)``, which raises; and
#: ``fail_if(value, wrong, name, text)``, which is the value or raises (``switches.py``)
HELPER = "__mutabot__[0]"


SyntaxNode = ast.expr | ast.stmt
#: a text in pieces: as it stands here, and expressions of the original
TextParts = tuple[str | ast.expr, ...]


@dataclass(frozen=True, slots=True)
class Draft:
    """A replacement for a node.

    Attributes:
        variant: which of the operator's alternatives here.
        parts: text, and nodes of the original that are kept.
        needs: kind of value that the place must have; empty for any (see ``Alternative.needs``).
        shown: parts as the program text would show them, where that differs.
        raises: whether it raises whatever happens, so that nothing of the original can follow.
    """

    variant: str
    parts: TextParts
    needs: str = ""
    shown: TextParts | None = None
    raises: bool = False


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The context of a node that an operator may need to know.

    Attributes:
        is_value: whether the node's own value is used, rather than called or looked into.
        is_condition: whether only the truth of it matters.
        is_operand_of_unary: whether a unary operator stands right before it.
        is_argument: whether it is an argument of a call.
        is_callee: whether it is what a call calls.
        is_loop: whether it decides if a loop goes on.
        function: name of the function that it belongs to; ``<module>`` at the top level.
        neighbour: for a fixed value that a call gets, that which the next call of the same function in the
            file gets at the same place; None if there is none.
    """

    is_value: bool = True
    is_condition: bool = False
    is_operand_of_unary: bool = False
    is_argument: bool = False
    is_callee: bool = False
    is_loop: bool = False
    function: str = "<module>"
    neighbour: ast.expr | None = None


@dataclass(frozen=True, slots=True)
class TextExample:
    """A worked example: a program text, and all texts that the operator makes of it.

    Attributes:
        before: the text of a module.
        after: the texts it makes, in order; empty where it stays away.
        kinds: kinds of values seen in the baseline, by expression; all others were numbers.
        variables: for the variables named here, the others of the same type in scope.
        note: one line for the documentation.
    """

    before: str
    after: tuple[str, ...] = ()
    kinds: Mapping[str, str] = field(default_factory=dict)
    variables: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    note: str = ""


def each(program: str, texts: str) -> tuple[str, ...]:
    """Return the text of a program once for each of several texts in place of ``{}``, comma-separated."""
    return tuple(program.format(text) for text in texts.split(", "))


class ConventionalOperator(Rule):
    """An operator that makes alternatives of program text.

    Class attributes, beside those of every ``Rule``:
        rank: its place in the documentation and among the alternatives of a place: smaller first.
        asks_variables: whether it is asked once more after the baseline, with the variables that were in
            scope at a place (``with_variables``).
    """

    family: ClassVar[str] = CONVENTIONAL
    examples: ClassVar[tuple[TextExample, ...]] = ()
    rank: ClassVar[int] = 1000
    asks_variables: ClassVar[bool] = False

    @abstractmethod
    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        """Yield the replacements of a node; none for nodes that the operator does not handle."""

    def with_variables(self, names: Iterable[str]) -> Iterable[Alternative]:
        """Yield alternatives of a variable, for operators that use the names of variables of its type."""
        return ()


def is_scalar(node: SyntaxNode, around: Surroundings) -> TypeGuard[ast.expr]:
    """Return whether a node's value may be a number or truth value that the program uses."""
    kinds = ast.Name | ast.Attribute | ast.Subscript | ast.Call | ast.BinOp
    return isinstance(node, kinds) and around.is_value


def is_named_constant(node: ast.expr) -> bool:
    """Return whether a node is ``None``, ``True`` or ``False``."""
    return isinstance(node, ast.Constant) and (node.value is None or isinstance(node.value, bool))


def is_text(node: ast.expr) -> bool:
    """Return whether a node is a string or bytes literal."""
    is_plain = isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
    return is_plain or isinstance(node, ast.JoinedStr)


def is_idle(node: ast.expr) -> bool:
    """Return whether a node has no effect as a statement: a string, or ``...``."""
    return isinstance(node, ast.Constant) and isinstance(node.value, str | bytes | EllipsisType)
