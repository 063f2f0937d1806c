"""Switch alternatives of instrumented program text on and off, and note their values.

The text of a place ``E`` with number ``p`` becomes ``(other) if __mutabot__[p] and __mutabot__[p].chosen()
else E``. ``__mutabot__`` is a plain list with False at places that are off, so these cost one look-up. It is
a built-in name: modules keep the names they have.

In a baseline the text becomes ``__mutabot__[0](p) or __mutabot__[p](E)``: the first call notes that the place
is reached, whatever becomes of ``E``. A place is examined a few times per test, and no more once it has
reported all that the plan asks; from then on the function there passes the value through, as cheaply as a
call can.
"""

from __future__ import annotations

import enum
import numbers
import sys
import types
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from sys import _getframe
from threading import active_count, get_ident
from typing import Any, NoReturn

from mutabot.model.activation import FatalFault
from mutabot.model.data import is_of_numpy
from mutabot.model.path import class_name
from mutabot.model.program_text import FATAL, IDENTITY, Sighting, TextPlace, fits_kinds
from mutabot.runtime.activity import shown
from mutabot.runtime.program_text.prediction import Forms, UnpredictableError, is_identical, locals_of


@cache
def error_of(name: str) -> type[Exception]:
    """Return the exception class that an alternative raises, by the name in its operator."""
    # the module is the one under which journals know them
    return type(name, (Exception,), {"__module__": "mutabot.runtime.alternatives"})


class Switch:
    """A place that is switched on.

    Attributes:
        place: its number.
        index: the alternative that is active there; None if the place is only watched.
        watched: alternatives to report as soon as they would change something.
    """

    __slots__ = ("_before", "_owner", "index", "place", "watched")

    def __init__(self, owner: Alternatives, place: int, index: int | None, watched: frozenset[int]) -> None:
        self._owner, self.place, self.index, self.watched = owner, place, index, watched
        self._before: dict[int, Any] = {}  # by thread

    def chosen(self) -> bool:
        """Return whether an alternative replaces the original; called at every evaluation."""
        return self._owner.reached(self, _getframe(1))

    # what instrumented text calls around an alternative, so that one sees whether it changed anything

    def was(self, value: Any) -> Any:
        """Note the original's value, which the alternative uses."""
        self._before[get_ident()] = value
        return value

    def became(self, value: Any) -> Any:
        """Note the alternative's value, beside the original's if that is known without side effects."""
        before = self._before.pop(get_ident(), _UNKNOWN)
        if before is _UNKNOWN:
            before = self._owner.predicted(self.place, _getframe(1))
        self._owner.note(self.place, before, value, is_idle=is_identical(before, value))
        return value


class _Unknown:
    """The type of the marker of an unknown value, and of nothing else."""


_UNKNOWN = _Unknown()
#: evaluations of a place in one test after which it is no longer looked ahead: that takes its time
_LOOKS = 1000


class Alternatives:
    """All places of the program, and which of their alternatives is active.

    Attributes:
        active: the active alternative; None for the original.
        hits: evaluations of each place that was on, in the running test and before any.
        idle: evaluations of the active place at which the alternative had the value of the original; of a
            watched place, those at which all alternatives that are still watched had it.
        example: value of the original and of the alternative when they first differed; of what is no plain
            value, its type.
        on_place: called with the number of a watched place, and which of its watched alternatives are about
            to differ for the first time from the original, or may be; it may activate one of them, which then
            stands there at once.
        forms: gives a place as trees that can be looked ahead of; None for statements.
        on_idle: called when an evaluation of the active alternative has changed nothing; until its value is
            known, it counts as a change.
        on_first: called with the number of a place that is on when it is first evaluated since ``start``.
        on_act: called when the active alternative is known to change something, or may do so, for the first
            time since ``start``.
        switches: what instrumented program text looks at; item 0 is this object.
    """

    def __init__(self, size: int) -> None:
        """Make the switches; ``size`` is the largest number of a place."""
        self.active: tuple[int, int] | None = None  # its place, and its index there
        self.hits: dict[int, int] = {}
        self.idle: dict[int, int] = {}
        self.example: tuple[Any, Any] | None = None
        self._kept: tuple[dict[int, int], dict[int, int], tuple[Any, Any] | None] = ({}, {}, None)
        self._has_acted = False
        self._paused_in: set[int] = set()
        self.on_place: Callable[[int, frozenset[int]], None] | None = None
        self.forms: Callable[[int], Forms | None] = lambda place: None
        self.on_act: Callable[[], None] = lambda: None
        self.on_idle: Callable[[], None] = lambda: None
        self.on_first: Callable[[int], None] | None = None
        self.switches: list[Any] = [self, *([False] * size)]

    def keep(self) -> None:
        """Count in every later test what was counted so far."""
        self._kept = (self.hits, self.idle, self.example)

    def start(self) -> None:
        """Reset the counts for a new test."""
        hits, idle, self.example = self._kept
        self.hits, self.idle, self._has_acted = dict(hits), dict(idle), False

    @property
    def place(self) -> int:
        """The place of the active alternative; 0 for the original."""
        return self.active[0] if self.active is not None else 0

    @property
    def acted(self) -> int:
        """The evaluations at which the active alternative changed something, or raised."""
        return self.hits.get(self.place, 0) - self.idle.get(self.place, 0)

    def note(self, place: int, before: Any, after: Any, *, is_idle: bool) -> None:
        """Note an alternative's value, the original's, if that is known, and whether they are the same."""
        if is_idle:
            self.idle[place] = self.idle.get(place, 0) + 1
            self.on_idle()
            return
        if before is not _UNKNOWN and self.example is None:
            self.example = (shown(before), shown(after))
        self.act()

    def act(self) -> None:
        """Report that the active alternative changed something, or may have."""
        if not self._has_acted:
            self._has_acted = True
            self.on_act()

    def activate(self, place: int = 0, index: int = 0) -> None:
        """Activate this alternative and no other; 0 for none."""
        self.active = (place, index) if place else None
        self._set({})

    def watch(self, live: Mapping[int, frozenset[int]]) -> None:
        """Report each of these alternatives, by place, when it may differ.

        Those whose effect cannot be computed ahead are reported when reached, as negative indexes always are.
        """
        self._set(live)

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Evaluate all places as the original in this thread inside the context, without counting."""
        thread = get_ident()
        self._paused_in.add(thread)
        try:
            yield
        finally:
            self._paused_in.discard(thread)

    def reached(self, switch: Switch, frame: types.FrameType) -> bool:
        """Return whether an alternative replaces the original at a place that is being evaluated."""
        if self._paused_in and get_ident() in self._paused_in:
            return False
        place = switch.place
        hits = self.hits[place] = self.hits.get(place, 0) + 1
        if switch.watched:
            self._look_ahead(switch, frame)
        index = self.active[1] if self.active is not None and self.active[0] == place else None
        if index is not None and index < 0:
            self._control(place, index)
            index = None
        if self.on_first is not None and hits == 1 + self._kept[0].get(place, 0):
            self.on_first(place)
        return index is not None

    def _look_ahead(self, switch: Switch, frame: types.FrameType) -> None:
        place = switch.place
        due = self._differing(switch, frame)
        switch.watched -= due
        if not switch.watched and switch.index is None:
            self.switches[place] = False
        if due and self.on_place is not None:
            self.on_place(place, due)
        if switch.watched and place != self.place:
            self.idle[place] = self.idle.get(place, 0) + 1

    def predicted(self, place: int, frame: types.FrameType) -> Any:
        """Return the original's value if it can be predicted without side effects."""
        forms = self.forms(place)
        try:
            return _UNKNOWN if forms is None else forms.original.value(frame)
        except Exception:  # it cannot be known; or only the original would have raised this
            return _UNKNOWN

    def _differing(self, switch: Switch, frame: types.FrameType) -> frozenset[int]:
        """Return the watched alternatives that may differ from the original."""
        forms = self.forms(switch.place)
        if forms is None or self.hits[switch.place] > _LOOKS or active_count() > 1:
            return switch.watched  # another thread may change what an evaluation depends on
        unpredictable = frozenset(index for index in switch.watched if index < 0)
        return unpredictable | forms.differing(switch.watched - unpredictable, frame)

    def _control(self, place: int, index: int) -> None:
        """Act as a control, which every place has: do nothing, or raise."""
        if index == FATAL:
            self.act()
            raise FatalFault(f"control: place {place} fails")
        assert index == IDENTITY
        self.idle[place] = self.idle.get(place, 0) + 1

    def _set(self, watched: Mapping[int, frozenset[int]]) -> None:
        switches: list[Any] = [False] * len(self.switches)
        for place, indexes in watched.items():
            switches[place] = Switch(self, place, None, indexes)
        if self.active is not None:
            place, index = self.active
            switches[place] = Switch(self, place, index, watched.get(place, frozenset()))
        self.switches[1:] = switches[1:]  # at once: other threads may look at them

    # what templates may call (``HELPER``); none of it belongs to one operator

    def fail(self, name: str, text: str) -> NoReturn:
        """Raise an exception of this name and text."""
        self.act()
        raise error_of(name)(text)

    def fail_if(self, value: Any, wrong: Any, name: str, text: str) -> Any:
        """Return the value; fail if it, or one element of it, equals ``wrong``."""
        equal = value == wrong
        if equal.any() if hasattr(equal, "any") else equal:
            self.fail(name, text)
        return value

    def absolute(self, value: Any) -> Any:
        """Return the absolute value, even if the program has redefined ``abs``."""
        return abs(value)


_PLAIN: dict[type, str] = {
    bool: "truth", int: "integer", float: "number", complex: "number", str: "text", bytes: "text",
    set: "set", frozenset: "set", type(None): "none",
}  # fmt: skip
#: what stands for something else rather than for a value
_FUNCTIONS = (types.FunctionType, types.BuiltinFunctionType, types.MethodType)
_NO_VARIABLE = (*_FUNCTIONS, types.ModuleType, type, type(None))
_ARRAYS = {"b": "truth", "i": "integer", "u": "integer", "f": "number", "c": "number"}


def kind_of(value: Any) -> str:
    """Return a value's kind: ``number``, ``integer``, ``truth``, ``text``, ``set``, ``none`` or its type.

    Looks at the type alone: what objects answer when they are asked may have effects.
    """
    kind = type(value)
    plain = _PLAIN.get(kind)
    if plain is not None:
        return plain
    if is_of_numpy(value):
        return _ARRAYS.get(value.dtype.kind, "other")
    if issubclass(kind, enum.Flag):
        return "flag"
    if issubclass(kind, numbers.Integral):
        return "integer"
    if issubclass(kind, numbers.Number):
        return "number"
    return class_name(types.FunctionType if _wraps_function(kind) else kind)


def is_variable(value: Any) -> bool:
    """Return whether a name with this value is a variable, not a module, function or class."""
    kind = type(value)
    return not (issubclass(kind, _NO_VARIABLE) or _wraps_function(kind))


def _wraps_function(kind: type[Any]) -> bool:
    """Return whether a class is of wrapt's function wrappers, which operations are; wrapt is not imported."""
    wrapt = sys.modules.get("wrapt")
    wrappers = getattr(wrapt, "FunctionWrapper", ()), getattr(wrapt, "BoundFunctionWrapper", ())
    return issubclass(kind, wrappers)


#: evaluations per test at which a place is looked at
LOOKS = 20
#: the same for the variables around a variable, which takes longer
LOOKS_AROUND = 3


def hand_through(value: Any) -> Any:
    """Return the value unchanged, at places that have been observed often enough."""
    return value


class Sightings:
    """All places of the program, and the values that were observed there.

    Attributes:
        entered: places that were reached since the start of the test.
        asked: those that were looked at.
        switches: what instrumented program text calls, by number of the place; item 0 notes what is reached.
    """

    def __init__(self, size: int, places: Mapping[int, TextPlace]) -> None:
        """Make the witnesses; ``size`` is the largest number of a place."""
        self._witnesses = [_Witness(self, number, places.get(number)) for number in range(1, size + 1)]
        self.entered: set[int] = set()
        self.asked: list[_Witness] = []
        self._on_first: Callable[[int], None] | None = None
        self.switches: list[Callable[[Any], Any]] = [self.entered.add, *self._witnesses]

    def report_first(self, on_first: Callable[[int], None]) -> None:
        """Report each place when it is first reached in a test."""
        self._on_first = on_first
        self.switches[0] = self._enter

    def _enter(self, place: int) -> None:
        if place not in self.entered:
            self.entered.add(place)
            if self._on_first is not None:
                self._on_first(place)

    def start(self) -> None:
        """Watch every place again for a new test."""
        self.entered.clear()
        asked, self.asked = self.asked, []
        for witness in asked:
            witness.start()
            if not witness.is_exhausted:
                self.switches[witness.place] = witness

    def seen(self) -> tuple[Sighting, ...]:
        """Return all observations so far, by place."""
        return tuple(witness.sighting() for witness in self._witnesses if witness.hits)


class _Witness:
    """Observes one place of the program text.

    What it keeps, it has from the start: a test may count the objects that the collector of garbage knows.

    Attributes:
        place: its number.
        looks, looks_around: since the start of the test.
        hits: evaluations that were looked at, over all tests.
    """

    def __init__(self, owner: Sightings, number: int, place: TextPlace | None) -> None:
        self._owner, self.place = owner, number
        self._variable = place.text if place is not None and place.variable else None
        self._lacking = (
            {alternative.needs for alternative in place.alternatives if alternative.needs}
            if place is not None
            else set()
        )
        self._is_around = self._variable is not None  # as far as is known, others may stand in its place
        self._has_looked_around = False
        self.hits = self.looks = self.looks_around = 0
        self._types: set[type] = set()
        self._kinds: set[str] = set()
        self._variables: set[str] = set()

    def start(self) -> None:
        """Begin a new test."""
        self.looks = self.looks_around = 0

    def __call__(self, value: Any) -> Any:
        if not self.looks:
            self._owner.asked.append(self)
        self.hits += 1
        self.looks += 1
        kind = type(value)
        if kind not in self._types:
            self._note_kind(kind, value)
        if self._is_around and self.looks_around < LOOKS_AROUND:
            self.looks_around += 1
            self._keep_variables(value, _getframe(1))
        if self.looks >= LOOKS or self.is_exhausted:
            self._owner.switches[self.place] = hand_through
        return value

    @property
    def is_exhausted(self) -> bool:
        """Whether further observations would add nothing."""
        return not (self._lacking or self._is_around)

    def _note_kind(self, kind: type, value: Any) -> None:
        name = kind_of(value)
        if vars(sys.modules.get(kind.__module__, types)).get(kind.__qualname__) is kind:
            self._types.add(kind)
        elif name in self._kinds:  # classes that a function makes end with it: they are not kept
            return
        self._kinds.add(name)
        self._lacking -= {need for need in self._lacking if fits_kinds(need, self._kinds)}
        self.looks_around = 0

    def _keep_variables(self, value: Any, frame: types.FrameType) -> None:
        """Keep the variables that have the value's type at every observation."""
        among = self._variables if self._has_looked_around else None
        names = set(_alike(value, frame, among)) - {self._variable} if is_variable(value) else set()
        self._variables.clear()
        self._variables |= names
        self._has_looked_around, self._is_around = True, bool(names)

    def sighting(self) -> Sighting:
        """Return the observations."""
        kinds, variables = sorted(self._kinds), sorted(self._variables)
        return Sighting(self.place, self.hits, tuple(kinds), tuple(variables))


def _alike(value: Any, frame: types.FrameType, among: Collection[str] | None) -> Iterator[str]:
    """Yield names in a frame with a value of exactly this type, of all or ``among`` these.

    Of the function's own names and the module's: to mention a name of a function further out would make
    it a part of this one. So inside another function only such names of the module count as this one uses,
    since any other could be one of the function around it.
    """
    code = frame.f_code
    own = {*code.co_varnames, *code.co_cellvars, *code.co_freevars}
    allowed = code.co_names if "<locals>" in code.co_qualname else frame.f_globals
    local: Mapping[str, Any] = {}
    everywhere, kind = frame.f_globals, type(value)
    with suppress(UnpredictableError):
        local = locals_of(frame)
    for name in [*local, *everywhere] if among is None else among:
        found = type(local.get(name, _UNKNOWN)) is kind
        if not found and name in allowed and name not in own:
            found = type(everywhere.get(name, _UNKNOWN)) is kind
        # comprehensions have names of their own, which are no identifiers
        if found and name.isidentifier() and not name.startswith("__"):
            yield name
