"""Feature files: the scenarios in them, their steps, and where a step can be added."""

from __future__ import annotations

import re
from dataclasses import dataclass

_SCENARIO = re.compile(r"\s*(?:Scenario Outline|Scenario Template|Scenario|Example)\s*:\s*(.*?)\s*$")
_BACKGROUND = re.compile(r"\s*Background\s*:")
_OTHER = re.compile(r"\s*(?:Feature|Rule|Examples|Scenarios)\s*:|\s*@")
_STEP = re.compile(r"(\s*)(Given|When|Then|And|But|\*)\s+(.*?)\s*$")


@dataclass(slots=True)
class Scenario:
    """A scenario.

    Attributes:
        title: as the file has it; empty for a background.
        end: the 1-based line after which a further step comes.
        indent: of its steps.
        steps: keyword and text.
    """

    title: str
    end: int
    indent: str
    steps: list[tuple[str, str]]

    def keyword(self) -> str:
        """With which a further check begins."""
        real = [word for word, _ in self.steps if word not in {"And", "But", "*"}]
        return "And" if real and real[-1] == "Then" else "Then"


def scenarios_in(text: str) -> list[Scenario]:
    """The scenarios of a feature file, with backgrounds as those without a title."""
    found: list[Scenario] = []
    current: Scenario | None = None
    quoted = False
    for number, line in enumerate(text.splitlines(), start=1):
        is_quote = line.strip()[:3] in {'"""', "```"}
        if is_quote or quoted:
            quoted = quoted != is_quote
            if current is not None:
                current.end = number
            continue
        scenario, step = _SCENARIO.match(line), _STEP.match(line)
        if scenario is not None or _BACKGROUND.match(line):
            current = Scenario(scenario[1] if scenario else "", number, "    ", [])
            found.append(current)
        elif _OTHER.match(line):
            current = None
        elif current is not None and step is not None:
            current.indent, current.end = step[1], number
            current.steps.append((step[2], step[3]))
        elif current is not None and line.strip().startswith("|"):
            current.end = number
    return found
