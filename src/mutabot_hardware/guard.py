"""The guard that the table ``guard`` describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from mutabot.api.processes import CallGuard
from mutabot.api.values import Call, Operation

from .rules import BoxRule, LimitRule, OrderRule, RuleFinding, described, fits, is_among
from .tables import GuardTable
from .targets import UnreadableTarget


def rules_of(table: GuardTable) -> list[LimitRule | BoxRule]:
    """Return the limits and boxes of a table."""
    return [*(LimitRule(limit) for limit in table.limit), *(BoxRule(box) for box in table.box)]


def idle_part(table: GuardTable, operations: Iterable[Operation]) -> str | None:
    """Return which part of a table concerns no operation, so that it never blocks a command; None if none."""
    commands = [operation for operation in operations if operation.command]
    for rule in rules_of(table):
        if not any(rule.concerns(command) for command in commands):
            kind = "limit" if isinstance(rule, LimitRule) else "box"
            rule_values = rule.table.model_dump(exclude_defaults=True, exclude_none=True)
            which = ", ".join(f"{key} = {value}" for key, value in rule_values.items())
            return f"guard.{kind} concerns no quantity that the vocabulary describes: {which}"
    named = [*table.forbid, *(name for order in table.order for name in (*order.operations, *order.after))]
    lost = next((name for name in named if not any(is_among(command, [name]) for command in commands)), None)
    if lost is not None:
        return f"guard: the vocabulary describes no command {lost}"
    if table.tool is not None and not any(_sets_tool(command, table.tool) for command in commands):
        return (
            f"guard.tool: the vocabulary describes no command with a quantity as in {table.tool!r}; "
            "it needs the target of an operation, a space, and the name of a quantity"
        )
    return None


def _sets_tool(operation: Operation, tool: str) -> bool:
    """Return whether an operation has a quantity that says which tool is mounted."""
    target, *names = tool.split()
    return operation.target == target and any(quantity.name in names for quantity in described(operation))


class TableGuard(CallGuard):
    """Blocks the commands that the table does not allow.

    A command of which a rule cannot read what it needs is kept back as well; text commands that the
    vocabulary does not know concern no rule, see ``watch.HardwareGuard``.
    """

    def __init__(self, table: Mapping[str, Any]) -> None:
        super().__init__(table)
        read = GuardTable.model_validate(table)
        self._rules = rules_of(read)
        self._forbidden, self._tables = read.forbid, read.order
        self._tool_of = read.tool.split() if read.tool is not None else None
        self.start_test()

    def start_test(self) -> None:
        """Forget the commands of the test before; see ``CallGuard``."""
        self._orders = [OrderRule(table) for table in self._tables]
        self._tool: str | None = None

    def why_not(self, call: Call, unread: Mapping[str, str]) -> str | None:
        """Return why a command is blocked, or None; see ``CallGuard``."""
        if not call.is_command:
            return None
        why = self._why_not(call, unread)
        if why is None:
            for order in self._orders:
                order.note(call)
            self._note_tool(call)
        return why

    def _why_not(self, call: Call, unread: Mapping[str, str]) -> str | None:
        if fits(call, self._forbidden):
            return "is forbidden"
        for order in self._orders:
            if why := order.why_not(call):
                return why
        if unread and self._concerns(call):
            return "; ".join(unread.values())
        try:
            return next((finding.text for finding in self.findings(call) if not finding.is_within), None)
        except UnreadableTarget as error:
            return str(error)

    def _concerns(self, call: Call) -> bool:
        return any(fits(call, rule.table.operations) for rule in self._rules)

    def findings(self, call: Call) -> Iterator[RuleFinding]:
        """Yield what the limits and boxes find for a call. Raises UnreadableTarget."""
        for rule in self._rules:
            yield from rule.of(call, self._tool)

    def _note_tool(self, call: Call) -> None:
        if self._tool_of is None or call.operation.target != self._tool_of[0]:
            return
        self._tool = next((str(call.values[name]) for name in self._tool_of[1:] if name in call.values), None)
