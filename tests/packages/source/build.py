"""Program texts with chosen alternatives, built as files and run as modules."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from mutabot.model import Alternative, Instrumentation, ProgramText, Sighting, TextPlace
from mutabot.original import Original, TextSeen
from mutabot.runtime.program_text import compiling
from mutabot.runtime.program_text.instrument import SessionText
from mutabot.runtime.program_text.switches import hand_through
from mutabot_source.nodes import same_program
from mutabot_source.operator import TextExample
from mutabot_source.refine import refine
from mutabot_source.registry import names
from mutabot_source.texts import find_texts


def text_of(folder: Path, source: str, *operators: str) -> ProgramText:
    """The places of a source; all operators if none is named."""
    name = f"program_{sha256(source.encode()).hexdigest()[:8]}.py"
    (folder / name).write_text(source, encoding="utf-8")
    (text,) = find_texts(folder, [name], operators or names())
    return text


def refined(text: ProgramText, example: TextExample) -> ProgramText:
    """The text after a baseline that saw what the example says."""
    seen = []
    for place in text.places:
        kinds = (example.kinds.get(place.text, "number"),)
        seen.append(Sighting(place.number, 1, kinds, example.variables.get(place.text, ())))
    (text,), _ = refine([text], seen_in(seen))
    return text


def seen_in(*rounds: Sequence[Sighting]) -> Original:
    """An original whose only test reached these places, and saw this there in each round."""
    texts = (
        TextSeen(sightings=(*sightings,), reached={"test": tuple(seen.place for seen in sightings)})
        for sightings in rounds
    )
    return Original(text=dict(enumerate(texts)))


def spliced(source: str, place: TextPlace, alternative: Alternative) -> str:
    """The source with the alternative in its place, in parentheses where it needs them."""
    lines = source.encode().splitlines(keepends=True)
    first, start, last, end = place.extent
    before = b"".join(lines[: first - 1]) + lines[first - 1][:start]
    after = lines[last - 1][end:] + b"".join(lines[last:])
    if place.statement:
        return (before + alternative.text.encode() + after).decode()
    bare = (before + alternative.text.encode() + after).decode()
    wrapped = (before + f"({alternative.text})".encode() + after).decode()
    return bare if same_program(bare, wrapped) else wrapped


@contextmanager
def imported(
    folder: Path, text: ProgramText, *active: tuple[int, int], record: bool = False
) -> Iterator[tuple[ModuleType, SessionText]]:
    """The module of a text, instrumented, and the hook."""
    hook = SessionText(str(folder), Instrumentation((text,), record))
    for place, index in active:
        hook.alternatives.activate(place, index)
    hook.install()
    try:
        yield load(folder / text.file), hook
        assert not hook.problems
    finally:
        switch_off(hook)
        sys.modules.pop(Path(text.file).stem, None)


def switch_off(hook: SessionText) -> None:
    """Import as ever from now on; text that is instrumented goes on as the original."""
    compiling.steps.remove(hook)
    hook.alternatives.activate()
    if hook.sightings is not None:
        hook.sightings.switches[1:] = [hand_through] * (len(hook.sightings.switches) - 1)


def load(path: Path) -> ModuleType:
    """A fresh module of a file."""
    spec = spec_from_file_location(path.stem, path, loader=SourceFileLoader(path.stem, str(path)))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[path.stem] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def choices(text: ProgramText) -> list[tuple[tuple[int, int], TextPlace, Alternative]]:
    """All alternatives of a text."""
    return [
        ((place.number, index), place, alternative)
        for place in text.places
        for index, alternative in enumerate(place.alternatives)
    ]


def run_plainly(source: str, names: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """What a source leaves behind when it is run as it stands."""
    space: dict[str, Any] = dict(names or {})
    exec(compile(source, "<plain>", "exec"), space)
    return space
