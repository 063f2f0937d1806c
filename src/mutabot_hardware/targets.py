"""The target of a command: the commanded value, or the robot's position plus a relative move."""

from __future__ import annotations

from typing import Any

from mutabot.api.values import Call, Mode, Quantity


class UnreadableTarget(Exception):  # noqa: N818  # a reason
    """The target of a command is unknown, for the reason given."""


def target_of(call: Call, quantity: Quantity, value: Any) -> float:
    """Return the target of a commanded amount, in the quantity's unit. Raises UnreadableTarget."""
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise UnreadableTarget(f"{quantity.name} is {value!r}, not a number") from error
    return number + target_now(call, quantity) if quantity.mode is Mode.BY else number


def target_now(call: Call, quantity: Quantity) -> float:
    """Return the robot's current value of a quantity. Raises UnreadableTarget."""
    lacking = f"where {quantity.name} leads to is not known"
    try:
        asked = call.current(quantity)
        asked.send(None)  # type: ignore[attr-defined]  # of a plain reading it never suspends
    except StopIteration as end:
        return float(end.value)
    except Exception as error:
        raise UnreadableTarget(f"{lacking}: {error}") from error
    asked.close()  # type: ignore[attr-defined]
    raise UnreadableTarget(f"{lacking}: its reading has to be awaited")
