"""Write docs/conventional.md from the examples of the operators on program text.

Use: ``python tools/make_conventional_page.py``; with ``--check`` nothing is written, and the exit code is 1
if the page is out of date.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from mutabot_source.operator import ConventionalOperator, TextExample
from mutabot_source.registry import names, operator

PAGE = Path(__file__).parents[1] / "docs" / "conventional.md"

HEAD = """\
# Conventional operators on program text

<!-- Written by tools/make_conventional_page.py from the operators' own examples. Do not edit. -->

The operators of textbooks change the text of a program and know nothing of robots. They are here to be
compared with those that do ([operators](operators.md)).

`mutabot run --family conventional` (or `text`, or `robot,conventional,text`; also for `list` and `check`)
plants them, as does `families = ["robot", "conventional"]` in the configuration. They run in the same
engines, are judged and reported in the same way, and have scores of their own. Mutants of calls come first
and keep their numbers.

No file is changed for it. While the program is imported, each place with alternatives is compiled as *the
original, unless an alternative is chosen*, with the lines and columns of your text: tracebacks and
`inspect.getsource` show what you wrote. There is no function around anything, so short circuits, chained
comparisons, `await`, `yield`, `:=`, `super()`, `locals()` and class bodies mean what they meant.

## What is left out

- Annotations, patterns of `match`, docstrings, imports and definitions: nothing is computed there.
- Blocks under `if TYPE_CHECKING` and `if __name__ == "__main__"`: tests do not run them.
- Alternatives of a type that the value never had in the baseline, such as a minus before a text; they are
  listed with the reason. Which variables may stand for one another is seen in the baseline as well.
- Expressions of more than 1000 characters, and expressions that stand twice in one f-string (before Python
  3.12, which reports one place for both).
- Programs that are not imported: those started with `runpy.run_path` or as a process of their own.
- The plus of UOI, which changes no number; ABS of literals, whose sign is UOI's; plain assignments for ASR,
  since a name may have no value before.

An alternative that has the original's value has not acted. That is known where the original is a part of the
alternative, or is made of names, constants, operators, plain attributes and items, or functions of
mathematics; any other alternative counts as having acted when it is reached.

Values that are computed while the program is imported (constants, taught points, default arguments of
functions at the top level) have mutants too; all tests judge them.

"""

COST = """\
## What it costs

`python benchmarks/instrumentation.py` measures it, `python benchmarks/stdlib_corpus.py` runs modules of the
standard library with all alternatives of all operators in them through their own tests.
"""


def page() -> str:
    """The text of the page."""
    lines = [HEAD + "| operator | the fault |", "|---|---|"]
    lines += [f"| [{name}](#{name.lower()}) | {operator(name).summary} |" for name in names()]
    for name in names():
        lines += _section(operator(name))
    return "\n".join([*lines, "", COST])


def _section(each: ConventionalOperator) -> Iterator[str]:
    yield from ("", f"## {each.name}", "", each.summary, "")
    yield from ("| original | mutants | note |", "|---|---|---|")
    for example in each.examples:
        if example.after:
            after = " · ".join(_code(text) for text in example.after)
            yield f"| {_code(example.before)} | {after} | {_note(example)} |"
    yield from ("", "It stays away from:", "")
    for example in each.examples:
        if not example.after:
            note = _note(example)
            yield f"- {_code(example.before)}{f': {note}' if note else ''}"


def _code(text: str) -> str:
    shown = text.strip().replace("\n", " ⏎ ").replace("|", "\\|")
    return f"`{' '.join(shown.split())}`"


def _note(example: TextExample) -> str:
    kinds = [kind.partition(":")[2] or kind for kind in example.kinds.values()]
    seen = f"of type {kinds[0]}" if kinds and example.after else ""
    others = [f"`{name}` has the type of {_listed(found)}" for name, found in example.variables.items()]
    return "; ".join(part for part in (example.note, seen, *(others if example.after else [])) if part)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def main() -> int:
    """Write the page, or check it."""
    if "--check" in sys.argv[1:]:
        current = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
        return 0 if current == page() else 1
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
