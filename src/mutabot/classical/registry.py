"""The operators on program text, by name."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.errors import OperatorError, unknown_name_text

from .absolute import Absolute
from .arithmetic import ArithmeticReplacement
from .assignment import AssignmentReplacement
from .bomb import Bomb
from .characters import DoubleCharacter, DropCharacter, ReplaceCharacter, SwapCharacters
from .conditional import ConditionalReplacement
from .logical import LogicalReplacement
from .operator import ClassicalOperator
from .relational import RelationalReplacement
from .shift import ShiftReplacement
from .unary_deletion import UnaryDeletion
from .unary_insertion import UnaryInsertion
from .variable import VariableReplacement

#: all operators, in the order of the documentation and of the alternatives at a place
ALL: tuple[ClassicalOperator, ...] = (
    Absolute(),
    ArithmeticReplacement(),
    RelationalReplacement(),
    ConditionalReplacement(),
    ShiftReplacement(),
    LogicalReplacement(),
    AssignmentReplacement(),
    UnaryInsertion(),
    UnaryDeletion(),
    VariableReplacement(),
    Bomb(),
    DropCharacter(),
    DoubleCharacter(),
    ReplaceCharacter(),
    SwapCharacters(),
)


def names(family: str | None = None) -> list[str]:
    """Names of the operators, of one family or of all."""
    return [each.name for each in ALL if family in (None, each.family)]


def operator(name: str) -> ClassicalOperator:
    """The operator of this name. Raises OperatorError if there is none."""
    for each in ALL:
        if each.name == name:
            return each
    raise OperatorError(unknown_name_text("operator", name, names()), operator=name)


def chosen(wanted: Iterable[str] | None) -> list[ClassicalOperator]:
    """The operators of these names, in the usual order; all for None. Raises OperatorError."""
    if wanted is None:
        return list(ALL)
    picked = {operator(name).name for name in wanted}
    return [each for each in ALL if each.name in picked]
