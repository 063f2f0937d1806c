"""Write docs/operators.md and docs/middleware.md from the operators' own examples, and docs/configuration.md
from the settings.

Use: ``python tools/make_docs.py``; with ``--check`` nothing is written, and the exit code is 1 if a page is
out of date.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import configuration_page
from mutabot.families import CATALOGUE, GRADED, MIDDLEWARE
from mutabot.model import Mishap, Quantity
from mutabot.model.notation import Notation
from mutabot.operators import Example, Need, Operator, Subject, operator
from mutabot.operators.registry import built_in

DOCS = Path(__file__).parents[1] / "docs"

HEAD = """\
# Which faults does mutabot plant?

<!-- Written by tools/make_docs.py from the operators' own examples, which are tests as well. Do not edit. -->

An *operator* is a rule that plants one small fault in what the program tells the robot or hears from it.
It sees what the [vocabulary](vocabulary.md) describes: operations and quantities, never program text.
A changed value stays one that the robot takes: where it would leave the range or the values that the
vocabulary gives, the operator stays away. What befalls messages on their way has a page of its own:
[middleware](middleware.md). `mutabot operators` lists all of them.
"""

CATALOGUE_HEAD = """\
## The catalogue

`--family catalogue` plants what robot programs get wrong beside the published faults: units and frames, order
and time, readings, actuation. Each operator names the class of bugs that it stands for.
`mutabot check --family catalogue` names those that your vocabulary and program give nothing to act on, with
the reason.

A waypoint that is skipped is [skip](#skip), a wrong sign of one number is [reverse](#reverse) or
[negate](#negate), and a header's wrong stamp is [shift-stamp](middleware.md#shift-stamp). A blend radius that
is lost has no operator: no kind of quantity says that a number is one.
"""
GRADED_HEAD = """\
## Graded faults

`--family graded` plants the same fault at rising magnitudes, to find from which on the tests notice it: see
[thresholds](thresholds.md), which also says where their ladders come from.
"""
#: what the groups of the catalogue are called, by the first operator of each
GROUPS = {
    "cm-for-m": "Units",
    "axis-swap": "Frames, axes, joints and tools",
    "euler-order": "Orientations as a whole",
    "swap-next": "Order and time",
    "dropout": "Readings",
    "speed-override": "Actuation",
}

TAIL = """\
## Your own operators

An operator is a class with a name, a summary, examples and three methods. The contract is
`src/mutabot/operators/operator.py`, the shortest ones stand in `src/mutabot/operators/kinds/commands.py`.
In mutabot itself it is in any file of `src/mutabot/operators/kinds`, an old file or a new one; it is found
there, and nothing else has to be edited. Its docstring is its documentation: what it does, and in a paragraph
that begins with `Where:`, what it acts on. What it needs is a set, such as
`needs = frozenset({Need.IDLE})`; where a need is not met, its mutants are left out, with the reason:

| need | what it gets |
|---|---|
| `Need.PLACE` | `call.current` tells where the robot is; used only where the vocabulary says |
| `Need.SIGN` | a value below zero among those that were recorded, so that there is another direction |
| `Need.IDLE` | `call.idle` is what to answer while the robot does nothing; used only where known |
| `Need.CLOCK` | `call.time()` tells the time; used only where the vocabulary has a clock |
| `Need.WAIT` | `await call.wait(seconds)` lets time pass; used only where the vocabulary says how |
| `Need.ERROR` | calls that raise: left out where none did in the baseline |
| `Need.PROGRAM` | calls of the program: readings by the tests' own checks are no place for it |
| `Need.MEMORY` | one middleware for all calls of a test |
| `Need.COPIES` | beside it, copies of what they write and read, which the program cannot change |

| attribute or method | what it says |
|---|---|
| `needs_of(subject)` | what it needs at one subject, where that differs |
| `does_nothing = True` | no call reaches the robot: one that would is an error, never a verdict |
| `family = "…"` | a family of its own: its mutants are planted where `--family` or `families` names it |

Most operators have one of two shapes. A `ValueOperator` (`operators/value.py`) changes one value,
`change(value, context)`; its `magnitudes(quantity)` say how big the fault is to be, a mutant each. A
`CommandOperator` (`operators/command.py`) does something with the call as a whole.

Say in any installed package that it brings the class, and every campaign of its family uses it:

```python
from mutabot.extensions import Extension

EXTENSION = Extension(interface=1, operators={"creep": "mutabot_creep.creep:Creep"})
```

```toml
[project.entry-points.mutabot]
creep = "mutabot_creep:EXTENSION"
```

The whole package stands in `tests/plugins/package`.
"""


def page() -> str:
    """The text of the page."""
    operators = _operators(of_middleware=False)
    graded = [each for each in operators if each.family == GRADED]
    first = [each for each in operators if each.family not in (CATALOGUE, GRADED)]
    groups: dict[str, list[Operator]] = {}
    title = ""
    for each in (each for each in operators if each.family == CATALOGUE):
        title = GROUPS.get(each.name, title)
        groups.setdefault(title, []).append(each)
    lines = [HEAD, *_overview(first), *_published(operators)]
    for each in first:
        lines += _section(each)
    lines += [GRADED_HEAD, *_overview(graded)]
    for each in graded:
        lines += _section(each)
    lines.append(CATALOGUE_HEAD)
    for title, members in groups.items():
        lines += [f"**{title}**\n", *_overview(members)]
    for each in (each for members in groups.values() for each in members):
        lines += _section(each)
    return "\n".join([*lines, TAIL])


def page_of_middleware() -> str:
    """The text of the page on the family ``middleware``."""
    operators = _operators(of_middleware=True)
    text = (Path(__file__).parent / "middleware_page.md").read_text(encoding="utf-8")
    lines = [text.replace("{overview}\n", "\n".join(_overview(operators)))]
    for each in operators:
        lines += _section(each)
    return "\n".join(lines).rstrip() + "\n"


def _operators(*, of_middleware: bool) -> list[Operator]:
    found = (operator(name) for name in built_in())
    return [one for one in found if (one.family == MIDDLEWARE) is of_middleware]


def _overview(operators: list[Operator]) -> Iterator[str]:
    yield from _table("operator", "the fault")
    yield from (_row(f"[{each.name}](#{each.name})", each.summary) for each in operators)
    yield ""


def _published(operators: list[Operator]) -> Iterator[str]:
    yield "The published operators, and what makes them here:\n"
    yield from _table("original", "mutant", "operator")
    rows = {}
    for each in operators:
        for number, original, mutant in re.findall(r"(\d+)\. (.*?) → (.*?)(?:; |$)", each.published):
            rows[int(number)] = (original, mutant, f"[{each.name}](#{each.name})")
    yield from (_row(*rows[number]) for number in sorted(rows))
    yield ""


def _section(each: Operator) -> Iterator[str]:
    yield f"## {each.name}\n"
    yield f"{each.summary}\n"
    if each.stands_for:
        yield f"It stands for: {each.stands_for}\n"
        yield f"Where: {each.where}.\n"
    acting = [example for example in each.examples if not example.away]
    noted = any(example.note for example in acting)
    yield from _table("original", "mutant", *(["note"] if noted else []))
    for example in acting:
        yield _row(_before(example), _after(example), *([example.note] if noted else []))
    yield ""
    yield from _promises(each)
    staying = [example for example in each.examples if example.away]
    if staying:
        yield "It stays away where it would change nothing, or nothing the robot takes:\n"
        yield from (f"- {_before(example)}: {example.away}" for example in staying)
        yield ""


def _promises(each: Operator) -> Iterator[str]:
    if Need.IDLE in each.needs:
        yield (
            "The program gets what the command answered in the unmutated run of the same test; where\n"
            "answers changed from call to call, the robot's last one, since the world stands still: see\n"
            "[answers to doing nothing](vocabulary.md#answers-to-doing-nothing).\n"
        )


def _before(example: Example) -> str:
    subject = example.subject
    text = _call(subject, example.values)
    if subject.read:
        text = f"{text} reads {_reading(subject, example.replied)}"
    if example.current:
        others = example.current.keys() - {one.name for one in subject.written}
        told = [f"{name} = {value:g}" for name, value in example.current.items() if name in others]
        text = (
            f"{text}, from {', '.join([*filter(None, [_values(subject.written, example.current)]), *told])}"
        )
    if example.previous is not None:
        text = f"{text}, after `{_values(subject.written, example.previous)}`"
    if example.refused:
        text = f"{text}, which the robot refuses"
    if example.earlier:
        before = (_values((*subject.written, *subject.read), values) for values in example.earlier)
        text = f"{text}, after {', '.join(f'`{one}`' for one in before)}"
    return text


def _after(example: Example) -> str:
    subject = example.subject
    late = f", {example.late:g} s later" if example.late else ""
    if example.fails:
        return f"raises `{example.fails}`"
    if example.refused:
        return "an answer, as if nothing were wrong"
    if example.waited:
        reads = (
            f"reads {_reading(subject, example.replied)}" if subject.read else _call(subject, example.values)
        )
        return f"{reads}, {example.waited:g} s later"
    if example.afterwards:
        now = ", then ".join(_call(subject, values) for values in example.performed) or "nothing"
        then = ", then ".join(_call(subject, values) for values in example.afterwards)
        return f"{now}, and {then} after the next command"
    if example.lost and not example.then:
        return "no answer" if not subject.read else "nothing comes"
    if example.received is not None or example.then or late:
        received = example.replied if example.received is None else example.received
        parts = [*([] if example.lost else [received]), *example.then]
        texts = [f"reads {_reading(subject, part)}" if subject.read else "one" for part in parts]
        return f"{', then '.join(texts)}{late}"
    return ", then ".join(_call(subject, values) for values in example.performed) or "nothing"


def _call(subject: Subject, values: Mapping[str, Any]) -> str:
    operation, pattern = subject.operation, subject.pattern
    opposite = bool(values.get("reversed"))
    mishaps = [_mishap(Mishap(name), much) for name, much in values.items() if name in {*Mishap}]
    values = {name: value for name, value in values.items() if name not in {"reversed", *Mishap}}
    if pattern is not None:
        text = Notation.compile((opposite and pattern.opposite) or pattern.text).write(values)
        return f'`{operation.name}("{text}")`'
    target = (opposite and operation.opposite) or operation.target
    name = target if operation.named is not None else target.partition(":")[2]
    given = _values(subject.written, values)
    if operation.named is not None:
        given = f": {given}" if given else ""
        return ", ".join([f"`{name}{given}`", *mishaps])
    return ", ".join([f"`{name}({given})`", *mishaps])


def _mishap(mishap: Mishap, seconds: float) -> str:
    return (
        f"{seconds:g} s later"
        if mishap is Mishap.LATE
        else f"{mishap} by {seconds:g} s"
        if seconds
        else mishap
    )


def _reading(subject: Subject, values: Mapping[str, Any]) -> str:
    present = {name: value for name, value in values.items() if value is not None}
    return f"`{_values(subject.read, present)}`" if present else "nothing"


def _values(quantities: tuple[Quantity, ...], values: Mapping[str, Any]) -> str:
    texts = []
    for quantity in quantities:
        if quantity.name in values:
            text = _value(quantity, values[quantity.name])
            texts.append(text if quantity.name == "result" else f"{quantity.name.lstrip('.')} = {text}")
    return ", ".join(texts)


def _value(quantity: Quantity, value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(f'{item:g}' for item in value)}] {quantity.unit or ''}".rstrip().replace(
            "-", "−"
        )
    if isinstance(value, str):
        return f'"{value}"'
    rounded = round(value, 3) if isinstance(value, float) else value
    return quantity.text(rounded).replace("-", "−")


def _table(*heads: str) -> Iterator[str]:
    yield _row(*heads)
    yield f"|{'---|' * len(heads)}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def main(arguments: list[str]) -> int:
    """Write the pages, or check them; returns the exit code."""
    pages = {
        "operators.md": page(),
        "middleware.md": page_of_middleware(),
        "configuration.md": configuration_page.page(),
    }
    if arguments == ["--check"]:
        paths = {DOCS / name: text for name, text in pages.items()}
        return int(any(not path.is_file() or path.read_text("utf-8") != text for path, text in paths.items()))
    for name, text in pages.items():
        (DOCS / name).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
