"""The tables ``guard`` and ``hardware`` of the configuration."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mutabot.api.processes import Table

_Patterns = Annotated[tuple[str, ...], Field(strict=False)]
_Range = Annotated[tuple[float, float], Field(strict=False)]
#: what may run unasked: nothing, what was not begun before, or all
Unasked = Literal["ask", "yes", "repeat"]
Surprise = Literal["guard", "heartbeat", "time", "process"]


class LimitTable(Table):
    """Least and greatest value of written quantities. A command beyond them is kept from the robot."""

    operations: _Patterns = ("*",)
    """Targets of operations, with `*` for any text."""
    quantity: str = "*"
    """Name of the quantity, or a pattern: `j*`."""
    kind: str | None = None
    """Its kind, such as `speed` or `force`; unless given, any."""
    axis: str | None = None
    """Its axis, such as `x` or `j1`; unless given, any."""
    min: float | None = None
    """The least value."""
    max: float | None = None
    """The greatest value."""
    margin: Annotated[float, Field(ge=0)] = 0.0
    """By how much a value is to keep away from both."""
    unit: str | None = None
    """Unit of these numbers; unless given, that of the quantity."""
    tool: str | None = None
    """The limit holds while the tool of this name is mounted, or none is known yet, see `tool`."""

    @model_validator(mode="after")
    def _has_an_end(self) -> Self:
        if self.min is None and self.max is None:
            raise ValueError("needs min, max or both")
        if self.min is not None and self.max is not None and self.min + 2 * self.margin > self.max:
            raise ValueError(
                f"leaves no value: min {self.min:g} and max {self.max:g}, margin {self.margin:g}"
            )
        return self


class BoxTable(Table):
    """A box in which targets have to lie, or which they have to avoid."""

    operations: _Patterns = ("*",)
    """Targets of operations, with `*` for any text."""
    keep: Literal["in", "out"] = "in"
    """`in` for a workspace, `out` for what stands in it. A target lies in the box if all its axes do."""
    x: _Range | None = None
    """Least and greatest x."""
    y: _Range | None = None
    """Least and greatest y."""
    z: _Range | None = None
    """Least and greatest z."""
    unit: str = "m"
    """Unit of these numbers."""
    margin: Annotated[float, Field(ge=0)] = 0.0
    """By how much a target is to keep away from the sides."""
    frame: str | None = None
    """Frame of the box: targets in another frame are not compared with it. Unless given, it holds for all."""
    tool: str | None = None
    """The box holds while the tool of this name is mounted, or none is known yet, see `tool`."""

    @model_validator(mode="after")
    def _has_sides(self) -> Self:
        if self.x is None and self.y is None and self.z is None:
            raise ValueError("needs x, y or z")
        for axis, side in self.sides.items():
            if side[0] > side[1]:
                raise ValueError(f"{axis} begins at {side[0]:g}, beyond its end {side[1]:g}")
        return self

    @property
    def sides(self) -> dict[str, tuple[float, float]]:
        """The sides that the box has, by axis."""
        found = (("x", self.x), ("y", self.y), ("z", self.z))
        return {axis: side for axis, side in found if side is not None}


class OrderTable(Table):
    """An order of commands: some are allowed only after others."""

    operations: _Patterns
    """The commands that are allowed only then."""
    after: _Patterns
    """The commands one of which has to come before, in the same test."""
    until: _Patterns = ()
    """The commands after which that has to be done once more."""


class GuardTable(Table):
    """Which commands must not reach the robot, see [hardware](hardware.md#guards)."""

    limit: Annotated[tuple[LimitTable, ...], Field(strict=False)] = ()
    """Limits of quantities.

        limit = [{ kind = "speed", max = 0.25, unit = "m/s" }]
    """
    box: Annotated[tuple[BoxTable, ...], Field(strict=False)] = ()
    """Workspaces, and what stands in them.

        box = [{ x = [0.2, 0.8], y = [-0.4, 0.4], z = [0.02, 0.9] }]
    """
    forbid: _Patterns = ()
    """Operations that are never called, with `*` for any text.

        forbid = ["robot:Arm.set_payload"]
    """
    order: Annotated[tuple[OrderTable, ...], Field(strict=False)] = ()
    """Commands that are allowed only after others.

        order = [{ operations = ["robot:drill"], after = ["robot:clamp"], until = ["robot:release"] }]
    """
    tool: str | None = None
    """Which quantity of which operation says which tool is mounted from then on. In each test and process the
    rules of all tools hold until it has said so for the first time.

        tool = "robot:Arm.set_tool name"
    """

    @model_validator(mode="after")
    def _knows_tools(self) -> Self:
        tools = (*(table.tool for table in self.limit), *(table.tool for table in self.box))
        named = next((tool for tool in tools if tool is not None), None)
        if self.tool is None and named is not None:
            raise ValueError(f"a rule holds for the tool {named!r}, but tool does not say what mounts it")
        return self

    @property
    def is_empty(self) -> bool:
        """Whether the guard blocks nothing."""
        return not (self.limit or self.box or self.forbid or self.order)


class HardwareTable(Table):
    """For campaigns on [hardware](hardware.md). With this table nothing runs without a `guard`."""

    enabled: bool = True
    """Whether the tests move hardware; `-o hardware.enabled=false` for the same project in simulation.

        enabled = false
    """
    safe_state: str | None = None
    """Needed: the function that brings the hardware into a safe state, called before and after each run.

        safe_state = "cell_io:retreat"
    """
    heartbeat: str | None = None
    """Needed: the function that returns within a second while the hardware is well, and raises if it is not.

        heartbeat = "cell_io:is_alive"
    """
    period: Annotated[float, Field(gt=0, le=10)] = 0.5
    """Seconds between two heartbeats.

        period = 0.2
    """
    rounds: Annotated[int, Field(ge=1)] = 1
    """Rounds of a campaign: each is one more motion of every mutant.

        rounds = 3
    """
    slower: Annotated[float, Field(ge=1)] = 2.0
    """A test that takes longer than this many times that of the original, and a second, is a surprise.

        slower = 1.5
    """
    stop: Annotated[tuple[Surprise, ...], Field(strict=False)] = ("guard", "heartbeat", "time", "process")
    """Surprises that stop the campaign: a guard keeps a command back, a heartbeat is missing, a test takes
    too long, a process is gone. A missing heartbeat stops it in any case.

        stop = ["heartbeat", "process"]
    """
    rehearsal: str | None = None
    """The journal of a campaign on a simulation of the same program: mutants run in the order of what they
    did there, the most harmless first.

        rehearsal = "simulated/.mutabot/journal.sqlite"
    """
