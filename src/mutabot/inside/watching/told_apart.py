"""Calls that are told apart by a node, register or name, and the values beside it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .described import Leaves

#: names of arguments that tell which command a call is
_NAMES = frozenset(
    "node node_id nodeid name address register tag channel signal topic variable".split()  # noqa: SIM905
)
_TALKS = re.compile(r"(?:^|_)(?:read|write|get|set|send|publish)(?:_|$)", re.IGNORECASE)
#: more commands than these, and longer texts, are no list of commands
_MOST, _LONGEST = 24, 60


@dataclass
class _Command:
    """What was seen of one command."""

    calls: int = 0
    given: dict[str, Leaves] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    result: Leaves = field(default_factory=Leaves)
    answered: int = 0


@dataclass
class ToldApart:
    """The commands of one callable.

    Attributes:
        by: path to what tells them apart, as vocabularies write it; empty if nothing does.
        commands: what was seen of each.
    """

    by: str = ""
    commands: dict[str, _Command] = field(default_factory=dict)
    _given_up: bool = False

    def see(self, instance: Any, target: str, values: Mapping[str, Any]) -> str | None:
        """One more call; the text of what tells which command it is."""
        if self._given_up:
            return None
        by, text = self._which(instance, target, values)
        if not by or (self.by and by != self.by) or len(text) > _LONGEST or len(self.commands) > _MOST:
            self._given_up, self.by = True, ""
            self.commands.clear()
            return None
        self.by = by
        command = self.commands.setdefault(text, _Command())
        command.calls += 1
        for name, value in values.items():
            if name != by:
                command.counts[name] = command.counts.get(name, 0) + 1
                command.given.setdefault(name, Leaves()).see(value, name)
        return text

    def answer(self, text: str | None, result: Any) -> None:
        """What such a call answered."""
        if text in self.commands:
            self.commands[text].answered += 1
            self.commands[text].result.see(result)

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "by": self.by,
            "commands": {
                text: {
                    "calls": command.calls,
                    "given": command.counts,
                    "arguments": {name: leaves.data() for name, leaves in command.given.items()},
                    "answered": command.answered,
                    "result": command.result.data(),
                }
                for text, command in self.commands.items()
            },
        }

    def _which(self, instance: Any, target: str, values: Mapping[str, Any]) -> tuple[str, str]:
        """Path and text of what tells this call's command; empty texts if nothing does."""
        if not _TALKS.search(re.split(r"[.:]", target)[-1]):
            return "", ""
        for name, value in values.items():
            is_plain = isinstance(value, str | int) and not isinstance(value, bool)
            if name.lower() in _NAMES and (is_plain or _prints_itself(value)):
                return name, str(value)
        return ("self", str(instance)) if _prints_itself(instance) else ("", "")


def _prints_itself(value: Any) -> bool:
    """Whether an object prints as a name of its own, as a node does by its id."""
    own: Any = type(value).__str__
    if value is None or own is object.__str__ or not hasattr(value, "__dict__"):
        return False
    text = str(value)
    return "\n" not in text and " object at " not in text
