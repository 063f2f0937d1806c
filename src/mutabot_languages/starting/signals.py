"""The signals that a program names, and a draft of what they are in the cell."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from mutabot_languages.core.parser import ParsedFile
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.rapid.dialect import predefined
from mutabot_languages.rapid.types import STRUCTURES

_GRIPPER = re.compile(r"grip|greif|pinz|vac|ventos|suction|finger|tool", re.IGNORECASE)
_OPENING = re.compile(r"open|auf|release|abr", re.IGNORECASE)
_HOLDING = re.compile(r"hold|grip|greif|part|box|pinz", re.IGNORECASE)
_UR = re.compile(
    r"(?P<way>[gs]et)_(?P<name>(?:standard_|configurable_|tool_)?(?:digital|analog))_(?P<side>in|out)"
)
_RAPID_OUT = re.compile(r"(?:set|reset|setdo|setgo|setao|pulsedo|invertdo|move[jlc](?:do|ao|go))")
_RAPID_IN = re.compile(r"(?:testdi|[dga]input|ginputdnum|wait[dga]i)")
_HEAD = """# What the signals of {name} are in the cell: guessed by their names, so say what is right.
# Outputs: gripper, suction, belt and speed, force. Inputs: holding, light_barrier, colour, nearer, opening,
# distance, output, constant.
"""


@dataclass(frozen=True, slots=True)
class NamedSignal:
    """A signal that a program names.

    Attributes:
        name: as cell maps have it.
        is_output: whether the program sets it.
        meaning: the name from which its use is guessed; a numbered signal has that of the program.
        value: what the program waits for, of an input.
    """

    name: str
    is_output: bool
    meaning: str
    value: bool = True


def signals_of(files: Sequence[ParsedFile], language: str) -> list[NamedSignal]:
    """Return the signals that files in a language name, in the order of their names, each once."""
    reader = {"rapid": _of_rapid, "krl": _of_krl, "urscript": _of_urscript}[language]
    found: dict[tuple[bool, str], NamedSignal] = {}
    for signal in reader([node for file in files for node in file.tree.walk()]):
        known = found.get((signal.is_output, signal.name.lower()))
        if known is None or (known.meaning == known.name != signal.meaning):
            found[signal.is_output, signal.name.lower()] = signal
    return [replace(found[key], name=_written(found[key].name, files)) for key in sorted(found, reverse=True)]


def _written(name: str, files: Sequence[ParsedFile]) -> str:
    matches = (
        re.search(rf"\b{name}\b", file.source.text, re.IGNORECASE) for file in files if name.isidentifier()
    )
    return next((match[0] for match in matches if match), name)


def cell_map_text(name: str, signals: list[NamedSignal]) -> str:
    """Return the cell map of a program. It asks the user for what is unknown."""
    outputs = [named_signal for named_signal in signals if named_signal.is_output]
    lines = [_HEAD.format(name=name)]
    for signal in signals:
        key = f"[{'out' if signal.is_output else 'in'}.{json.dumps(signal.name)}]"
        if not signal.is_output:
            is_held = bool(_HOLDING.search(signal.meaning)) and signal.value
            value = "holding = true" if is_held else f"constant = {str(signal.value).lower()}"
            lines.append(f"{key}\n{value}{'' if is_held else '  # what is it in the cell?'}\n")
        elif _GRIPPER.search(signal.meaning) or len(outputs) == 1:
            value = "[1, 0]" if _OPENING.search(signal.meaning) else "[0, 1]"
            lines.append(f"{key}\ngripper = {value}  # the gripper's command for 0 and for 1\n")
        else:
            lines.append(f"# {key}  # what is it in the cell?\n")
    return "\n".join(lines)


def _of_rapid(nodes: list[ProgramNode]) -> Iterator[NamedSignal]:
    declared = {node.name for node in nodes if node.kind in ("declare", "parameter", "routine", "for")}

    def named(node: ProgramNode, *, is_output: bool, value: bool = True) -> Iterator[NamedSignal]:
        is_own = (
            node.name in declared or node.name == "errno" or predefined(node.name, STRUCTURES) is not None
        )
        if node.kind == "name" and not is_own:
            yield NamedSignal(node.name, is_output, node.name, value)

    outputs = {
        name_node.name
        for node in nodes
        if node.kind == "call" and _RAPID_OUT.fullmatch(node.name)
        for name_node in _signal_parts(node)
    }
    for node in nodes:
        if node.kind == "call" and _RAPID_OUT.fullmatch(node.name):
            for part in _signal_parts(node):
                yield from named(part, is_output=True)
        elif node.kind == "call" and _RAPID_IN.fullmatch(node.name) and node.parts:
            yield from named(node.parts[0], is_output=False, value=_wanted(node.parts[1:]))
        elif node.kind in ("if", "while", "binary", "unary") or node.name == "waituntil":
            for part in node.parts if node.name not in ("+", "-", "*", "/", "<", ">") else ():
                if part.name not in outputs:
                    yield from named(part, is_output=False, value=_wanted(node.parts[1:]))


def _signal_parts(node: ProgramNode) -> list[ProgramNode]:
    plain = node.plain
    return plain[-2:-1] if node.name.startswith("move") else plain[:1]


def _of_krl(nodes: list[ProgramNode]) -> Iterator[NamedSignal]:
    names = {_indexed(node.parts[0]): node.name for node in nodes if node.kind == "signal"}
    low = {
        _indexed(node.parts[0])
        for node in nodes
        if node.kind == "binary" and node.name == "==" and not _wanted(node.parts[1:])
    }
    for node in nodes:
        name = _indexed(node)
        if name and name.startswith(("$IN", "$OUT", "$ANIN", "$ANOUT")):
            is_output = name.startswith(("$OUT", "$ANOUT"))
            alias = names.get(name, name)
            yield NamedSignal(name, is_output, alias, not {name, alias} & low)


def _indexed(node: ProgramNode) -> str:
    """Return ``$IN[25]`` for such a node, the name of another, and nothing for other expressions."""
    if node.kind == "index" and node.parts[0].kind == "name" and node.parts[1].kind == "number":
        return f"{node.parts[0].name.upper()}[{node.parts[1].value}]"
    return node.name if node.kind == "name" else ""


def _of_urscript(nodes: list[ProgramNode]) -> Iterator[NamedSignal]:
    for node in nodes:
        found = _UR.fullmatch(node.name) if node.kind == "call" else None
        is_signal = found is not None and (found["way"] == "set") == (found["side"] == "out")
        if found and is_signal and node.parts and node.parts[0].kind == "number":
            signal = f"standard_{found['name']}" if "_" not in found["name"] else found["name"]
            name = f"{signal}_{found['side']}[{node.parts[0].value}]"
            yield NamedSignal(name, found["side"] == "out", name)


def _wanted(parts: Sequence[ProgramNode]) -> bool:
    """Return whether a signal is compared with something else than 0 and FALSE."""
    return not any(part.kind in ("number", "constant") and not part.value for part in parts[:1])
