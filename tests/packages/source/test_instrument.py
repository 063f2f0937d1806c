"""Instrumented program text means the same while nothing is active, and the alternative when one is."""

from __future__ import annotations

import ast
import builtins
import gc
import importlib
import py_compile
import runpy
import sys
import traceback
import types
import weakref
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib.machinery import SourcelessFileLoader
from pathlib import Path
from typing import Any

import pytest

from mutabot.model import Instrumentation
from mutabot.model.codec import from_data, to_data
from mutabot.model.program_text import RUNTIME
from mutabot.runtime.program_text import instrument
from mutabot.runtime.program_text.compiling import compile_tree
from mutabot.runtime.program_text.instrument import SessionText, instrumented
from mutabot.runtime.program_text.switches import Alternatives, error_of
from mutabot_source.refine import refine
from mutabot_source.texts import find_texts
from tests.packages.source.build import choices, imported, load, seen_in, spliced, switch_off, text_of

#: what the operators that raise call it
BOMB, ZERO_VALUE = error_of("Bomb"), error_of("ZeroValue")
ORDINARY = Path(__file__).with_name("ordinary.py").read_text(encoding="utf-8")


def same_for_all(value: Any) -> str:
    """A value in words that do not depend on where and when it was made."""
    return repr(value)


@pytest.mark.parametrize("record", [False, True], ids=["alternatives", "recording"])
def test_a_program_of_everything_behaves_as_the_original(tmp_path: Path, record: bool) -> None:
    text = text_of(tmp_path, ORDINARY)
    plain = load(tmp_path / text.file).results()
    del sys.modules[Path(text.file).stem]
    with imported(tmp_path, text, record=record) as (module, hook):
        results = module.results()
    assert hook.imported == [text.file]
    for key, value in plain.items():
        assert same_for_all(results[key]) == same_for_all(value), key


def test_every_alternative_does_what_its_text_says(tmp_path: Path) -> None:
    text = text_of(tmp_path, MISSION)
    assert len(choices(text)) > 150
    code = compile_tree(instrumented(ast.parse(MISSION), text.places), text.file)
    alternatives = Alternatives(len(text.places))
    setattr(builtins, RUNTIME, alternatives.switches)
    for choice, place, alternative in choices(text):
        alternatives.activate(*choice)
        assert outcome(code) == outcome(spliced(MISSION, place, alternative)), (place.text, alternative)
    alternatives.activate()
    assert outcome(code) == outcome(MISSION)


SPREAD = '''
import functools

@functools.lru_cache(maxsize=1 + 2)
def described(x):
    return (f"""first {x + 1}
        second {x * 2:>{3 + 4}}""" f"{
        x - 5}" "plain"
        f"{x / 3}")

class Cell:
    @property
    def wide(self):
        if self.x > 1: return 2; y = 3
        try:
            return [one + 1
                    for one in range(4)]
        except ValueError as error:
            raise TypeError(1 + 1) from error
        finally:
            self.x += 1
'''


@pytest.mark.parametrize(
    "program", [SPREAD, pytest.param(ORDINARY, marks=pytest.mark.whole)], ids=["spread", "ordinary"]
)
@pytest.mark.parametrize("record", [False, True], ids=["alternatives", "recording"])
def test_to_look_only_around_a_place_makes_the_same_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, record: bool
) -> None:
    try:
        places = text_of(tmp_path, program).places
    except SyntaxError:  # before 3.12, an expression in an f-string stands on one line
        program = program.replace("{\n        x", "{x")
        places = text_of(tmp_path, program).places

    def made() -> list[str]:
        some = places[:: len(places) // 50 + 1]
        trees = [instrumented(ast.parse(program), [place], record=record) for place in some]
        return [ast.dump(tree, include_attributes=True) for tree in trees]

    near = made()
    monkeypatch.setattr(instrument, "_FEW", -1)
    assert made() == near
    assert len(set(near)) > 10


MISSION = """
STEP = 0.25
LIMITS = (-1.5, 4)

def reach(x, y, high=3):
    total = x * 2 + y
    if x < y <= high and not total == 0:
        total -= STEP
    flags = 6 & high | 1
    return total if total > -y or high >> 1 else -total, flags

def run():
    seen = []
    for x in (-1, 0, 2):
        seen.append(reach(x, 1.5))
        seen.append(reach(x, x + 1, high=LIMITS[1]))
    return seen, STEP

result = run()
"""


def outcome(source: str | types.CodeType) -> str:
    """What becomes of a program: its result, or its exception."""

    def bomb() -> None:
        raise BOMB

    def fail_on_zero(value: Any) -> Any:
        if value == 0:
            raise ZERO_VALUE
        return value

    space = {"Bomb": bomb, "failOnZero": fail_on_zero}
    try:
        exec(source, space)
    except Exception as error:
        return type(error).__name__
    return repr(space.get("result"))


def test_tracebacks_show_the_users_lines_and_columns(tmp_path: Path) -> None:
    source = "def f(a, b):\n    return (a +\n        b.missing) * 2\n"
    text = text_of(tmp_path, source)

    def where(module: types.ModuleType) -> list[tuple[object, ...]]:
        try:
            module.f(1, 2)
        except AttributeError as error:
            frame = traceback.extract_tb(error.__traceback__)[-1]
            return [(frame.filename, frame.lineno, frame.colno, frame.end_lineno, frame.end_colno)]
        raise AssertionError

    plain = where(load(tmp_path / text.file))
    del sys.modules[Path(text.file).stem]
    with imported(tmp_path, text) as (module, _):
        assert where(module) == plain
    add = next(
        choice
        for choice, _, alternative in choices(text)
        if (alternative.operator, alternative.variant) == ("AOR", "sub")
    )
    with imported(tmp_path, text, add) as (module, _):
        assert where(module) == plain  # what an alternative keeps stays where it stands


def test_no_file_is_written_and_none_is_read_in_its_place(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = False
    try:
        with imported(tmp_path, text) as (module, _):
            assert module.x == 2
    finally:
        sys.dont_write_bytecode = before
    assert sorted(path.name for path in tmp_path.iterdir()) == [text.file]


def test_an_alternative_chosen_at_the_first_evaluation_stands_at_once(tmp_path: Path) -> None:
    text = text_of(tmp_path, "def f(x, y):\n    return x + y\n", "AOR")
    (place,) = text.places
    with imported(tmp_path, text) as (module, hook):
        told: list[int] = []

        def fork(number: int, alike: Sequence[frozenset[int]]) -> None:
            told.append(number)
            if len(told) == 2:  # the second test is where this process becomes the mutant
                hook.alternatives.activate(*choices(text)[0][0])

        hook.alternatives.on_place = fork
        hook.alternatives.watch({place.number: frozenset(range(8))})
        assert [module.f(5, 3), module.f(5, 3)] == [8, 8]
        assert told == [1]
        hook.alternatives.watch({place.number: frozenset(range(8))})
        assert [module.f(5, 3), module.f(5, 3)] == [2, 2]
        assert told == [1, 1]
        hook.alternatives.activate()
        assert module.f(5, 3) == 8


def test_one_alternative_at_a_time(tmp_path: Path) -> None:
    text = text_of(tmp_path, "def f(x, y):\n    return [x + y, x * y]\n", "AOR")
    add, multiply = text.places
    first = next(choice for choice, place, _ in choices(text) if place == add)
    second = next(choice for choice, place, _ in choices(text) if place == multiply)
    with imported(tmp_path, text, first) as (module, hook):
        assert module.f(5, 3) == [2, 15]
        assert hook.alternatives.hits == {add.number: 1}
        hook.alternatives.activate(*second)
        assert module.f(5, 3) == [8, 8]
        assert hook.alternatives.hits == {add.number: 1, multiply.number: 1}


def test_a_recording_distinguishes_kinds_and_variables_of_the_same_type(tmp_path: Path) -> None:
    source = "LIMIT = 4\nNAME = 'a'\ndef f(x, y, z):\n    n = 1\n    return x < y, n\n"
    text = text_of(tmp_path, source)
    with imported(tmp_path, text, record=True) as (module, hook):
        assert hook.sightings is not None
        hook.sightings.start()
        module.f(1.0, 2.0, "z")
        module.f(1, 2.0, "z")
        seen = {sighting.place: sighting for sighting in hook.sightings.seen()}
        reached = frozenset(hook.sightings.entered)
    by_text = {place.text: seen[place.number] for place in text.places if place.number in seen}
    assert by_text["x"].kinds == ("integer", "number")
    assert by_text["x"].variables == ()
    assert by_text["y"].kinds == ("number",)
    assert by_text["n"].variables == ("LIMIT",)
    assert {place.text for place in text.places if place.number in reached} == {
        "x",
        "y",
        "n",
        "x < y",
        "n = 1",
        "1",
        "return x < y, n",
    }


def test_a_recording_keeps_no_object_and_changes_no_names(tmp_path: Path) -> None:
    source = (
        "import weakref\nclass Port:\n    pass\n"
        "def closed(n):\n    port = Port()\n    end = weakref.ref(port)\n    n = n + 1\n"
        "    del port\n    return end() is None, n\n"
        "def kept(n):\n    names = locals()\n    m = n\n    return m + 1, sorted(names)\n"
    )
    text = text_of(tmp_path, source)
    with imported(tmp_path, text, record=True) as (module, _):
        assert module.closed(1) == (True, 2)
        assert module.kept(1) == (2, ["n"])


def test_a_recording_keeps_no_class_that_a_test_makes(tmp_path: Path) -> None:
    text = text_of(tmp_path, "def f(x):\n    return [x][0]\n")
    with imported(tmp_path, text, record=True) as (module, hook):
        kinds: list[Any] = [type("Local", (), {}), type("Local", (), {})]
        for kind in kinds:
            module.f(kind())
        ends = [weakref.ref(kind) for kind in kinds]
        del kind, kinds[:]
        gc.collect()
        assert [end() for end in ends] == [None, None]
        assert hook.sightings is not None
        seen = {kind for sighting in hook.sightings.seen() for kind in sighting.kinds}
    assert f"{__name__}:Local" in seen


def test_a_place_that_has_shown_all_is_not_looked_at_any_more(tmp_path: Path) -> None:
    text = text_of(tmp_path, "LIMIT = 4\ndef f(x):\n    return x, [x + x]\n", "ABS", "SVR")
    numbers = {place.text: place.number for place in text.places}
    found = []
    with imported(tmp_path, text, record=True) as (module, hook):
        assert hook.sightings is not None
        for value in ("a", 2, 2.0, "b"):
            hook.sightings.start()
            for _ in range(50):
                module.f(value)
            assert {numbers["x"], numbers["x + x"]} <= hook.sightings.entered
            found.append({sighting.place: sighting for sighting in hook.sightings.seen()})
    looks = {name: [sightings[numbers[name]].hits for sightings in found] for name in ("x", "x + x")}
    assert looks["x + x"] == [20, 21, 21, 21]  # it waits for a number
    assert looks["x"] == [20, 21, 21, 21]  # and a name until no other is of the same type
    assert found[3][numbers["x"]].kinds == ("integer", "text")
    assert found[3][numbers["x"]].variables == ()


def test_a_file_that_changed_is_left_alone_and_reported(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    (tmp_path / text.file).write_text("x = 5\n")
    hook = SessionText(str(tmp_path), Instrumentation((text,)))
    hook.install()
    try:
        assert load(tmp_path / text.file).x == 5
    finally:
        switch_off(hook)
    assert hook.problems == {text.file: "it has changed since its mutants were made"}


def test_another_text_under_the_name_of_a_file_is_left_alone_and_reported(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    hook = SessionText(str(tmp_path), Instrumentation((text,)))
    hook.install()
    space: dict[str, Any] = {}
    try:
        exec(compile("x = 1 + 2\n", tmp_path / text.file, "exec"), space)
    finally:
        switch_off(hook)
    assert space["x"] == 3
    assert hook.problems == {text.file: "other text than the file holds is compiled under its name"}


def test_a_file_whose_code_is_read_from_a_compiled_file_is_reported(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    hook = SessionText(str(tmp_path), Instrumentation((text,)))
    hook.install()
    compiled = str(tmp_path / "compiled.pyc")
    module = types.ModuleType("of_compiled_code")
    try:
        py_compile.compile(str(tmp_path / text.file), cfile=compiled)
        SourcelessFileLoader("of_compiled_code", compiled).exec_module(module)
    finally:
        switch_off(hook)
    assert module.x == 2
    assert hook.problems == {text.file: instrument._ELSEWHERE}


def test_a_file_whose_code_comes_out_of_sight_is_reported(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    hook = SessionText(str(tmp_path), Instrumentation((text,), record=True))
    hook.install()
    module = types.ModuleType("of_a_cache")
    module.__file__, module.__loader__ = str(tmp_path / text.file), ast.NodeVisitor()  # type: ignore[assignment]
    sys.modules["of_a_cache"] = module
    try:
        hook.finish()
    finally:
        del sys.modules["of_a_cache"]
        switch_off(hook)
    assert hook.problems == {
        text.file: "its loader compiles it in a way that mutabot cannot follow (ast.NodeVisitor)"
    }


def test_the_plan_crosses_the_border_as_json(tmp_path: Path) -> None:
    instrumentation = Instrumentation((text_of(tmp_path, ORDINARY),), record=True)
    assert from_data(Instrumentation, to_data(instrumentation)) == instrumentation


@pytest.mark.parametrize(
    ("operator", "variant", "arguments", "acted", "example"),
    [
        ("AOR", "sub", (5, 0), 0, None),
        ("AOR", "sub", (5, 3), 1, (8, 2)),
        ("AOR", "div", (5, 0), 1, None),  # it raises
        ("ABS", "abs", (5, 3), 0, None),
        ("ABS", "abs", (-5, 3), 1, (-2, 2)),
        ("ABS", "failOnZero", (-5, 5), 1, None),
        ("BSR", "", (5, 3), 1, None),
    ],
)
def test_an_alternative_that_changes_no_value_has_not_acted(
    tmp_path: Path, operator: str, variant: str, arguments: Any, acted: int, example: Any
) -> None:
    text = text_of(tmp_path, "def f(x, y):\n    return x + y\n", operator)
    choice, _, _ = next(
        found for found in choices(text) if found[2].variant == variant and found[1].text != "x"
    )
    told: list[int] = []
    with imported(tmp_path, text, choice) as (module, hook):
        hook.alternatives.on_act = lambda: told.append(1)
        hook.alternatives.start()
        call_forgiving(module.f, *arguments)
        assert hook.alternatives.acted == acted
        assert hook.alternatives.example == example
        assert len(told) <= acted


@pytest.mark.whole
def test_an_original_with_effects_is_not_computed_twice(tmp_path: Path) -> None:
    source = "log = []\ndef g(x):\n    log.append(x)\n    return x\ndef f():\n    return g(1) + g(0)\n"
    text = text_of(tmp_path, source, "AOR", "ABS", "UOI")
    for choice, place, _ in choices(text):
        with imported(tmp_path, text, choice) as (module, _):
            call_forgiving(module.f)
            assert len(module.log) <= 2, place


def call_forgiving(function: Callable[..., Any], *arguments: Any) -> None:
    with suppress(ZeroDivisionError, ZERO_VALUE, BOMB):
        function(*arguments)


@pytest.mark.parametrize("end", ["\r\n", "\n"], ids=["crlf", "lf"])
def test_line_ends_tabs_and_encodings_are_the_users(tmp_path: Path, end: str) -> None:
    lines = ["# coding: latin-1", "def f(größe):", "\tif größe > 1:", "\t\treturn (größe +"]
    lines += ["\t\t\t'ü'.count('ü'))", ""]
    source = end.join(lines).encode("latin-1")
    (tmp_path / "umlauts.py").write_bytes(source)
    (text,) = find_texts(tmp_path, ["umlauts.py"])
    add = next(
        choice
        for choice, _, alternative in choices(text)
        if (alternative.operator, alternative.variant) == ("AOR", "sub")
    )
    with imported(tmp_path, text) as (module, _):
        assert module.f(3) == 4
    with imported(tmp_path, text, add) as (module, _):
        assert module.f(3) == 2


def test_a_program_may_be_loaded_in_any_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n", "AOR")
    name = Path(text.file).stem
    monkeypatch.syspath_prepend(str(tmp_path))
    choice = choices(text)[0][0]
    with imported(tmp_path, text, choice) as (module, _):
        assert module.x == 0
        del sys.modules[name]
        assert importlib.import_module(name).x == 0
        assert runpy.run_module(name)["x"] == 0


def test_a_program_imported_too_early_is_reported(tmp_path: Path) -> None:
    text = text_of(tmp_path, "x = 1 + 1\n")
    load(tmp_path / text.file)
    hook = SessionText(str(tmp_path), Instrumentation((text,)))
    hook.install()
    switch_off(hook)
    del sys.modules[Path(text.file).stem]
    assert list(hook.problems) == [text.file]


GLOBALS = """
a, b, c = 1, 2, 3

def f():
    y = a
    global b
    b = y
    def g():
        c = 5
        def h():
            return a
        return h(), c
    result = g(), a
    a2 = 7
    return result
"""


def test_variables_that_would_change_what_a_name_means_do_not_stand_in(tmp_path: Path) -> None:
    text = text_of(tmp_path, GLOBALS, "SVR")
    with imported(tmp_path, text, record=True) as (module, hook):
        assert module.f() == ((1, 5), 1)
        assert hook.sightings is not None
        seen = seen_in(hook.sightings.seen())
    (text,), _ = refine([text], seen)
    found = {(place.span.function, place.text, alternative.text) for _, place, alternative in choices(text)}
    assert ("f", "a", "c") in found
    assert not {(function, name, "b") for function, name, _ in found if function == "f"} & found
    assert not [entry for entry in found if entry[0].endswith("h")]
    assert ("f", "a", "a2") not in found
    with imported(tmp_path, text) as (module, _):
        assert module.f() == ((1, 5), 1)
