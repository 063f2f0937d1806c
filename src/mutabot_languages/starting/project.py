"""The project that `mutabot init` makes of robot programs: a cell map, tests and a configuration."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from mutabot_languages.core.text import decode
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.registry import language_for

from . import texts
from .signals import cell_map_text, signals_of
from .trial import LONGEST, ProgramTrial, tried


def project(root: Path, files: Sequence[Path]) -> tuple[dict[str, str], list[str]] | None:
    """The files of a project by their names, and lines that say what was found out.

    Args:
        root: the project's folder.
        files: below ``root``; those of other languages than the first one's are left out.

    Returns None if none of them is in a language of this package.
    """
    files = [one for one in files if language_for(one.name) is not None]
    language = language_for(files[0].name) if files else None
    if language is None:
        return None
    own = [one for one in files if language_for(one.name) is language]
    parsed = {one: language.read(one.name, decode(one.read_bytes())[0]) for one in own}
    main = _main({file: one.tree for file, one in parsed.items()})
    others = [one for one in own if one != main and one.parent == main.parent and _is_of(language.name, one)]
    loaded = [main, *others]
    belonging = list(dict.fromkeys([*loaded, *(one for file in loaded for one in language.beside(file))]))
    for one in belonging:
        parsed.setdefault(one, language.read(one.name, decode(one.read_bytes())[0]))
    signals = signals_of([parsed[one] for one in belonging], language.name)
    names = [one.relative_to(root).as_posix() for one in belonging]
    beside = main.parent / "cell_map.toml"
    is_mapped = beside.exists()
    cell_map = beside.read_text(encoding="utf-8") if is_mapped else cell_map_text(main.name, signals)
    made = {"mutabot.toml": texts.CONFIGURATION.format(program=json.dumps(names, ensure_ascii=False))}
    if not is_mapped:
        made[beside.relative_to(root).as_posix()] = cell_map
    told = [f"program: {', '.join(names)} ({language.name})"]
    if not any(root.glob("tests/**/test_*.py")):
        found = tried(loaded, cell_map)
        stem = re.sub(r"\W", "_", main.stem.lower())
        made[f"tests/test_{stem}.py"] = _test_text(
            [one.relative_to(root).as_posix() for one in loaded], found
        )
        told += _told(found, main.name)
    left = [one.name for one in files if one not in belonging]
    if left:
        told.append(f"left out, another program: {', '.join(left)}; name its files: mutabot init FILE…")
    return made, told


def _main(trees: dict[Path, ProgramNode]) -> Path:
    """The file with a routine ``main``, else the first with a routine of its name that no other calls."""
    called = {
        (node.name, file) for file, tree in trees.items() for node in tree.walk() if node.kind == "call"
    }
    own = {
        file: {node.name for node in tree.walk() if node.kind == "routine"} for file, tree in trees.items()
    }

    def rank(file: Path) -> tuple[bool, bool, bool]:
        stem = file.stem.lower()
        is_called = any(name == stem and other != file for name, other in called)
        return "main" not in own[file], not own[file], is_called

    return min(trees, key=rank)


def _is_of(language: str, file: Path) -> bool:
    """Whether a file beside the main one is loaded with it: modules, and programs that it may call."""
    return language == "rapid" or (language == "krl" and file.suffix.lower() == ".src")


def _test_text(files: Iterable[str], found: ProgramTrial) -> str:
    first, *others = files
    more = "".join(f", ROOT / {json.dumps(one)}" for one in others)
    given = {"program": first, "more": more, "arm": found.arm, "first": json.dumps(first)}
    if found.problem:
        return texts.TEST.format(**given, constants="", how="", checks="", name="ends")
    how = f", until=lambda: cell.time > {LONGEST:g}" if found.is_endless else ", limit=SECONDS"
    constants = texts.BOX.format(box=_numbers(found.box))
    checks = texts.CHECK_BOX
    if not found.is_endless:
        constants = (
            texts.ENDS.format(seconds=_rounded_up(found.seconds), tool=_numbers(found.tool)) + constants
        )
        checks = texts.CHECK_TOOL + checks
    return texts.TEST.format(**given, constants=constants, how=how, checks=checks, name="ends_as_it_did")


def _told(found: ProgramTrial, name: str) -> list[str]:
    if found.problem:
        why = found.problem.partition(": ")[2] or found.problem  # without the name of the exception
        return [
            f"{name} does not run to its end on the cell: {why}",
            "say in cell_map.toml, in the test or in the program what is lacking (docs/languages.md)",
        ]
    ends = (
        f"runs without an end, tested for {LONGEST:g} s"
        if found.is_endless
        else f"ends after {found.seconds:.1f} s"
    )
    return [f"{name} {ends} with the arm {found.arm}", *(f"  {one}" for one in found.notes[:5])]


def _numbers(values: Iterable[float]) -> str:
    return f"({', '.join(f'{one:.4f}' for one in values)})"


def _rounded_up(seconds: float) -> str:
    return f"{seconds * 1.1 + 0.5:.1f}"
