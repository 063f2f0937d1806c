"""What every operator declares, whatever it acts on.

An operator is one class, and nothing else has to be edited: the registries find it. A file holds those of one
kind of fault.

- One that acts on **calls** is a subclass of ``Operator`` (``operator.py``) in a file of a folder below this
  file's, with its name as text: workers load only files in whose text the name is that they look for.
- What acts on anything else belongs to a provider of its own (``mutabot/faults.py``), which says where its
  operators are and what else they have to declare.

What several share has a name that begins with ``_``, be it a class or a file. A third party names its class
in its ``mutabot.extensions.Extension``; that goes for operators on calls.

Engines, plan, reports and documentation know no operator by name: whatever they need to know of one stands
here or in the contract of its provider.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterable
from typing import Any, ClassVar, NamedTuple, TypeVar

#: how often each class of bugs was counted in public studies, by which operators say what they stand for
_STUDIES = "of the bugs on commands and readings in studies of ROS and PX4/ArduPilot software"
TIMING = f"timing and order are 28 {_STUDIES}"
SENSORS = f"sensor dropouts and misreadings are 20 {_STUDIES}"
PARAMETERS = f"parameters are 14 {_STUDIES}"
COMMANDS = f"missing and duplicated commands are 13 {_STUDIES}"
FRAMES = f"frames are 9 {_STUDIES}"
SIGNS = f"signs are 4 {_STUDIES}"
UNITS = f"units are 2 {_STUDIES}"


class Published(NamedTuple):
    """A row of the table of published operators that an operator makes.

    Attributes:
        row: 1-based place in that table.
        original, mutant: the row's two columns, in words.
    """

    row: int
    original: str
    mutant: str


class Rule(ABC):
    """What operators of all kinds declare.

    Class attributes:
        name: how ids, reports and selections call it.
        family: the family of its mutants (``mutabot.families``), or one of its own for a plug-in.
        summary: one sentence for the documentation.
        examples: worked examples; they are tests and documentation at once.
        rank: its place in the documentation and in the numbering of mutants: smaller first, then by name.
            Without one it comes after those that have one.
        published: rows of the table of published operators that it makes; empty for all others.
        stands_for: the bug class that it stands for and the evidence of it, in one sentence; may be empty for
            those that are published.
        where: where it applies, in the words of vocabularies.
        has_sizes: whether it plants each fault in several magnitudes, of which a threshold is sought.
    """

    name: ClassVar[str]
    family: ClassVar[str]
    summary: ClassVar[str]
    examples: ClassVar[tuple[Any, ...]] = ()
    rank: ClassVar[int] = 1000
    published: ClassVar[tuple[Published, ...]] = ()
    stands_for: ClassVar[str] = ""
    where: ClassVar[str] = ""
    has_sizes: ClassVar[bool] = False


R = TypeVar("R", bound=Rule)


def in_order(rules: Iterable[R]) -> list[R]:
    """The operators in the order of the documentation."""
    return sorted(rules, key=lambda rule: (rule.rank, rule.name))
