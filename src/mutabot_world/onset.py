"""The moment at which a disturbance begins."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

_NUMBER = r"\d{1,6}(?:\.\d{1,6})?"
_REFERENCE = r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*"
_FORMS = {
    "made": re.compile("made"),
    "making": re.compile("making"),
    "time": re.compile(rf"(?P<number>{_NUMBER}) ?s"),
    "call": re.compile(rf"call (?P<number>[1-9]\d{{0,5}}) of (?P<call>{_REFERENCE})"),
    "while": re.compile(rf"while (?P<condition>{_REFERENCE}) at (?P<call>{_REFERENCE})"),
}


@dataclass(frozen=True, slots=True)
class Onset:
    """The moment at which a disturbance begins.

    Attributes:
        kind: ``made``: as soon as the world is; ``making``: in what it is made with; ``time``: at a simulated
            time of the test; ``call``: before the n-th call of a function in a test; ``while``: as long as a
            condition of the world holds, which is asked before each call of a function.
        number: the time, s, or the number of the call, from 1.
        call: the function, ``module:name``.
        condition: likewise; it gets the world.
    """

    kind: str = "made"
    number: float = 0.0
    call: str = ""
    condition: str = ""

    @classmethod
    def parse(cls, text: str) -> Onset:
        """Read ``made``, ``2.5 s``, ``call 3 of robot:Arm.move_by``, ``while checks:holds at sim:step``.

        Raises ValueError, which says what would be right.
        """
        for kind, form in _FORMS.items():
            found = form.fullmatch(text.strip())
            if found is not None:
                parts: dict[str, Any] = found.groupdict()
                return cls(kind, float(parts.pop("number", 0.0)), **parts)
        raise ValueError(
            f'{text!r} is not a moment of a disturbance; write "made", "making", "2.5 s", '
            '"call 3 of module:function" or "while module:condition at module:function"'
        )

    @property
    def text(self) -> str:
        """The moment as appended to a description; empty for a world that is disturbed from the beginning."""
        texts = {
            "time": f", from {self.number:g} s on",
            "call": f", from call {self.number:g} of {self.call.rpartition(':')[2]} on",
            "while": f", while {self.condition.rpartition(':')[2]}",
        }
        return texts.get(self.kind, "")
