"""Write the picture of the rooms into docs/design.md, from the real imports.

Use: ``python tools/make_design_page.py``; with ``--check`` nothing is written, and the exit code is 1 if the
picture is out of date. With ``--modules PACKAGE`` it prints what each module of a package is.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

from rooms import SOURCE, Graph, among, direct, gathered, levels, rooms

PAGE = Path(__file__).parents[1] / "docs" / "design.md"
BEGIN, END = "<!-- rooms: written by tools/make_design_page.py from the imports -->", "<!-- end of rooms -->"
#: files that belong to no room: plug-ins and `python -m mutabot` begin there
_DOORS = ("__init__", "__main__")
#: so few words before a colon say nothing alone
_BARE = 2


def picture() -> str:
    """The text between the marks."""
    graph = rooms()
    whole = gathered(graph)
    drawn = _drawn(among(whole, (room for room in whole if room not in _DOORS)))
    return "\n".join(["", "```text", *drawn, "```", ""])


def _listed(folder: Path) -> Iterator[str]:
    """One line for each module of a package: its name and what it is."""
    modules = [file for file in sorted(folder.rglob("*.py")) if file.stem not in _DOORS]
    names = [str(file.relative_to(folder).with_suffix("")) for file in modules]
    for name, file in zip(names, modules, strict=True):
        yield f"{name:<{max(map(len, names))}}  {_summary(str(file.relative_to(SOURCE)))}"


def _drawn(graph: Graph) -> Iterator[str]:
    """Two lines per room, the highest first: level, name, the rooms directly below it; and what it is."""
    found = levels(graph)
    ordered = sorted(graph, key=lambda room: (-found[room], room))
    names = max(len(_short(room)) for room in ordered)
    before = None
    for room in ordered:
        mark = f"{found[room]:>2}" if found[room] != before else "  "
        before = found[room]
        on = ", ".join(sorted(map(_short, direct(graph, room))))
        yield f"{mark}  {_short(room):<{names}}  {f'→ {on}' if on else ''}".rstrip()
        yield f"    {'':<{names}}  {_summary(room)}"


def _short(room: str) -> str:
    return room.partition("/")[2] or room


def _summary(room: str) -> str:
    """The first sentence that the room says of itself, up to a colon unless little stands before it."""
    folder = SOURCE / room
    file = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    sentence = text.partition("\n\n")[0].replace("\n", " ").replace("`", "").partition(". ")[0]
    short = sentence.partition(":")[0]
    return (short if len(short.split()) > _BARE else sentence).rstrip(".")


def with_picture(text: str) -> str:
    """The page with the picture as it is now."""
    head, _, rest = text.partition(BEGIN)
    return f"{head}{BEGIN}\n{picture()}\n{END}{rest.partition(END)[2]}"


def main() -> int:
    """Write the picture, or check it."""
    if "--modules" in sys.argv:
        print("\n".join(_listed(SOURCE / sys.argv[-1])))
        return 0
    old = PAGE.read_text(encoding="utf-8")
    new = with_picture(old)
    if "--check" in sys.argv:
        return int(new != old)
    PAGE.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
