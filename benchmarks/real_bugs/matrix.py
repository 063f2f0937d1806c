"""Who notices what: all tests of a program with each variant of its text, each variant in a fork of its own.

Bugs, and mutants of program text, are texts. To run the tests of a text takes a few milliseconds here, where
a process of pytest takes a second. Names of tests are those of pytest.
"""

from __future__ import annotations

import importlib
import json
import math
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random
from types import CodeType, FrameType, ModuleType
from typing import Any, NoReturn

from mutabot.model import Instrumentation, ProgramText
from mutabot.original import Original, TextSeen
from mutabot.runtime.program_text import compiling
from mutabot.runtime.program_text.instrument import SessionText
from mutabot_patches.changes import read_patch
from mutabot_patches.suite import looks_like_tests
from mutabot_source.refine import refine
from mutabot_source.registry import names
from mutabot_source.texts import find_texts

PROGRAM = "program"
STRENGTHS = ("weak", "medium", "strong")
#: what compares a program with the original on inputs drawn at random; no test of a suite
PROBE = "probe"
#: inputs of the probe
DRAWS = 60
#: seconds of processor time that a test may take
LONGEST = 0.25
#: digits that the probe looks at: the order of additions is no difference
DIGITS = 9
Test = Callable[[], object]
#: what fails, and with what
Failures = dict[str, str]


class HangError(BaseException):
    """A test took too long."""


class BombError(Exception):
    """The bomb of operator BSR."""


@dataclass(frozen=True)
class Variant:
    """A text of the program beside the original.

    Attributes:
        family: of its mutant, or that of bugs.
        operator: the name of the operator; empty for a bug.
        what: what stands there instead.
        text: the whole program.
    """

    family: str
    operator: str
    what: str
    text: str


@dataclass
class Suite:
    """A program with its tests, in this process.

    Attributes:
        folder: the program's.
        source: the text of the original.
        expected: what the original does with each input of the probe.
    """

    folder: Path
    source: str = ""
    expected: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        sys.path.insert(0, str(self.folder))
        sys.dont_write_bytecode = True
        self.source = (self.folder / f"{PROGRAM}.py").read_text(encoding="utf-8")
        self.expected = self.observe(self.put(self.source))

    def put(self, text: str) -> ModuleType:
        """Make this text the program, and return its module."""
        module = ModuleType(PROGRAM)
        vars(module).update(failOnZero=_fail_on_zero, Bomb=_bomb)
        sys.modules[PROGRAM] = module
        exec(compile(text, str(self.folder / f"{PROGRAM}.py"), "exec"), vars(module))
        return module

    def tests(self) -> Iterator[tuple[str, Test]]:
        """Import the tests with the program that is there; yield each set of parameters by its name."""
        for strength in STRENGTHS:
            file = f"test_{strength}"
            space: dict[str, Any] = {"__name__": file}
            exec(_compiled(self.folder / "tests" / f"{file}.py"), space)
            for name, function in space.items():
                if name.startswith("test_"):
                    for given in _parameters(function):
                        ending = f"[{'-'.join(map(str, given.values()))}]" if given else ""
                        yield f"tests/{file}.py::{name}{ending}", _bound(function, given)

    def observe(self, module: ModuleType) -> list[str]:
        """What the program does with each input of the probe."""
        probe = importlib.import_module(PROBE)
        found = []
        for seed in range(DRAWS):
            try:
                found.append(shown(probe.observe(module, Random(seed))))
            except Exception as error:
                found.append(type(error).__name__)
        return found

    def failures(self, text: str) -> Failures:
        """The tests that fail with this text as the program, by the name of what is raised.

        If none does, and the program then does something else with an input of the probe, so does the probe.
        """
        try:
            module = self.put(text)
            tests = list(self.tests())
        except Exception as error:  # it is not even imported: whatever imports it fails
            self.put(self.source)
            return dict.fromkeys((name for name, _ in self.tests()), type(error).__name__)
        failed = _failing(tests, LONGEST)
        return failed or _failing([(PROBE, lambda: self._probe(module))], 20 * LONGEST)

    def _probe(self, module: ModuleType) -> None:
        assert self.observe(module) == self.expected

    def lines(self) -> dict[str, list[int]]:
        """The lines of the program that each test reaches."""
        reached: dict[str, list[int]] = {}
        self.put(self.source)
        for name, test in self.tests():
            found: set[int] = set()

            def look(frame: FrameType, event: str, _: Any, found: set[int] = found) -> Any:
                if frame.f_code.co_filename != str(self.folder / f"{PROGRAM}.py"):
                    return None
                if event == "line":
                    found.add(frame.f_lineno)
                return look

            sys.settrace(look)
            try:
                test()
            finally:
                sys.settrace(None)
            reached[name] = sorted(found)
        return reached

    def texts(self, families: tuple[str, ...]) -> tuple[ProgramText, ...]:
        """The program's text with the alternatives of these families that fit the types its tests see."""
        rules = [name for family in families for name in names(family)]
        texts = find_texts(self.folder, [f"{PROGRAM}.py"], rules)
        hook = SessionText(str(self.folder), Instrumentation(texts, record=True))
        hook.install()
        sys.modules.pop(PROGRAM, None)
        importlib.import_module(PROGRAM)
        for _, test in self.tests():
            assert hook.sightings is not None
            hook.sightings.start()
            test()
        assert hook.sightings is not None
        seen = hook.sightings.seen()
        compiling.steps.remove(hook)
        original = Original(
            text={0: TextSeen(sightings=seen, reached={"all": tuple(sighting.place for sighting in seen)})}
        )
        return refine(texts, original, rules)[0]

    def variants(self, families: tuple[str, ...]) -> Iterator[Variant]:
        """The bugs, and the mutants of these families."""
        for file in sorted((self.folder / "patches").glob("*.patch")):
            patch = read_patch(file.read_bytes(), self.folder, looks_like_tests)
            yield Variant("patch", "", f"{file.stem}: {patch.title}", patch.files[0].after.decode())
        for text in self.texts(families):
            for place in text.places:
                for alternative in place.alternatives:
                    what = f"{place.span.line}: {place.text} → {alternative.text}"
                    yield Variant(
                        alternative.family,
                        alternative.operator,
                        what,
                        _spliced(self.source, place.extent, alternative.text),
                    )


def _failing(tests: Iterable[tuple[str, Test]], seconds: float) -> Failures:
    found = {}
    for name, test in tests:
        try:
            with limited(seconds):
                test()
        except BaseException as error:  # also those of pytest.fail and of a hang
            found[name] = type(error).__name__
    return found


@cache
def _compiled(file: Path) -> CodeType:
    return compile(file.read_text(encoding="utf-8"), str(file), "exec")


def in_fork(work: Callable[[], Mapping[str, str]]) -> dict[str, str]:
    """Do work in a fork, and return what it returns."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        try:
            os.close(read)
            with os.fdopen(write, "w", encoding="utf-8") as pipe:
                json.dump(work(), pipe)
        finally:
            os._exit(0)
    os.close(write)
    with os.fdopen(read, encoding="utf-8") as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    found: dict[str, str] = json.loads(text)
    return found


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise HangError after so much processor time."""

    def end(*_: object) -> NoReturn:
        raise HangError

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def _parameters(function: Any) -> list[dict[str, Any]]:
    """The sets of parameters of a test."""
    for mark in getattr(function, "pytestmark", ()):
        if mark.name == "parametrize":
            given, rows = mark.args
            keys = [name.strip() for name in given.split(",")] if isinstance(given, str) else list(given)
            return [dict(zip(keys, row if len(keys) > 1 else (row,), strict=True)) for row in rows]
    return [{}]


def _bound(function: Callable[..., object], given: Mapping[str, Any]) -> Test:
    return lambda: function(**given)


def _spliced(source: str, extent: tuple[int, int, int, int], text: str) -> str:
    """The source with a text at an extent, in parentheses if it is an expression that needs them."""
    first, start, last, end = extent
    lines = [line.encode() for line in source.splitlines(keepends=True)]
    before = b"".join(lines[: first - 1]) + lines[first - 1][:start]
    after = lines[last - 1][end:] + b"".join(lines[last:])
    wrapped = (before + f"({text})".encode() + after).decode()
    try:
        compile(wrapped, PROGRAM, "exec")
    except SyntaxError:
        return (before + text.encode() + after).decode()
    return wrapped


def shown(value: object) -> str:
    """A value as text, with rounded numbers."""
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}" if math.isfinite(value) and value else "0" if not value else str(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(shown, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {shown(part)}" for key, part in value.items()) + "}"
    return repr(value)


def _fail_on_zero(value: Any) -> Any:
    if value == 0:
        raise ZeroDivisionError
    return value


def _bomb() -> NoReturn:
    raise BombError
