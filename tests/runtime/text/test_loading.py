"""Files are compiled in one place, through steps that take turns."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from mutabot.model import Instrumentation
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text.instrument import SessionText
from tests.runtime.stage import forget


class Doubling:
    """Doubles every number in files of one name, or fails to."""

    def __init__(self, stem: str, error: Exception | None = None, *, raising: bool = False) -> None:
        self.stem, self.error, self.raising = stem, error, raising
        self.given_up: list[Exception] = []

    def wants(self, path: str) -> bool:
        return Path(path).stem == self.stem

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, int):
                node.value *= 2
        if self.error is not None:
            raise self.error

    def give_up(self, path: str, error: Exception) -> None:
        self.given_up.append(error)
        if self.raising:
            raise error


@pytest.fixture
def name(tmp_path: Path) -> Iterator[str]:
    """A module that has not been imported."""
    name = f"loaded_{tmp_path.name}"
    (tmp_path / f"{name}.py").write_text("x = 1\n")
    sys.path.insert(0, str(tmp_path))
    yield name
    sys.path.remove(str(tmp_path))
    sys.modules.pop(name, None)


def through(name: str, *steps: Doubling) -> ModuleType:
    for step in steps:
        loading.add(step)
    try:
        return importlib.import_module(name)
    finally:
        for step in steps:
            forget(step)


def test_every_step_takes_its_turn_at_the_files_it_wants(name: str) -> None:
    assert through(name, Doubling(name), Doubling("other"), Doubling(name)).x == 4


def test_a_step_that_fails_half_way_leaves_nothing_of_its_own_behind(name: str) -> None:
    failing = Doubling(name, RecursionError("too deep"))
    assert through(name, failing, Doubling(name)).x == 2
    assert failing.given_up == [failing.error]


def test_a_step_may_refuse_to_go_on_without_it(name: str) -> None:
    with pytest.raises(ValueError, match="no way"):
        through(name, Doubling(name, ValueError("no way"), raising=True))


def test_what_only_claims_to_be_a_module_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    class Library:
        """As the libraries of cffi: a module by what it says, without a namespace."""

        __slots__ = ()
        __class__ = ModuleType  # type: ignore[assignment]

    monkeypatch.setitem(sys.modules, "_of_cffi", Library())  # type: ignore[arg-type]
    hook = SessionText("/", Instrumentation(()))
    hook.install()
    forget(hook)
