"""Files are compiled in one place, through steps that take turns."""

from __future__ import annotations

import ast
import importlib.abc
import importlib.util
import py_compile
import runpy
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.machinery import SourceFileLoader, SourcelessFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

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
        self.sources: list[bytes] = []

    def wants(self, path: str) -> bool:
        return Path(path).stem == self.stem

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        self.sources.append(source)
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


@contextmanager
def taking_turns(*steps: Doubling) -> Iterator[None]:
    for step in steps:
        loading.add(step)
    try:
        yield
    finally:
        for step in steps:
            forget(step)


def through(name: str, *steps: Doubling) -> ModuleType:
    with taking_turns(*steps):
        return importlib.import_module(name)


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


# Loaders of others, and whoever else compiles


class ByTree(SourceFileLoader):
    """Adds one to every number, in a tree of its own."""

    def source_to_code(self, data: Any, path: Any, **_: Any) -> CodeType:
        tree = ast.parse(data)
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant):
                node.value += 1  # type: ignore[operator]
        return compile(tree, path, "exec", dont_inherit=True)


class ByText(SourceFileLoader):
    """Reads another text than the file holds."""

    def source_to_code(self, data: Any, path: Any, **_: Any) -> CodeType:
        return super().source_to_code(data.replace(b"1", b"(5)"), path)


class Strict(SourceFileLoader):
    """Takes no number above one."""

    def source_to_code(self, data: Any, path: Any, **_: Any) -> CodeType:
        tree = ast.parse(data)
        if any(isinstance(node, ast.Constant) and node.value != 1 for node in ast.walk(tree)):
            raise SyntaxError("too big")
        return compile(tree, path, "exec", dont_inherit=True)


class Unseen(SourceFileLoader):
    """Needs no compiler."""

    def source_to_code(self, data: Any, path: Any, **_: Any) -> CodeType:
        return (lambda: None).__code__


class OfImportlib(importlib.abc.SourceLoader):
    """A loader of source that is none of files."""

    def __init__(self, name: str, path: str) -> None:
        self.path = path

    def get_filename(self, fullname: str) -> str:
        return self.path

    def get_data(self, path: Any) -> bytes:
        return Path(path).read_bytes()


class OwnExecution(importlib.abc.Loader):
    """Does everything by itself."""

    def __init__(self, name: str, path: str) -> None:
        self.path = path

    def create_module(self, spec: Any) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        tree = ast.parse(Path(self.path).read_text(), self.path)
        exec(compile(tree, self.path, "exec"), vars(module))


def loaded_by(loader: Any, name: str, *steps: Doubling) -> ModuleType:
    """A module that is loaded by this loader, through these steps."""
    path = str(Path(sys.path[0], f"{name}.py"))
    with taking_turns(*steps):
        spec = importlib.util.spec_from_file_location(name, path, loader=loader(name, path))
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


@pytest.mark.parametrize(
    ("loader", "value"),
    [(SourceFileLoader, 2), (OfImportlib, 2), (OwnExecution, 2), (ByTree, 3), (ByText, 10)],
)
def test_a_loader_makes_of_changed_text_what_it_makes_of_any(name: str, loader: Any, value: int) -> None:
    step = Doubling(name)
    assert loaded_by(loader, name, step).x == value
    assert step.given_up == []


@pytest.mark.parametrize(
    ("loader", "last", "both"),
    [(SourceFileLoader, 2, 4), (OwnExecution, 2, 4), (ByTree, 4, 6), (ByText, 10, 20)],
)
def test_a_step_that_is_last_comes_after_the_loader_that_rewrites_a_tree(
    name: str, loader: Any, last: int, both: int
) -> None:
    early, late = Doubling(name), Doubling(name)
    late.is_last = True  # type: ignore[attr-defined]
    assert loaded_by(loader, name, late).x == last
    assert loaded_by(loader, name, early, late).x == both
    assert (len(early.sources), len(late.sources)) == (1, 2)


def test_text_that_a_loader_rewrites_is_distinguished_from_that_of_the_file(name: str) -> None:
    step = Doubling(name)
    loaded_by(SourceFileLoader, name, step)
    loaded_by(ByText, name, step)
    assert step.sources == [b"x = 1\n", b"x = (5)\n"]


def test_what_a_loader_does_not_take_stays_as_it_is_and_is_reported(name: str) -> None:
    step = Doubling(name)
    assert loaded_by(Strict, name, step).x == 1
    (error,) = step.given_up
    assert "its loader fails with instrumented text: SyntaxError: too big" in str(error)
    assert "Strict" in str(error)


def test_code_that_comes_out_of_sight_is_reported(name: str) -> None:
    step = Doubling(name)
    loaded_by(Unseen, name, step)
    assert [str(error).partition(" (")[0] for error in step.given_up] == [loading.UNSEEN]


def test_a_program_that_is_run_as_text_is_changed(name: str) -> None:
    path = Path(sys.path[0], f"{name}.py")
    space: dict[str, Any] = {}
    with taking_turns(Doubling(name)):
        exec(compile(path.read_text(), path, "exec"), space)
        assert (space["x"], runpy.run_path(str(path))["x"]) == (2, 2)


def test_whoever_only_reads_a_program_reads_it_as_it_is(name: str) -> None:
    path = Path(sys.path[0], f"{name}.py")
    with taking_turns(Doubling(name)):
        assert ast.unparse(ast.parse(path.read_text(), str(path))) == "x = 1"


def test_what_py_compile_writes_holds_nothing_of_ours(name: str, tmp_path: Path) -> None:
    kept = tmp_path / "kept.pyc"
    with taking_turns(Doubling(name)):
        py_compile.compile(str(Path(sys.path[0], f"{name}.py")), cfile=str(kept))
    assert SourcelessFileLoader(name, str(kept)).get_code(name).co_consts == (1, None)


def test_a_tree_is_changed_once_and_stays_the_users(name: str) -> None:
    path = str(Path(sys.path[0], f"{name}.py"))
    tree, space = ast.parse("x = 1"), {}
    with taking_turns(Doubling(name)):
        for _ in range(2):
            exec(compile(tree, path, "exec"), space)
    assert (space["x"], ast.unparse(tree)) == (2, "x = 1")


def test_compiled_code_inherits_the_features_of_who_compiles_it(name: str) -> None:
    text = "def f(x: int): ...\nkind = type(f.__annotations__['x'])"
    asking = f"code = compile({text!r}, '<text>', 'exec')"
    spaces: list[dict[str, Any]] = [{}, {}]

    def kinds() -> list[Any]:
        exec(compile(asking, "<text>", "exec"), spaces[0])  # this module has annotations from the future
        exec(compile(asking, "<text>", "exec", dont_inherit=True), spaces[1])
        for space in spaces:
            exec(space["code"], space)
        return [space["kind"] for space in spaces]

    plain = kinds()
    with taking_turns(Doubling(name)):
        assert kinds() == plain
    assert plain[0] is str


def test_a_program_that_pytest_rewrites_is_changed_before(name: str) -> None:
    step, path = Doubling(name), str(Path(sys.path[0], f"{name}.py"))
    rewriting: Any = sys.modules["_pytest.assertion.rewrite"]
    kept = rewriting.rewrite_asserts, rewriting._read_pyc
    try:
        loading.hook_pytest_first(step)
        tree = ast.parse("x = 1\n")
        rewriting.rewrite_asserts(tree, b"x = 1\n", path)
    finally:
        rewriting.rewrite_asserts, rewriting._read_pyc = kept
    assert ast.unparse(tree.body[-1]) == "x = 2"
