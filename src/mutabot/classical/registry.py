"""The operators on program text, by name."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.classical.operators.absolute import Absolute
from mutabot.classical.operators.arithmetic import ArithmeticReplacement
from mutabot.classical.operators.assignment import AssignmentReplacement
from mutabot.classical.operators.bomb import Bomb
from mutabot.classical.operators.characters import (
    DoubleCharacter,
    DropCharacter,
    ReplaceCharacter,
    SwapCharacters,
)
from mutabot.classical.operators.conditional import ConditionalReplacement
from mutabot.classical.operators.logical import LogicalReplacement
from mutabot.classical.operators.relational import RelationalReplacement
from mutabot.classical.operators.shift import ShiftReplacement
from mutabot.classical.operators.unary_deletion import UnaryDeletion
from mutabot.classical.operators.unary_insertion import UnaryInsertion
from mutabot.classical.operators.variable import VariableReplacement
from mutabot.errors import OperatorError, unknown_name_text

from .operator import ClassicalOperator

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
