"""Operators on headers of messages, and on the settings of publishers, timers and parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from mutabot.api.faults import Context, Example, Subject, Unchanged, ValueOperator
from mutabot.api.values import Form, Kind, Operation, Quantity

from . import _examples as calls
from .values import MIDDLEWARE

_EMPTY, _UNKNOWN = "empty", "unknown"
_SEND = Operation.under_name(Form.PUBLISH, "/arm/target", (calls.FRAME,))
_SEND_ANY = Operation.under_name(Form.PUBLISH, "/arm/target", (calls.OPEN_FRAME,))
_HEAR = Operation.under_name(Form.RECEIVE, "/scan", result=(calls.HEARD_FRAME,))


class _FreeValueOperator(ValueOperator):
    """Changes a value that a middleware accepts whatever it is."""

    family = MIDDLEWARE
    takes_any = True

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        quantity = subject.required_quantity
        old, new = quantity.texts(before, after)
        return f"{quantity.name} {old or '“”'} → {new or '“”'}"


class WrongFrame(_FreeValueOperator):
    """The header names another frame: the next of the vocabulary's values, else an unknown one; or none at
    all.
    """

    name = "wrong-frame"
    kinds = frozenset({Kind.FRAME_ID})
    examples = (
        Example.changed(_SEND, "base", "tool"),
        Example.changed(_SEND_ANY, "base", "base_unknown", _UNKNOWN),
        Example.changed(_HEAR, "base", "", _EMPTY),
        Example.unchanged(_SEND, "", "the value would stay the same", _EMPTY),
    )

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return ("" if quantity.values else _UNKNOWN, _EMPTY)

    def change(self, value: Any, context: Context) -> Any | None:
        if context.subject.variant == _EMPTY:
            return ""
        if context.subject.variant == _UNKNOWN:
            return f"{value}_unknown"
        frames = context.quantity.values or ()
        if value not in frames:
            raise Unchanged(f"frame {value!r} is not one of the vocabulary's: {', '.join(map(str, frames))}")
        return context.next_value(value)


class ShiftStamp(_FreeValueOperator):
    """The header's stamp lies 5 s in the past or in the future."""

    name = "shift-stamp"
    kinds = frozenset({Kind.STAMP})
    #: seconds: more than programs that check the age of a message put up with. Less than 2 s is no difference
    #: between two numbers of seconds since 1970, as values are compared
    variants: ClassVar[Mapping[str, float]] = {"-5": -5.0, "5": 5.0}
    examples = (
        Example.changed(calls.SEND_STAMP, 20.0, 15.0, "-5"),
        Example.changed(calls.HEAR_STAMP, 20.0, 25.0, "5"),
        Example.unchanged(calls.SEND_STAMP, 0.0, "the stamp is empty", "5"),
        Example.unchanged(calls.SEND_STAMP, 2.0, "no stamp is before zero", "-5"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not value:
            raise Unchanged("the stamp is empty")
        shifted = value + context.option
        if shifted < 0:
            raise Unchanged("no stamp is before zero")
        return shifted

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        when = "past" if subject.variant.startswith("-") else "future"
        return f"{subject.required_quantity.name} lies 5 s in the {when}"


class EmptyStamp(_FreeValueOperator):
    """The header's stamp is zero."""

    name = "empty-stamp"
    kinds = frozenset({Kind.STAMP})
    examples = (
        Example.changed(calls.SEND_STAMP, 20.0, 0.0),
        Example.changed(calls.HEAR_STAMP, 20.0, 0.0),
        Example.unchanged(calls.SEND_STAMP, 0.0, "the stamp is empty already"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not value:
            raise Unchanged("the stamp is empty already")
        return 0.0

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return f"{subject.required_quantity.name} is empty"


_MISSPELT, _GLOBAL = "misspelt", "global"
_TIGHT, _NONE = "tight", "none"
_NO_DEFAULT = "the program gives no default"
_IS_DEFAULT = "it has its default"


class _Setting(_FreeValueOperator):
    """Changes one thing that something is set up with.

    Class attributes:
        setting: its name.
    """

    setting: ClassVar[str]

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.SETTING and quantity.name == self.setting

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        if self.setting not in values:  # a middleware need not have all that others have
            raise Unchanged("its middleware has no such setting, or chooses it itself")
        return await super().changes(values, context)


class WrongName(_Setting):
    """A publisher, subscription or client is set up under a name of its own, which no other node has, or
    without the namespace of its node, as a wrong remapping does.
    """

    name = "wrong-name"
    setting = "name"
    variants: ClassVar[Mapping[str, None]] = {_MISSPELT: None, _GLOBAL: None}
    examples = (
        Example.changed(calls.SUBSCRIBE, "gap", "gap_misspelt", _MISSPELT, quantity="name"),
        Example.changed(calls.ADVERTISE, "target", "/target", _GLOBAL, quantity="name"),
        Example.unchanged(
            calls.CLIENT, "/arm/follow", "its name is global already", _GLOBAL, quantity="name"
        ),
        Example.unchanged(calls.SUBSCRIBE, "gap", "its node has no namespace", _GLOBAL, quantity="name"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if context.subject.variant == _MISSPELT:
            return f"{value}_misspelt"
        if str(value).startswith("/"):
            raise Unchanged("its name is global already")
        found = "/" + str(value).removeprefix("~").removeprefix("/")
        named = context.subject.operation.named
        if named is not None and named.name == found:
            raise Unchanged("its node has no namespace")
        return found


class ShortQueue(_Setting):
    """The queue of a publisher or subscription holds one message."""

    name = "short-queue"
    setting = "depth"
    examples = (
        Example.changed(
            calls.SUBSCRIBE, {"name": "gap", "depth": 10}, {"name": "gap", "depth": 1}, quantity="depth"
        ),
        Example.unchanged(
            calls.ADVERTISE, {"name": "target", "depth": 1}, "the value would stay the same", quantity="depth"
        ),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        return 1


class _OtherOfTwo(_Setting):
    """Sets the other of two values."""

    def change(self, value: Any, context: Context) -> Any | None:
        values = context.quantity.values or ()
        if value not in values:
            raise Unchanged(f"{value} is neither {' nor '.join(map(str, values))}")
        return values[1 - values.index(value)]


class FlipLatch(_OtherOfTwo):
    """A publisher that keeps its last message for later subscribers does not, or the other way round."""

    name = "flip-latch"
    setting = "latch"
    examples = (
        Example.changed(calls.ADVERTISE, True, False, quantity="latch"),
        Example.changed(calls.ADVERTISE, False, True, quantity="latch"),
        Example.unchanged(
            calls.ADVERTISE, {"name": "target"}, "its middleware has no latch", quantity="latch"
        ),
    )


def _of_two(
    quantity: str, first_value: str, second_value: str, first: Operation, second: Operation
) -> tuple[Example, ...]:
    """Return the examples of a policy that has two values besides the system's default."""
    return (
        Example.changed(first, first_value, second_value, quantity=quantity),
        Example.changed(second, second_value, first_value, quantity=quantity),
        Example.unchanged(
            calls.SUBSCRIBE,
            "system_default",
            f"system_default is neither {first_value} nor {second_value}",
            quantity=quantity,
        ),
    )


class WrongReliability(_OtherOfTwo):
    """A publisher or subscription is best effort instead of reliable, or the other way round."""

    name = "wrong-reliability"
    setting = "reliability"
    examples = _of_two("reliability", "reliable", "best_effort", calls.ADVERTISE, calls.SUBSCRIBE)


class WrongDurability(_OtherOfTwo):
    """A publisher or subscription is volatile instead of transient local, or the other way round."""

    name = "wrong-durability"
    setting = "durability"
    examples = _of_two("durability", "volatile", "transient_local", calls.SUBSCRIBE, calls.ADVERTISE)


class WrongDeadline(_Setting):
    """A publisher or subscription has a deadline of 1 ms, or none where it had one."""

    name = "wrong-deadline"
    setting = "deadline"
    #: seconds: more often than any of the programs this is for publishes
    variants: ClassVar[Mapping[str, float]] = {_TIGHT: 0.001, _NONE: 0.0}
    examples = (
        Example.changed(calls.SUBSCRIBE, 0.0, 0.001, _TIGHT, quantity="deadline"),
        Example.changed(calls.ADVERTISE, 0.1, 0.0, _NONE, quantity="deadline"),
        Example.unchanged(calls.ADVERTISE, 0.0, "it has no deadline", _NONE, quantity="deadline"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not value and context.subject.variant == _NONE:
            raise Unchanged("it has no deadline")
        return context.option


class WrongPeriod(_Setting):
    """A timer or rate has twice the period, or half of it."""

    name = "wrong-period"
    setting = "period"
    variants: ClassVar[Mapping[str, float]] = {"x2": 2.0, "x0.5": 0.5}
    examples = (
        Example.changed(calls.TIMER, 0.1, 0.2, "x2", quantity="period"),
        Example.changed(calls.RATE, 0.1, 0.05, "x0.5", quantity="period"),
        Example.unchanged(calls.TIMER, 0.0, "it has no period", "x2", quantity="period"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not context.quantity.is_scalar(value) or not value:
            raise Unchanged("it has no period")
        return value * context.option


#: the name of the default of a parameter, as the program or its declaration gives it
_DEFAULT = Form.PARAMETER.settings[0].name
_SET, _READ = Subject(calls.SPEED, quantity=calls.SPEED.result[0]), {"value": 0.25}


class UseDefault(_FreeValueOperator):
    """A parameter has the program's default instead of what was set."""

    name = "use-default"
    of_written = False
    examples = (
        Example(_SET, {"default": 1.0}, _READ, performed=({"default": 1.0},), received={"value": 1.0}),
        Example(_SET, {}, _READ, away=_NO_DEFAULT),
        Example(_SET, {"default": 0.25}, _READ, away=_IS_DEFAULT),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return whole.operation.form is Form.PARAMETER and not quantity.path.steps

    def change(self, value: Any, context: Context) -> Any | None:
        default = context.call.values[_DEFAULT]
        if context.quantity.is_same(default, value):
            raise Unchanged(_IS_DEFAULT)
        return default

    async def changes(self, values: Mapping[str, Any], context: Context) -> Mapping[str, Any]:
        if _DEFAULT not in context.call.values:
            raise Unchanged(_NO_DEFAULT)
        return await super().changes(values, context)

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        old, new = subject.required_quantity.texts(before, after)
        return f"the default {new} instead of {old}"
