"""The project that `mutabot init` makes of robot programs: a cell map, tests and a configuration."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.parser import ParsedFile
from mutabot_languages.core.text import decode
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.registry import language_for

from . import texts
from .missing import missing_data
from .signals import cell_map_text, signals_of
from .trial import ARMS, LONGEST, ProgramTrial, is_of_the_arm, tried

#: files that are left out and named
_MOST_LEFT = 6


def project(root: Path, files: Sequence[Path]) -> tuple[dict[str, str], list[str]] | None:
    """Return the files of a project by their names, and lines that say what was found out.

    Args:
        root: the project's folder.
        files: below ``root``; those of other languages than the first one's are left out.

    Returns None if none of them is in a language of this package.
    """
    parsed = {file: _read(file) for file in files if language_for(file.name) is not None}
    main = _main({file: parse.tree for file, parse in parsed.items()})
    language = language_for(main.name) if main is not None else None
    if main is None or language is None:
        return None
    own = {file: parse.tree for file, parse in parsed.items() if language_for(file.name) is language}
    loaded = _needed(main, language, own)
    belonging = list(dict.fromkeys([*loaded, *(path for file in loaded for path in language.beside(file))]))
    texts_of_files = [parsed.get(path) or _read(path) for path in belonging]
    signals, missing = signals_of(texts_of_files, language.name), missing_data(texts_of_files, language.name)
    names = [path.relative_to(root).as_posix() for path in belonging]
    given = [path.relative_to(root).as_posix() for path in loaded]
    beside = main.parent / "cell_map.toml"
    is_mapped = beside.exists()
    cell_map = beside.read_text(encoding="utf-8") if is_mapped else cell_map_text(main.name, signals)
    made, lines = dict[str, str](), list[str]()
    if missing is not None:
        name = (main.parent / missing[0]).relative_to(root).as_posix()
        made[name] = missing[1]
        names, given = [*names, name], [*given, name]
        lines = [f"drafted in {name}, as no file declares it: {', '.join(missing[2])}: put in what is right"]
    made["mutabot.toml"] = texts.CONFIGURATION.format(program=json.dumps(names, ensure_ascii=False))
    if not is_mapped:
        made[beside.relative_to(root).as_posix()] = cell_map
    lines = [f"program: {', '.join(names)} ({language.name})", *lines]
    if not any(root.glob("tests/**/test_*.py")):
        found = tried(loaded, cell_map, missing)
        stem = re.sub(r"\W", "_", main.stem.lower())
        made[f"tests/test_{stem}.py"] = _test_text(given, found)
        lines += _summary(found, main.name)
    left = [file.relative_to(root).as_posix() for file in files if file not in belonging]
    if left:
        more = f" and {len(left) - _MOST_LEFT} more" if len(left) > _MOST_LEFT else ""
        lines.append(
            f"left out, as {main.name} needs nothing of them: {', '.join(left[:_MOST_LEFT])}{more}; for "
            "another program, name its files: mutabot init FILE…"
        )
    return made, lines


def _read(file: Path) -> ParsedFile:
    language = language_for(file.name)
    assert language is not None
    return language.read(file.name, decode(file.read_bytes())[0])


def _main(trees: dict[Path, ProgramNode]) -> Path | None:
    """Return the file with a routine ``main``, else the first with a routine of its name that no other calls.

    None if nothing in these files can be carried out.
    """
    called = {file: _names(tree, "call") for file, tree in trees.items()}
    own = {file: _names(tree, "routine") for file, tree in trees.items()}

    def rank(file: Path) -> tuple[bool, bool, bool, int]:
        stem = file.stem.lower()
        is_called = any(stem in names for other, names in called.items() if other != file)
        return "main" not in own[file], not own[file], is_called, len(file.parts)

    programs = [file for file in trees if own[file] or called[file]]
    return min(programs, key=rank, default=None)


def _needed(main: Path, language: RobotLanguage, trees: dict[Path, ProgramNode]) -> list[Path]:
    """Return the file, and those that have what it names and does not have itself, the nearest first."""
    dialect, found, waiting = language.dialect(), [main], [main]
    has = {file: _names(tree, "routine", *_data(file)) for file, tree in trees.items()}
    near = sorted(trees, key=lambda path: (os.path.relpath(path, main.parent).count(os.sep), path))
    while waiting:
        tree = trees[waiting.pop(0)]
        lacking = _names(tree, "call", "name", "text") - _names(tree, "routine", "declare", "parameter")
        lacking -= {*dialect.functions, *dialect.ignored, *(name for file in found for name in has[file])}
        for file in near:
            if file not in found and lacking & has[file] and "main" not in has[file]:
                lacking -= has[file]
                found.append(file)
                waiting.append(file)
    return found


def _data(file: Path) -> list[str]:
    """Return which data of a file others may name: of KRL, that of ``$config.dat`` alone."""
    return [] if file.suffix.lower() in (".src", ".sub", ".dat") and file.name[0] != "$" else ["declare"]


def _names(tree: ProgramNode, *kinds: str) -> set[str]:
    """Return the names of nodes, and the texts: RAPID may call by them."""
    found = (node.value if node.kind == "text" else node.name for node in tree.walk() if node.kind in kinds)
    return {str(item).lower() for item in found}


def _test_text(files: Iterable[str], found: ProgramTrial) -> str:
    first, *others = files
    more = "".join(f", ROOT / {json.dumps(other)}" for other in others)
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


def _summary(found: ProgramTrial, name: str) -> list[str]:
    if found.problem:
        why = found.problem.partition(": ")[2] or found.problem  # without the name of the exception
        lacking = "say in cell_map.toml, in the test or in the program what is lacking (docs/languages.md)"
        if is_of_the_arm(found.problem):
            lacking = f"none of the arms {', '.join(ARMS)} carries it out: docs/languages.md says what to do"
        return [f"{name} does not run to its end on the cell: {why}", lacking]
    ends = (
        f"runs without an end, tested for {LONGEST:g} s"
        if found.is_endless
        else f"ends after {found.seconds:.1f} s"
    )
    idle = (
        [] if found.seconds else ["it does nothing in the cell: name the file that does: mutabot init FILE…"]
    )
    return [f"{name} {ends} with the arm {found.arm}", *(f"  {note}" for note in found.notes[:5]), *idle]


def _numbers(values: Iterable[float]) -> str:
    return f"({', '.join(f'{value:.4f}' for value in values)})"


def _rounded_up(seconds: float) -> str:
    return f"{seconds * 1.1 + 0.5:.1f}"
