"""Comparisons of unittest and numpy.testing: what each compared is noted when it has held."""

from __future__ import annotations

import functools
import linecache
import os
import sys
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any

import wrapt

from .looks import Looks

#: this file, which is nobody's in tracebacks
FILE = __file__
_ORDERS = {
    "assertGreater": ">", "assertGreaterEqual": ">=", "assertLess": "<", "assertLessEqual": "<=",
    "assertEqual": "==", "assertNotEqual": "!=", "assertIn": "in", "assertNotIn": "not in",
    "assert_equal": "==", "assert_array_equal": "==", "assert_array_less": "<",
}  # fmt: skip
#: these run what they are given
_RUNS_SOMETHING = ("raises", "warn", "logs", "gc_cycles")


class Comparisons:
    """Notes what these functions compare.

    Args:
        root: absolute path of the project.
        looks: where it is noted.
    """

    def __init__(self, root: str, looks: Looks) -> None:
        self._root = os.path.realpath(root)
        self._looks = looks
        self._is_inside = False

    def install(self) -> None:
        """Look at them, whenever their modules are imported."""
        wrapt.register_post_import_hook(lambda module: self._wrap(module.TestCase, 1), "unittest.case")
        wrapt.register_post_import_hook(self._wrap_module, "numpy.testing")

    def _wrap_module(self, module: ModuleType) -> None:
        self._wrap(module, 0)

    def _wrap(self, owner: Any, first: int) -> None:
        """Stand around the comparisons of a module or class; ``first``: where what is compared begins."""
        for name in dir(owner):
            function = getattr(owner, name)
            if (
                name.startswith("assert")
                and callable(function)
                and not any(one in name.lower() for one in _RUNS_SOMETHING)
            ):
                setattr(owner, name, self._noting(name, function, first))

    def _noting(self, name: str, function: Callable[..., Any], first: int) -> Callable[..., Any]:
        @functools.wraps(function)
        def compare(*arguments: Any, **named: Any) -> Any:
            if self._is_inside:  # they use each other
                return function(*arguments, **named)
            self._is_inside = True
            try:
                result = function(*arguments, **named)
            finally:
                self._is_inside = False
            frame = sys._getframe(1)
            self._note(frame.f_code.co_filename, frame.f_lineno, name, arguments[first:], named)
            return result

        return compare

    def _note(
        self, file: str, line: int, name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]
    ) -> None:
        place = f"{os.path.relpath(os.path.realpath(file), self._root)}:{line}"
        text = " ".join(linecache.getline(file, line).split()) or name
        tolerance = _tolerance(name, arguments, named)
        if len(arguments) >= 2 and tolerance is not None:
            self._looks.near(place, text, arguments[0], arguments[1], *tolerance)
        elif len(arguments) >= 2 and name in _ORDERS:
            self._looks.compared(place, text, arguments[0], _ORDERS[name], arguments[1])
        else:
            self._looks.called(place, text, _Named(name), arguments, {})


class _Named:
    """Stands for a function."""

    def __init__(self, name: str) -> None:
        self.__name__ = name


def _tolerance(name: str, arguments: tuple[Any, ...], named: Mapping[str, Any]) -> tuple[float, float] | None:
    """Absolute and relative tolerance, as the functions are documented; None for other functions."""
    if name == "assertAlmostEqual":
        # assertAlmostEqual(first, second, places=None, msg=None, delta=None)
        delta = arguments[4] if len(arguments) > 4 else named.get("delta")
        places = arguments[2] if len(arguments) > 2 else named.get("places")
        if delta is not None:
            return (delta, 0.0) if type(delta) in (int, float) else None
        return 0.5 * 10.0 ** -(7 if places is None else places), 0.0
    if name == "assert_allclose":
        # assert_allclose(actual, desired, rtol=1e-07, atol=0, …)
        relative = arguments[2] if len(arguments) > 2 else named.get("rtol", 1e-7)
        absolute = arguments[3] if len(arguments) > 3 else named.get("atol", 0.0)
        is_plain = type(relative) in (int, float) and type(absolute) in (int, float)
        return (absolute, relative) if is_plain else None
    if name in ("assert_almost_equal", "assert_array_almost_equal"):
        # |desired - actual| < 1.5 * 10**(-decimal)
        decimal = arguments[2] if len(arguments) > 2 else named.get("decimal", None)
        usual = 7 if name == "assert_almost_equal" else 6
        return 1.5 * 10.0 ** -(usual if decimal is None else decimal), 0.0
    return None
