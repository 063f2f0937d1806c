"""Which shared fixtures a test used, and which of them can carry something from one test to another."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, is_dataclass
from enum import Enum
from pathlib import PurePath
from types import FrameType
from typing import Any
from unittest import TestCase

import pytest

from mutabot.border.footprint import SharedFixture

#: packages whose fixtures serve tests and never hold a robot
_SERVANTS = ("_pytest", "pytest_", "anyio", "xdist", "hypothesis", "mutabot.inside")
#: fixtures by which pytest calls ``setup_module``, ``setUpClass`` and their like: what they set up lies in
#: the module or class, not in their value
_SET_UPS = {
    "_xunit_setup_module": "setup_module",
    "_xunit_setup_class": "setup_class",
    "_unittest_setUpClass": "setUpClass",
}
_PLAIN = (type(None), bool, int, float, complex, str, bytes, Enum, PurePath, type)


@dataclass(slots=True)
class _Setup:
    """One set-up of a shared fixture: its number, and whether nothing of the program ran in it."""

    number: int
    is_quiet: bool


@dataclass(slots=True)
class SharedFixtures:
    """The shared fixtures of a session, as they are set up.

    Args:
        is_program: whether a file belongs to the robot program or to the oracle.
    """

    is_program: Callable[[str], bool]
    _setups: dict[int, _Setup] = field(default_factory=dict)
    _count: int = 0

    @contextmanager
    def setting_up(self, fixture: Any) -> Iterator[None]:
        """While a shared fixture is set up: notes whether the program takes part."""
        self._count += 1
        setup = self._setups[id(fixture)] = _Setup(self._count, is_quiet=True)
        before = sys.getprofile()

        def watch(frame: FrameType, event: str, argument: Any) -> None:
            if event == "call" and self.is_program(frame.f_code.co_filename):
                setup.is_quiet = False
                sys.setprofile(before)

        sys.setprofile(watch)
        try:
            yield
        finally:
            sys.setprofile(before)

    def used_by(self, item: pytest.Item) -> tuple[SharedFixture, ...]:
        """Those that this test used and that could carry something, or take something down."""
        request = getattr(item, "_request", None)
        used = getattr(request, "_fixture_defs", {}).values()
        found = (self._described(fixture, item) for fixture in used if fixture.scope != "function")
        return tuple(one for one in found if one is not None)

    def _described(self, fixture: Any, item: pytest.Item) -> SharedFixture | None:
        setup = self._setups.get(id(fixture))
        if setup is None or fixture.cached_result is None:
            return None
        set_up = next((name for start, name in _SET_UPS.items() if fixture.argname.startswith(start)), None)
        if set_up is not None:
            if set_up == "setUpClass" and not _has_set_up(getattr(item, "cls", None)):
                return None
            return SharedFixture(set_up, fixture.scope, setup.number, has_teardown=True)
        if fixture.func.__module__.startswith(_SERVANTS):
            return None
        has_teardown = inspect.isgeneratorfunction(fixture.func)
        if setup.is_quiet and not has_teardown and is_plain(fixture.cached_result[0]):
            return None
        return SharedFixture(fixture.argname, fixture.scope, setup.number, has_teardown)


def _has_set_up(cls: Any) -> bool:
    """Whether a ``TestCase`` sets up or takes down anything as a class: each one inherits the methods."""
    names = ("setUpClass", "tearDownClass")
    return any(getattr(cls, name).__func__ is not getattr(TestCase, name).__func__ for name in names)


def is_plain(value: Any) -> bool:
    """Whether no test can change the value: numbers, texts, paths, and fixed collections of such."""
    if isinstance(value, tuple | frozenset):
        return all(is_plain(item) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        frozen = type(value).__dataclass_params__.frozen  # type: ignore[attr-defined]  # not in typeshed
        return frozen and all(is_plain(getattr(value, one.name)) for one in fields(value))
    return isinstance(value, _PLAIN) or (inspect.isfunction(value) and not value.__closure__)
