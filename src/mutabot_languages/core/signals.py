"""The cell map: what the signals and functions of a program are in the cell, from a TOML file.

tool = [0, 0, 0.1, 0, 0, 0]        # the cell's tool point on the program's flange: m and degrees (x, y, z)

[out.grip]                         # names as the program has them: grip, "$OUT[9]", "standard_digital_out[0]"
gripper = [0, 1]                   # the gripper's command for 0 and for 1

[in.part]
light_barrier = "infeed"

[function.rq_close_and_wait]       # a function of the program, or of its maker, that is carried out so
gripper = 1
wait = 0.8
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot_languages.errors import LanguageError

#: the tables of a cell map, and what an entry in each may say
_TABLES: Mapping[str, set[str]] = {
    "tool": set(),
    "out": {"gripper", "suction", "belt", "speed", "force"},
    "in": {"light_barrier", "holding", "colour", "nearer", "opening", "constant", "output", "distance"},
    "function": {"gripper", "suction", "wait", "force", "result"},
}

InputReader = Callable[[], Any]


@dataclass(frozen=True, slots=True)
class CellMap:
    """What signals and functions are.

    Attributes:
        tool: of the cell's tool point on the program's flange: m, and degrees about x, y and z.
        outputs, inputs, functions: by name, as ``signal_name`` writes it.
    """

    tool: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    outputs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    inputs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    functions: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path) -> CellMap:
        """Read a file. Raises LanguageError, naming the file, the name and what would be right."""
        import tomllib  # noqa: PLC0415  # reports name languages, and read no file

        try:
            data = tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise LanguageError(f"{path}: the cell map cannot be read: {error}") from None
        for table, known in _TABLES.items():
            for name, entry in data.get(table, {}).items() if known else ():
                unknown = set(entry) - known if isinstance(entry, dict) else {repr(entry)}
                if unknown:
                    raise LanguageError(
                        f"{path}: {table}.{name}: unknown {', '.join(sorted(unknown))}; there are "
                        f"{', '.join(sorted(known))}"
                    )
        if unknown := set(data) - set(_TABLES):
            raise LanguageError(
                f"{path}: unknown {', '.join(sorted(unknown))}; there are {', '.join(_TABLES)}"
            )
        tool = data.get("tool", cls().tool)
        if not (isinstance(tool, (list, tuple)) and len(tool) == 6):
            raise LanguageError(f"{path}: tool = {tool!r}: expected x, y, z in m and three angles in degrees")
        named = [
            {signal_name(name): entry for name, entry in data.get(table, {}).items()}
            for table in ("out", "in", "function")
        ]
        return cls(tuple(float(number) for number in tool), *named)


def signal_name(text: str) -> str:
    """Return a signal's name as maps compare it: no spaces, small letters."""
    return "".join(text.split()).lower()
