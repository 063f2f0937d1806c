"""LOR: a bitwise operator becomes another one."""

from __future__ import annotations

from typing import ClassVar

import libcst as cst

from mutabot_source.binary import BinaryOperator
from mutabot_source.operator import Example


class LogicalReplacement(BinaryOperator):
    """Replaces ``&``, ``|`` and ``^``."""

    name = "LOR"
    rank = 60
    summary = "A bitwise operator becomes each of the others, or the operation one of its operands."
    signs: ClassVar = {cst.BitAnd: ("and", "&"), cst.BitOr: ("or", "|"), cst.BitXor: ("xor", "^")}
    needs = "bits"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            "z = x & y\n",
            ("z = x | y\n", "z = x ^ y\n", "z = x\n", "z = y\n"),
            kinds={"x & y": "integer"},
        ),
        Example(
            "z = x ^ y\n",
            ("z = x & y\n", "z = x | y\n", "z = x\n", "z = y\n"),
            kinds={"x ^ y": "set"},
            note="sets and flags as well",
        ),
        Example("Speed = int | float\n", kinds={"int | float": "types:UnionType"}, note="a type is no value"),
        Example("def f(speed: A | B): ...\n", note="nor is an annotation"),
    )
