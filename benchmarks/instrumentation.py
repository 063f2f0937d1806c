"""What instrumented program text costs: per evaluated place, and as a factor on whole programs.

Usage: python benchmarks/instrumentation.py
"""

from __future__ import annotations

import ast
import builtins
import tempfile
import time
import timeit
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from mutabot.model import Instrumentation, ProgramText
from mutabot.model.program_text import RUNTIME
from mutabot.runtime.program_text import compiling
from mutabot.runtime.program_text.compiling import compile_tree
from mutabot.runtime.program_text.instrument import SessionText, instrumented
from mutabot_source.registry import names
from mutabot_source.texts import find_texts

#: many places per line and nothing else: the worst there is
DENSE = """
def run(n):
    x, y, total = 1.5, 2.5, 0.0
    for i in range(n):
        if x < y and i >= 0:
            total += x * y - i / (x + 1.0)
        x, y = y - 0.5, x + 0.5
    return total
"""
#: functions, strings, containers: as programs are
ORDINARY = """
def words(text):
    found = {}
    for line in text.splitlines():
        for word in line.strip().lower().split():
            word = word.strip(".,;:!?")
            if word and not word.isdigit():
                found[word] = found.get(word, 0) + 1
    return sorted(found.items(), key=lambda item: (-item[1], item[0]))[:10]

def run(n):
    text = "The quick brown fox, 42 times; the lazy dog.\\n" * 20
    return [words(text) for _ in range(n)]
"""
PROGRAMS = {"dense arithmetic": (DENSE, 20_000), "counting words": (ORDINARY, 30)}


def main() -> None:
    """Print the costs, best of several."""
    with tempfile.TemporaryDirectory() as name:
        for title, (source, size) in PROGRAMS.items():
            _program(Path(name), title, source, size)


def _program(folder: Path, title: str, source: str, size: int) -> None:
    file = f"{title.replace(' ', '_')}.py"
    (folder / file).write_text(source, encoding="utf-8")
    (text,) = find_texts(folder, [file], names())
    plain = _seconds(_loaded(folder / file).run, size)
    count = sum(len(place.alternatives) for place in text.places)
    print(f"{title}: {len(text.places)} places, {count} alternatives")
    _compile(source, text)
    evaluated = _evaluations(folder, text, size)
    with_hook = _hooked(folder, text)
    off = _seconds(with_hook, size)
    per_place = (off - plain) / evaluated * 1e9
    print(f"  nothing active         {off / plain:6.2f} x, {per_place:6.1f} ns per evaluated place")
    alone = _seconds(_hooked(folder, _only_first(text)), size)
    print(f"  one place in it        {alone / plain:6.2f} x")
    recording = _hooked(folder, text, record=True)
    on = _seconds(recording, size)
    per_place = (on - plain) / evaluated * 1e9
    print(f"  recording              {on / plain:6.2f} x, {per_place:6.1f} ns per evaluated place")


def _only_first(text: ProgramText) -> ProgramText:
    return ProgramText(text.file, text.digest, text.places[:1])


def _compile(source: str, text: ProgramText) -> None:
    started = time.perf_counter()
    compile_tree(instrumented(ast.parse(source), text.places), text.file)
    print(f"  compiling              {(time.perf_counter() - started) * 1e3:6.1f} ms")


class _Counter:
    """A switch that counts and stays off."""

    def __init__(self) -> None:
        self.count = 0

    def chosen(self) -> bool:
        """Asked at every evaluation."""
        self.count += 1
        return False


def _evaluations(folder: Path, text: ProgramText, size: int) -> int:
    hook = SessionText(str(folder), Instrumentation((text,)))
    hook.install()
    counter = _Counter()
    hook.alternatives.switches[1:] = [counter] * len(text.places)
    try:
        _loaded(folder / text.file).run(size)
    finally:
        compiling.steps.remove(hook)
    return counter.count


def _hooked(folder: Path, text: ProgramText, *, record: bool = False) -> Callable[[int], Any]:
    hook = SessionText(str(folder), Instrumentation((text,), record))
    hook.install()
    try:
        run: Callable[[int], Any] = _loaded(folder / text.file).run
    finally:
        compiling.steps.remove(hook)
    setattr(builtins, RUNTIME, (hook.sightings or hook.alternatives).switches)
    if hook.sightings is not None:
        hook.sightings.start()
    return run


def _loaded(path: Path) -> ModuleType:
    spec = spec_from_file_location(path.stem, path, loader=SourceFileLoader(path.stem, str(path)))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _seconds(run: Callable[[int], Any], size: int) -> float:
    return min(timeit.repeat(lambda: run(size), number=1, repeat=15))


if __name__ == "__main__":
    main()
