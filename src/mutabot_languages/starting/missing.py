"""Data that a program names and none of its files declares: a draft of it, where one can be made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mutabot_languages.core.parser import ParsedFile
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.rapid.dialect import predefined
from mutabot_languages.rapid.types import STRUCTURES

from . import texts


def missing_data(files: Sequence[ParsedFile], language: str) -> tuple[str, str, list[str]] | None:
    """Return a file for what these files lack: its name, its text, and the names that it declares.

    Of RAPID, tools and work objects of motions; of KRL, what every controller's ``$config.dat`` has. None if
    nothing of the kind is missing.
    """
    nodes = [node for file in files for node in file.tree.walk()]
    declared = {node.name for node in nodes if node.kind in ("declare", "parameter")}
    if language == "rapid":
        lines = {name: texts.RAPID_DATA[type].format(name) for name, type in _of_rapid(nodes)}
        file, frame = "MissingData.mod", texts.RAPID_MODULE
    elif language == "krl" and not any(file.source.name.lower() == "$config.dat" for file in files):
        lines = {node.name: texts.KRL_DATA[node.name] for node in nodes if node.name in texts.KRL_DATA}
        file, frame = "$config.dat", texts.KRL_CONFIG
    else:
        return None
    lacking = [name for name in lines if name not in declared and predefined(name, STRUCTURES) is None]
    if not lacking:
        return None
    return file, frame.format("\n".join(lines[name] for name in lacking)), lacking


def _of_rapid(nodes: Sequence[ProgramNode]) -> Iterator[tuple[str, str]]:
    for node in nodes:
        plain = node.plain
        if node.kind == "option" and node.name in ("tool", "wobj"):
            yield from ((part.name, f"{node.name}data") for part in plain if part.kind == "name")
        elif node.kind == "call" and node.name.startswith(("move", "trigg")):
            at = 3 + node.name.startswith(("movec", "triggc")) + node.name.startswith("trigg")
            yield from ((part.name, "tooldata") for part in plain[at : at + 1] if part.kind == "name")
