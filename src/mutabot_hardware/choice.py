"""The option ``--hardware ask|yes|repeat``, which a project with the table ``hardware`` requires."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Self, cast, get_args

from mutabot.api.processes import ExecutorChoice, Request, Table
from mutabot.api.reports import UsageError

from .guard import idle_part
from .tables import GuardTable, HardwareTable, Unasked

if TYPE_CHECKING:
    from .executor import HardwareExecutor


@dataclass(frozen=True, slots=True)
class HardwareChoice(ExecutorChoice):
    """The hardware chosen as executor.

    Attributes:
        table: the table of the configuration.
        unasked: what may run unasked: nothing (``ask``), what was not begun before (``yes``), or all.
    """

    table: HardwareTable
    unasked: Unasked = "ask"

    @classmethod
    def parse(cls, value: str, root: Path, table: Table | None) -> Self:
        """Parse the option; see ``ExecutorChoice``."""
        if not isinstance(table, HardwareTable) or not table.enabled:
            raise UsageError("--hardware: the configuration has no table hardware that is enabled")
        if value not in get_args(Unasked):
            raise UsageError(f"--hardware {value}: {', '.join(get_args(Unasked))}")
        return cls(table, cast("Unasked", value))

    @classmethod
    def implied(cls, table: Table) -> Self | None:
        """Return the choice implied by the table, without which nothing runs; see ``ExecutorChoice``."""
        return cls(table) if isinstance(table, HardwareTable) and table.enabled else None

    def fitted(self, request: Request) -> Request:
        """Return the request for one fresh process at a time, without repeats; see ``ExecutorChoice``."""
        for name in ("safe_state", "heartbeat"):
            if getattr(self.table, name) is None:
                raise UsageError(f'hardware: nothing runs without {name}, such as {name} = "cell_io:{name}"')
        guard = request.configuration.tables.get("guard")
        if not isinstance(guard, GuardTable) or guard.is_empty:
            raise UsageError(
                "hardware: nothing runs without a guard; write a table guard with limits, boxes, forbidden "
                "operations or orders"
            )
        if why := idle_part(guard, request.vocabulary.operations):
            raise UsageError(f"{why}; a rule that keeps nothing back protects nothing")
        if request.engine == "fork":
            raise UsageError("hardware: copies of a program cannot share a robot; leave out --engine fork")
        return replace(
            request, engine="replay", jobs=1, repeats=False, rounds=self.table.rounds, verify=0
        )  # fmt: skip

    def open(
        self, request: Request, notify: Callable[[str], None]
    ) -> AbstractContextManager[HardwareExecutor]:
        """Open the hardware's executor; see ``ExecutorChoice``. Raises UsageError."""
        from .executor import HardwareExecutor  # noqa: PLC0415  # it starts processes

        return HardwareExecutor.opened(request, self.table, self.unasked, notify)
