"""How a language writes what conventional operators put into a program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Wording:
    """How a language writes what these operators put into a program.

    Attributes:
        equality: its operators for equal and unequal.
        logic: for and, or, and one of two.
        truth: its words for true and false.
        negation, absolute: a condition that does not hold, and a number without its sign, around ``{}``.
        failing: a statement that stops the program with an error.
        arithmetic: operators on numbers that stand for each other.
        bits: operators on bits that do.
        functions: those that stand for each other, by the operator that is about their calls.
    """

    equality: tuple[str, str]
    logic: tuple[str, str, str]
    truth: tuple[str, str]
    negation: str
    absolute: str
    failing: str
    arithmetic: tuple[str, ...] = ("+", "-", "*", "/")
    bits: tuple[str, ...] = ()
    functions: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
