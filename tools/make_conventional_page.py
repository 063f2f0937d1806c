"""Write docs/conventional.md from the examples of the operators on program text.

Use: ``python tools/make_conventional_page.py``; with ``--check`` nothing is written, and the exit code is 1
if the page is out of date.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from mutabot_source.operator import ConventionalOperator, TextExample
from mutabot_source.registry import names, operator

PAGE = Path(__file__).parents[1] / "docs" / "conventional.md"

HEAD = """\
# Conventional operators on program text

<!-- Written by tools/make_conventional_page.py from the operators' own examples. Do not edit. -->

The operators of textbooks change program text and know nothing of robots. Use them to compare with the
[robot operators](operators.md): `--family conventional`, `text` or `robot,conventional,text`. Family `bugs`
has what [real bugs](real-bugs.md) of robot programs ask for beyond these; it runs only if it is named.

No file is changed: while the program is imported, each place is compiled as *the original, unless an
alternative is chosen*. Tracebacks show your text. Values computed during import (constants, taught points,
defaults of functions) have mutants too; all tests judge them.

A file that tests read as text (`inspect.getsource`, `exec` or `ast.parse` of what they have read, a copy
that they import, a command such as `grep` that names it; in their process or below it) is really changed as
well, for the process of one mutant and all below it. A mutant is [forked](engines.md) before the first
reader at the latest, or, if the file may be read before any test, runs in processes of its own. All tests
from the first reader on judge: with a reader early in the suite a mutant takes two to three times as long. If
no mutant matters to such a test, leave it out (`pytest_args = ["--deselect", "tests/test_i18n.py"]`). Your
files stay as they are; where [files cannot be private](shared-state.md), such mutants are errors.

An alternative with the original's value has not acted. mutabot knows this of plain values and numbers of
numpy where the original is a part of the alternative, or can be [evaluated
beforehand](engines.md#mutants-of-the-program-text). Any other alternative counts as having acted when it is
reached: mutabot runs no operator of your classes to find out, and two equal lists or arrays are two objects.

## What is left out

- Annotations, patterns of `match`, docstrings, imports, definitions; blocks under `if TYPE_CHECKING` and
  `if __name__ == "__main__"`.
- Alternatives of a type that the value never had in the baseline, listed with the reason.
- Expressions of more than 1000 characters, and, before Python 3.12, those that stand twice in one f-string.
- Types are those that the tests saw. Where [no test comes](verdicts.md#what-no-test-reaches), all that may
  fit counts as *not covered*; a variable becomes each other one that its function reads.
- What is another operator's (a literal's sign is UOI's, not ABS's) or changes nothing.
- Plain assignments for ASR: the name may have no value yet.
- Text arguments that do not stand in the call, or are formatted, for the operators on characters.
- Files whose code comes neither from the import system, an import hook, `runpy` nor
  `exec(compile(text, path))`, or is compiled from another text than the file holds. They are listed with the
  reason; calls of the robot are still seen.

## The operators
"""
#: so many mutants of an example stand on the page
_SHOWN = 3


def page() -> str:
    """The text of the page."""
    lines = [HEAD.rstrip()]
    for name in names():
        lines += _section(operator(name))
    return "\n".join([*lines, ""])


def _section(each: ConventionalOperator) -> Iterator[str]:
    yield from ("", f"### {each.name}", "", each.summary, "")
    acting = [example for example in each.examples if example.after]
    for place, example in enumerate(acting):
        note = _note(example)
        if place and not example.note:
            continue
        before, *mutants = _without_target([example.before, *example.after])
        after = [_code(text) for text in mutants]
        if len(after) > _SHOWN + 1:
            after[_SHOWN:] = ["…"]
        yield f"- {_code(before)} → {', '.join(after)}{f' ({note})' if note else ''}"


def _without_target(texts: list[str]) -> list[str]:
    """The values alone, where all texts assign to one variable."""
    target = re.match(r"\w+ = ", texts[0])
    if target and all(text.startswith(target[0]) for text in texts):
        return [text.removeprefix(target[0]) for text in texts]
    return texts


def _code(text: str) -> str:
    shown = text.strip().replace("\n", " ⏎ ")
    return f"`{' '.join(shown.split())}`"


def _note(example: TextExample) -> str:
    kinds = [kind.partition(":")[2] or kind for kind in example.kinds.values()]
    seen = f"where the value is of type {kinds[0]}" if kinds and example.after else ""
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
