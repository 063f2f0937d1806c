"""Find which files of the program tests may run in processes that cannot join the campaign.

No mutant of a call acts there, so that such a test does not judge it: plain pytest may notice what all tests
let through. One of the text acts, as the file itself is changed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.project_files import python_files
from mutabot.languages.imported_names import ANY, imported_names
from mutabot.languages.registry import program_files
from mutabot.model.source_units import AS_TEXT, WHOLE, Executed, together

if TYPE_CHECKING:
    from mutabot.model.events import OutOfReach, TestEnd


def files_out_of_reach(
    root: Path, program: Iterable[str], ends: Sequence[TestEnd]
) -> dict[str, dict[str, str]]:
    """Return, by test, the files of the program that run so, each with the command and why."""
    ends = [end for end in ends if end.out_of_reach]
    files = program_files(root, program) if ends else []
    project = python_files(root) if ends else []
    return {
        end.test: {
            file: f"{process.command} ({process.why})"
            for process in end.out_of_reach
            for file in _files_of(process, root, files, project)
        }
        for end in ends
    }


def with_texts(executed: Executed | None, files: Iterable[str]) -> Executed | None:
    """Return what a test executes with the files that it runs out of reach, which are read as text there."""
    return together([executed, dict.fromkeys(files, (AS_TEXT, WHOLE))])


def _files_of(
    process: OutOfReach, root: Path, program: Collection[str], project: Collection[str]
) -> Collection[str]:
    """Return the files of the program that a process names, and those that they import, or may import.

    Imports are followed through all files of the project.
    """
    if process.files is None:
        return program
    files = dict.fromkeys([*program, *project])
    named = {file for file in files if str((root / file).resolve()) in process.files}
    waiting = [*named, *(file for file in files if _is_named(file, process.imports))]
    found, names = set[str](), {*process.imports}
    while waiting and ANY not in names:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            new = imported_names((root / file).read_bytes())
            names |= new
            waiting += [other for other in files if _is_named(other, new)]
    return program if ANY in names else sorted(found.intersection(program))


def _is_named(file: str, names: Iterable[str]) -> bool:
    """Return whether one of these names is that of a file's module, of a package around it, or in it."""
    parts = [*Path(file).with_suffix("").parts]
    last = parts[-2:-1] if parts[-1] == "__init__" else parts[-1:]
    return any(set(last) <= set(name.split(".")) for name in names)
