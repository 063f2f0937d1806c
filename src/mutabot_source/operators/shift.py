"""SOR: a shift goes the other way."""

from __future__ import annotations

from typing import ClassVar

import libcst as cst

from mutabot_source.binary import BinaryOperator
from mutabot_source.operator import Example


class ShiftReplacement(BinaryOperator):
    """Replaces ``<<`` and ``>>``."""

    name = "SOR"
    rank = 50
    summary = "A shift goes the other way, or is left out."
    signs: ClassVar = {cst.LeftShift: ("left", "<<"), cst.RightShift: ("right", ">>")}
    needs = "integer"
    keeps_right = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example("z = x << 2\n", ("z = x >> 2\n", "z = x\n"), kinds={"x << 2": "integer"}),
        Example("z = x >> y\n", ("z = x << y\n", "z = x\n"), kinds={"x >> y": "integer"}),
        Example("stream << 2\n", kinds={"stream << 2": "module:Stream"}, note="not a shift of numbers"),
    )
