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
from mutabot.model import CallFault, Quantity
from mutabot.model.notation import Notation
from mutabot.operators import Example, Need, Operator, Subject, operator
from mutabot.operators.registry import built_in

DOCS = Path(__file__).parents[1] / "docs"

HEAD = """\
# Operators: the faults

<!-- Written by tools/make_docs.py from the operators' own examples, which are tests as well. Do not edit. -->

An *operator* makes one kind of small fault in what the program tells the robot or hears from it, on the
operations and quantities that the [vocabulary](vocabulary.md) describes. A call is left alone if the fault
would change nothing or would leave the allowed range or values; `mutabot list --all` gives the reason.
`mutabot operators` prints where each operator acts, and which bugs it stands for. Faults of messages on their
way: [middleware](middleware.md).

In the examples, `original` → `mutant`. *Idle* operators [answer the
program](vocabulary.md#answers-to-doing-nothing) in the place of the robot.

## Published operators

Family `robot`, the default, has all 13 published operators for robot programs: translate or rotate to the
other side (*reverse*), *to* instead of *by* (*by-to*), no command, twice, or the opposite (*skip*, *repeat*,
*opposite*), a wrong or noisy distance (*negate*, *noise*), a wrong colour (*misread*).
"""

CATALOGUE_HEAD = """\
## The catalogue

`--family catalogue` adds faults that are common in robot programs. Bugs on commands and readings of each
class in studies of ROS and PX4/ArduPilot software: {studies}. Not covered: a lost blend radius, since no kind
of quantity marks one.
"""
GRADED_HEAD = """\
## Graded faults

`--family graded` makes the same fault at rising magnitudes, to find the smallest that the tests notice:
[thresholds](thresholds.md).
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

An operator is a class with a name, a docstring (summary, `Where:`), examples and three methods; contract:
`src/mutabot/operators/operator.py`. Put it into a file of `src/mutabot/operators/kinds` (copy a short one of
`commands.py`) or into a [package](packages.md). Most are a `ValueOperator` (`operators/value.py`:
`change(value, context)` changes one value, `magnitudes(quantity)` gives the sizes, one mutant each) or a
`CommandOperator` (`operators/command.py`: acts on the whole call).

`needs` is a set of `Need`s (`operators.operator.Need` describes them), such as `frozenset({Need.IDLE})`;
`needs_of(subject)` gives needs that differ by subject. Where a need is not met, mutants are skipped with the
reason.

With `does_nothing = True` no call reaches the robot; one that does is an error, never a verdict.
`family = "…"` makes a family of its own.
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
    lines = [HEAD]
    for each in first:
        lines += _section(each)
    lines.append(GRADED_HEAD)
    for each in graded:
        lines += _section(each)
    lines.append(CATALOGUE_HEAD.replace("{studies}", _studies(operators)))
    for title, members in groups.items():
        lines.append(f"## {title}\n")
        for each in members:
            lines += _section(each)
    return "\n".join([*lines, TAIL])


def page_of_middleware() -> str:
    """The text of the page on the family ``middleware``."""
    operators = _operators(of_middleware=True)
    text = (Path(__file__).parent / "middleware_page.md").read_text(encoding="utf-8")
    lines = [text]
    for each in operators:
        lines += _section(each)
    return "\n".join(lines).rstrip() + "\n"


def _operators(*, of_middleware: bool) -> list[Operator]:
    found = (operator(name) for name in built_in())
    return [one for one in found if (one.family == MIDDLEWARE) is of_middleware]


#: what the sentence on a class of bugs ends with: how many of them studies found
_STUDIED = re.compile(r": ([^:]+?) are (\d+) of the bugs .*$")


def _studies(operators: list[Operator]) -> str:
    found = (_STUDIED.search(each.rationale) for each in operators)
    numbers = {one[1]: int(one[2]) for one in found if one}
    return ", ".join(f"{name} {number}" for name, number in sorted(numbers.items(), key=lambda one: -one[1]))


def _section(each: Operator) -> Iterator[str]:
    yield f"### {each.name}\n"
    yield f"{each.summary}{' *(idle)*' if Need.IDLE in each.needs else ''}\n"
    if each.rationale and "vocabulary" in each.where and "vocabulary" not in each.summary:
        yield f"Where: {each.where}.\n"
    told = [f"- {_before(one)} → {_after(one)} ({one.note})" for one in each.examples if _is_told(each, one)]
    yield from [*told, ""] if told else []


def _is_told(each: Operator, example: Example) -> bool:
    """Whether an example shows what neither the summary nor the published operator says."""
    is_published = example.note.replace(": ", " → ") in each.published
    return bool(example.note) and not example.away and not is_published


def _before(example: Example) -> str:
    subject = example.subject
    text = _call(subject, example.values)
    if subject.read:
        text = f"{text} reads {_reading(subject, example.replied)}"
    if example.current:
        others = example.current.keys() - {one.name for one in subject.written}
        told = [f"{name}={value:g}" for name, value in example.current.items() if name in others]
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
    call_faults = [_mishap(CallFault(name), much) for name, much in values.items() if name in {*CallFault}]
    values = {name: value for name, value in values.items() if name not in {"reversed", *CallFault}}
    if pattern is not None:
        text = Notation.compile((opposite and pattern.opposite) or pattern.text).write(values)
        return f'`{operation.name}("{text}")`'
    target = (opposite and operation.opposite) or operation.target
    name = target if operation.named is not None else target.partition(":")[2]
    given = _values(subject.written, values)
    if operation.named is not None:
        given = f": {given}" if given else ""
        return ", ".join([f"`{name}{given}`", *call_faults])
    return ", ".join([f"`{name}({given})`", *call_faults])


def _mishap(call_fault: CallFault, seconds: float) -> str:
    return (
        f"{seconds:g} s later"
        if call_fault is CallFault.LATE
        else f"{call_fault} by {seconds:g} s"
        if seconds
        else call_fault
    )


def _reading(subject: Subject, values: Mapping[str, Any]) -> str:
    present = {name: value for name, value in values.items() if value is not None}
    return f"`{_values(subject.read, present)}`" if present else "nothing"


def _values(quantities: tuple[Quantity, ...], values: Mapping[str, Any]) -> str:
    texts = []
    for quantity in quantities:
        if quantity.name in values:
            text = _value(quantity, values[quantity.name])
            texts.append(text if quantity.name == "result" else f"{quantity.name.lstrip('.')}={text}")
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
