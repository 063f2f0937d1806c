"""The disturbance of a simulated world, active in a test process."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from inspect import signature
from random import Random
from typing import Any, NamedTuple

from mutabot.api.faults import ActiveFault

from .change import NotInWorldError, NumberChange, Undo, change_at
from .patching import instances_of, mark_by, resolve, wrap

_NEVER = "the test made no world, its moment did not come, or nothing came that it disturbs"


class WorldFault(ActiveFault):
    """A fault that disturbs one parameter of the world by one magnitude.

    A function of ``apply`` is called with the world and the change, and by name with ``names``, ``random``
    and the parameter's options. It raises LookupError if the world has nothing of these names. What it
    returns, if anything, takes the disturbance away. One with an argument ``acts`` calls that itself.
    """

    def start_test(self, test: str, random: Random) -> None:
        """Arrange to disturb the test's worlds when they are made, or at the disturbance's moment."""
        self._key, self._undo, self._missing = random.random(), list[Undo](), ""
        self._disturbed: dict[int, _Disturbed] = {}
        self._reports_itself = False
        self._earlier, self._has_made = list[Any](), False
        mark_by(self.raising)
        if test != self.mutant.site.span.file:
            return
        moment = self.data["moment"]
        match moment["kind"]:
            case "made":
                # those that are there may be of the test, or left of others: that is known at its end
                with suppress(LookupError):
                    found = instances_of(self.data["of"])
                    self._earlier = [
                        earlier_fault
                        for earlier_fault in found
                        if self._disturb(earlier_fault, is_reported=False)
                    ]
                for reference in self.data["of"]:
                    self._wrap(reference, after=lambda _, world: self._world_made(world))
            case "making":
                for reference in self.data["of"]:
                    self._wrap(reference, before=partial(self._change_arguments, reference))
            case "call":
                self._calls_left = int(moment["number"])
                self._wrap(moment["call"], before=self._count)
            case "while":
                holds = resolve(moment["condition"])[2]
                self._wrap(moment["call"], before=lambda *_, **__: self._update_while(holds))

    def reach(self, key: tuple[Any, ...]) -> None:
        """Disturb all worlds: the simulated time of the disturbance has come."""
        if self.context.test == self.mutant.site.span.file:
            self._disturb_all()

    def end_test(self) -> None:
        """Undo the disturbance and remove all wrappers, the last first."""
        if self._earlier and not self._has_made and not self._reports_itself:
            self.acts()
        self._earlier.clear()
        for world in [*self._disturbed]:
            self._restore(world)
        while self._undo:
            self._undo.pop()()
        if self.context.test == self.mutant.site.span.file and not self.activity.acted:
            self.reached()
            self.activity.away[self._missing or _NEVER] = 1

    def _wrap(self, reference: str, **what: Any) -> None:
        try:
            self._undo.append(wrap(reference, **what))
        except LookupError as error:
            self._missing = str(error)

    def _disturb_all(self) -> None:
        with suppress(LookupError):  # what makes worlds is not there: the one who waits for it says so
            for world in instances_of(self.data["of"]):
                self._disturb(world)

    def _count(self, *_: object, **__: object) -> None:
        self._calls_left -= 1
        if not self._calls_left:
            self._disturb_all()

    def _update_while(self, holds: Any) -> None:
        """Disturb each world while the condition holds, and undo that when it no longer does."""
        with suppress(LookupError):
            for world in instances_of(self.data["of"]):
                if holds(world):
                    self._disturb(world)
                elif id(world) in self._disturbed:
                    self._restore(id(world))

    def _change_arguments(self, reference: str, *arguments: Any, **named: Any) -> Any:
        """Change the arguments that a world is made with, which the function gets by name."""
        found = resolve(reference)[2]
        makes: Any = vars(found)["__init__"] if isinstance(found, type) else found
        bound = signature(makes).bind(*arguments, **named)
        bound.apply_defaults()
        if self._disturb(bound.arguments):
            return bound.args, bound.kwargs
        return None

    def _world_made(self, world: Any) -> None:
        """Disturb a world that the test has made; forget earlier worlds, which belong to other tests."""
        self._earlier.clear()
        self._has_made = True
        self._disturbed.pop(id(world), None)  # of one that was there before, in the same place in memory
        self._disturb(world)

    def _disturb(self, world: Any, *, is_reported: bool = True) -> bool:
        """Disturb a world once; return whether it is disturbed now."""
        known = self._disturbed.get(id(world))
        if known is not None and known.world() is world:
            return True
        change = NumberChange(self.data["change"], self.data["amount"])
        try:
            before, after, undo = self._changed(world, change)
        except LookupError as error:
            if not self._disturbed:
                self._missing = str(error.args[0]) if error.args else str(error)
            return False
        self._missing = ""
        # whether it is taken away again matters within the test alone: no other test has this fault
        is_taken_away = self.data["moment"]["kind"] == "while"
        self._disturbed[id(world)] = _Disturbed(_reference(world), undo if is_taken_away else None)
        if is_reported and not self._reports_itself:
            self.acts(_as_float(before), _as_float(after))
        return True

    def _changed(self, world: Any, change: NumberChange) -> tuple[Any, Any, Undo | None]:
        """Change the world; return the number before and after, if it is one, and how to undo it."""
        if self.data["path"]:
            return change_at(world, self.data["path"], change)
        function = resolve(self.data["apply"])[2]
        random = Random(f"{self._key}:{len(self._disturbed)}")
        self._reports_itself = "acts" in signature(function).parameters
        more = {**self.data["options"], **({"acts": self.acts} if self._reports_itself else {})}
        result = function(world, change, names=self.data["names"], random=random, **more)
        if change.effects == {False}:
            raise NotInWorldError(f"what {self.data['apply']} changes is the same with the change")
        return None, None, result if callable(result) else None

    def _restore(self, world: int) -> None:
        undo = self._disturbed.pop(world).undo
        if undo is not None:
            undo()


class _Disturbed(NamedTuple):
    """A disturbed world, weakly referenced so that it is not kept alive, and how to undo the disturbance."""

    world: Callable[[], Any]
    undo: Undo | None


def _reference(world: Any) -> Callable[[], Any]:
    try:
        return weakref.ref(world)
    except TypeError:  # objects of C code mostly allow none
        return lambda: world


def _as_float(value: Any) -> Any:
    """Return a number as a float, for reports; None for any other value."""
    return float(value) if isinstance(value, int | float) or getattr(value, "shape", None) == () else None
