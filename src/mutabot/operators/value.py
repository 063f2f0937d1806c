"""The base of operators that change values that a call writes or reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from mutabot.model import Call, Kind, Middleware, Proceed, Quantity, Reply, Unchanged

from .operator import Context, Operator, Subject

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

    from .magnitudes import Magnitudes

CallOrReply = TypeVar("CallOrReply", Call, Reply)
_SAME = "the value would stay the same"


class ValueOperator(Operator):
    """The base class of operators that change the value of a quantity of a call.

    One that changes several values of a call has ``subjects`` and ``changes`` of its own, and no ``change``.
    Raises TypeError, when it is made, for one that has neither.

    Class attributes:
        kinds: the kinds of quantities on which it acts, unless ``fits`` says otherwise.
        of_written, of_read: on which sides it acts.
        variants: a mutant each, with what they mean (``context.option``).
        directions: which ways a fault with magnitudes goes: a ladder each.
        takes_any: whether any other value is put in the place of one, also one that the vocabulary does not
            allow.
    """

    kinds: ClassVar[frozenset[Kind]] = frozenset()
    of_written: ClassVar[bool] = True
    of_read: ClassVar[bool] = True
    variants: ClassVar[Mapping[str, Any]] = {"": None}
    directions: ClassVar[tuple[str, ...]] = ("",)
    takes_any: ClassVar[bool] = False

    def __init__(self) -> None:
        if type(self).change is ValueOperator.change and type(self).changes is ValueOperator.changes:
            raise TypeError(f"operator {self.name!r} defines neither change nor changes")

    def change(self, value: Value, context: Context) -> Value | None:
        """Return the new value, or None if not applicable. Raises Unchanged to leave the value alone."""
        raise NotImplementedError

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        """Return whether the operator can act on this quantity of a call."""
        return quantity.kind in self.kinds

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        """Return the variants for a quantity."""
        return self.variants

    def magnitudes(self, quantity: Quantity) -> Magnitudes | None:
        """Return the magnitudes of the fault, one for each mutant; None for a fault without sizes."""
        return None

    def directions_of(self, quantity: Quantity) -> Iterable[str]:
        """Return the directions for a quantity."""
        return self.directions

    def subjects(self, whole: Subject) -> Iterable[Subject]:
        for is_on, side in ((self.of_written, whole.written), (self.of_read, whole.read)):
            for quantity in side if is_on else ():
                if self.fits(quantity, whole):
                    yield from self._subjects_of(quantity, replace(whole, quantity=quantity))

    def _subjects_of(self, quantity: Quantity, subject: Subject) -> Iterator[Subject]:
        ladder = self.magnitudes(quantity)
        if ladder is None:
            yield from (replace(subject, variant=variant) for variant in self.variants_of(quantity))
        else:
            for direction in self.directions_of(quantity):
                yield from ladder.of(subject, direction)

    async def changes(self, values: Mapping[str, Value], context: Context) -> Mapping[str, Value]:
        """Return the values that change, by quantity. Raises Unchanged to leave the call alone.

        ``values`` are those of the side on which the subject's quantity stands. What it may await is
        ``context.call.current``.
        """
        name = context.quantity.name
        value = context.subject.given(values, name)
        context.number += 1
        return {name: self.change(value, context)}

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        context = Context(subject, random, self.variants.get(subject.variant))
        known = {quantity.name: quantity for quantity in subject.side}

        async def written(call: Call, proceed: Proceed) -> Reply:
            return await proceed(await self._changed(call, call, context, known))

        async def read(call: Call, proceed: Proceed) -> Reply:
            return await self._changed(await proceed(call), call, context, known)

        return written if subject.is_written else read

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = subject.required_quantity
        if subject.is_written:
            return f"{quantity.label} {' → '.join(quantity.texts(before, after))}"
        return f"reads {quantity.label} {' instead of '.join(quantity.texts(after, before))}"

    def _why_unchanged(self, quantity: Quantity, before: Value, after: Value | None) -> str:
        """Return why a new value is not put in place of another one; empty if it can be."""
        if self.takes_any:
            return _SAME if quantity.is_same(after, before) else ""
        if after is None:
            return "a value of this type cannot be changed"
        if not _allowed(quantity, after):
            if quantity.range is None:
                return "the vocabulary does not allow the new value"
            return "the value would leave the range [{:g}, {:g}]".format(*quantity.range)
        if quantity.is_same(before, after):
            return _SAME
        if quantity.clip is not None and quantity.is_same(quantity.clipped(before), quantity.clipped(after)):
            return "both values are limited to the same one by clip = [{:g}, {:g}]".format(*quantity.clip)
        return ""

    async def _changed(
        self, call_or_reply: CallOrReply, call: Call, context: Context, known: Mapping[str, Quantity]
    ) -> CallOrReply:
        """Return the call or reply with the new values; ``known`` are its quantities."""
        context.call = call  # others may have been made while this one waited for its reply
        try:
            changed = await self.changes(call_or_reply.values, context)
        except Unchanged as why:
            return call_or_reply.as_is(str(why))
        finally:
            context.let_go(call)
        reasons = [
            self._why_unchanged(known[name], call_or_reply.values[name], changed[name]) for name in changed
        ]
        serious = [reason for reason in reasons if reason and reason != _SAME]
        if serious or all(reasons):
            return call_or_reply.as_is((serious or [_SAME])[0])
        return replace(call_or_reply, values={**call_or_reply.values, **changed})


def _allowed(quantity: Quantity, value: Value) -> bool:
    """Return whether the robot API takes the value, or each component of a vector."""
    if hasattr(value, "__len__") and not isinstance(value, str | bytes):
        return all(quantity.allows(item) for item in value)
    return quantity.allows(value)
