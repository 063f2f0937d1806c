"""The operators on the terminal, for ``mutabot operators``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from .console import heading, plain, plural


def print_rules(console: Console, rules: Iterable[Mapping[str, str]]) -> None:
    """Print operators, family by family: what each does, where it applies, and what it stands for."""
    found = list(rules)
    for family, group in groupby(found, key=lambda rule: rule["family"]):
        console.print(heading(family))
        for rule in group:
            console.print(Text(rule["name"], style="bold"))
            for line in _lines(rule):
                console.print(Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 3), expand=False))
    console.print()
    console.print(plural(len(found), "operator"))


def _lines(rule: Mapping[str, str]) -> Iterable[str]:
    yield rule["summary"]
    if rule["where"]:
        yield f"where: {rule['where']}"
    if rule["source"]:
        yield f"source: {rule['source']}"
