"""The checks of the running test, as they are made."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mutabot.model.outcome import Check

from .margins import in_words, margin, margin_of_helper, of_tolerance

#: checks of a test that are told; of others only how many there are
MOST = 40
_LONGEST = 160


@dataclass(slots=True)
class _Noted:
    text: str
    times: int = 0
    seen: str = ""
    spare: float | None = None


class Looks:
    """What the checks of the running test compared."""

    def __init__(self) -> None:
        self._noted: dict[tuple[str, str], _Noted] = {}
        self._more: set[tuple[str, str]] = set()

    def clear(self) -> None:
        """Another test begins."""
        self._noted.clear()
        self._more.clear()

    @property
    def more(self) -> int:
        """How many further checks the test made."""
        return len(self._more)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the test until now."""
        return tuple(
            Check(place, one.text, one.seen, one.spare, one.times) for (place, _), one in self._noted.items()
        )

    def compared(self, place: str, text: str, left: Any, operator: str, right: Any) -> None:
        """``left operator right`` was worked out."""
        self._note(place, text, margin(left, operator, right), lambda: _compared(left, operator, right))

    def near(
        self, place: str, text: str, value: Any, expected: Any, absolute: float, relative: float = 0.0
    ) -> None:
        """``value`` was compared with ``expected`` by a tolerance."""
        spare = of_tolerance(value, expected, absolute, relative)
        self._note(place, text, spare, lambda: _compared(value, "≈", expected))

    def called(
        self, place: str, text: str, function: Any, arguments: tuple[Any, ...], named: Mapping[str, Any]
    ) -> None:
        """A function was asked whether something is so."""
        name = getattr(function, "__name__", "")
        tolerances = _TOLERANCES.get((getattr(function, "__module__", None), name))
        if tolerances is not None and len(arguments) == 2 and named.keys() <= tolerances.keys():
            given = [named.get(key, usual) for key, usual in tolerances.items()]
            if all(type(one) in (int, float) for one in given):
                relative, absolute = given
                self.near(place, text, arguments[0], arguments[1], absolute, relative)
                return
        spare = margin_of_helper(function, arguments, named)
        self._note(place, text, spare, lambda: _called(name, arguments, named))

    def _note(self, place: str, text: str, spare: float | None, words: Callable[[], str]) -> None:
        key = place, text
        noted = self._noted.get(key)
        if noted is None:
            if len(self._noted) >= MOST:
                self._more.add(key)
                return
            noted = self._noted[key] = _Noted(text[:_LONGEST], 0, words(), spare)
        elif _is_nearer(spare, noted.spare):
            noted.seen, noted.spare = words(), spare
        noted.times += 1


#: functions of two values and their tolerances: names and usual values, the relative one first
_TOLERANCES: Mapping[tuple[str | None, str], Mapping[str, float]] = {
    ("math", "isclose"): {"rel_tol": 1e-9, "abs_tol": 0.0},
    ("numpy", "isclose"): {"rtol": 1e-5, "atol": 1e-8},
    ("numpy", "allclose"): {"rtol": 1e-5, "atol": 1e-8},
}


def _is_nearer(spare: float | None, before: float | None) -> bool:
    return spare is not None and spare < (math.inf if before is None else before)


def _compared(left: Any, operator: str, right: Any) -> str:
    sides = in_words(left), in_words(right)
    return f"{sides[0]} {operator} {sides[1]}" if None not in sides else ""


def _called(name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> str:
    parts = [("", in_words(one)) for one in arguments]
    parts += [(f"{key}=", in_words(one)) for key, one in named.items()]
    if not name or any(text is None for _, text in parts):
        return ""
    return f"{name}({', '.join(f'{key}{text}' for key, text in parts)})"
