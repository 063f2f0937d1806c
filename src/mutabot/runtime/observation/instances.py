"""Which objects of a class the present test uses: what a probe on a method or attribute is read from.

Those that are ``self`` of an intercepted call in the running test, in the order of their first call. Where
there is none, one object: the last that was made in this test, else one that its fixtures hold, else the last
that was made before any test or while a module was imported. An object that another test made is never taken.
Objects are noted when they are made, by their class's ``__init__``, and when they are used, by the
interception.
"""

from __future__ import annotations

import contextlib
import sys
import weakref
from collections.abc import Callable, Iterable
from functools import partial
from types import ModuleType
from typing import Any

import wrapt

from mutabot.runtime.targets.target import NotFoundError, resolve

#: objects per class and test that are read
MOST = 20
#: modules that run others
_IMPORTERS = ("importlib._bootstrap", "importlib._bootstrap_external", "_pytest.assertion.rewrite")


class Instances:
    """The objects of certain classes, by the classes' names ``module:qualified.name``.

    Attributes:
        is_watching: whether there is a class to watch.
    """

    def __init__(self) -> None:
        self.is_watching = False
        self._classes: dict[type, str] = {}
        self._names: set[str] = set()
        self._known: dict[type, tuple[str, ...]] = {}
        self._used: dict[str, dict[int, Callable[[], Any]]] = {}
        # by whether they belong to one test, rather than to all
        self._made: dict[bool, dict[str, dict[int, weakref.ref[Any]]]] = {False: {}, True: {}}
        self._fixtures: Callable[[], Iterable[Any]] | None = None

    def watch(self, names: Iterable[str]) -> None:
        """Note the objects of each of these that turns out to be a class, from now on."""
        for name in names:
            if name and name not in self._names:
                self.is_watching = True
                self._names.add(name)
                self._watch(name)

    def _watch(self, name: str) -> None:
        module_name, _, qualname = name.partition(":")

        def imported(module: ModuleType) -> None:
            with contextlib.suppress(NotFoundError, TypeError):  # the inspection of the vocabulary tells
                owner, last, _ = resolve(module, qualname)
                found = getattr(owner, last)
                if isinstance(found, type) and found not in self._classes:
                    self._classes[found] = name
                    self._known.clear()
                    _note_made(found, self._note_made)
                    for value in list(vars(module).values()):  # made while the module was imported
                        if isinstance(value, found):
                            self._note(value, is_of_test=False)

        wrapt.register_post_import_hook(imported, module_name)

    def start(self, fixtures: Callable[[], Iterable[Any]] | None = None) -> None:
        """A new test begins: nothing has been used in it.

        ``fixtures`` tells what objects its fixtures hold. None in a process below the tests, which goes on
        with what it has made.
        """
        self._used.clear()
        self._fixtures = fixtures
        if fixtures is not None:
            self._made[True].clear()

    def let_go(self) -> None:
        """The running test is over: what it used is kept no longer."""
        self._used.clear()

    def used(self, instance: Any) -> None:
        """An object is ``self`` of an intercepted call."""
        for name in self._names_of(type(instance)):
            used = self._used.setdefault(name, {})
            if id(instance) not in used and len(used) < MOST:
                used[id(instance)] = _held(instance)

    def of(self, name: str) -> list[Any]:
        """The objects of this class that a probe is read from, as they are now."""
        return _alive(self._used.get(name, {})) or self._made_last(name, True) or self._held_by_fixtures(name)

    def _made_last(self, name: str, is_of_test: bool) -> list[Any]:
        return _alive(self._made[is_of_test].get(name, {}))[-1:]

    def _held_by_fixtures(self, name: str) -> list[Any]:
        given = self._fixtures() if self._fixtures is not None else ()
        held = [one for one in given if name in self._names_of(type(one))]
        return held[-1:] or self._made_last(name, False)

    def _names_of(self, kind: type) -> tuple[str, ...]:
        names = self._known.get(kind)
        if names is None:
            names = tuple(name for base, name in self._classes.items() if issubclass(kind, base))
            self._known[kind] = names
        return names

    def _note_made(self, instance: Any) -> None:
        self._note(instance, is_of_test=self._fixtures is not None and not _is_importing())

    def _note(self, instance: Any, *, is_of_test: bool) -> None:
        for name in self._names_of(type(instance)):
            made = self._made[is_of_test].setdefault(name, {})
            key = id(instance)
            with contextlib.suppress(TypeError):  # of a class without weak references
                made.pop(key, None)
                made[key] = weakref.ref(instance, partial(_forget, made, key))


def _alive(holds: dict[int, Any]) -> list[Any]:
    return [found for found in (hold() for hold in holds.values()) if found is not None]


def _is_importing() -> bool:
    """Whether a module is being imported: what it makes then is there for all tests that follow."""
    frame = sys._getframe(1)
    while frame.f_back is not None:
        if frame.f_code.co_name == "<module>" and frame.f_back.f_globals.get("__name__") in _IMPORTERS:
            return True
        frame = frame.f_back
    return False


def _forget(made: dict[int, weakref.ref[Any]], key: int, gone: weakref.ref[Any]) -> None:
    if made.get(key) is gone:
        del made[key]


def _held(instance: Any) -> Callable[[], Any]:
    """Keeps an object that the program may let go before its test ends, unless it would miss that."""
    if hasattr(type(instance), "__del__"):
        try:
            return weakref.ref(instance)
        except TypeError:
            return lambda: None
    return lambda: instance


def _note_made(owner: type, note: Callable[[Any], None]) -> None:
    """Let ``note`` be told every object of a class when it has been made."""

    def handle(wrapped: Any, instance: Any, args: Any, kwargs: Any) -> Any:
        __tracebackhide__ = True
        result = wrapped(*args, **kwargs)
        note(instance)
        return result

    with contextlib.suppress(AttributeError, TypeError):  # a type written in C
        original = vars(owner).get("__init__") or _inherited(owner)
        setattr(owner, "__init__", wrapt.FunctionWrapper(original, handle))  # noqa: B010  # mypy: unsound


def _inherited(owner: Any) -> Callable[..., None]:
    """What a class does that has no ``__init__`` of its own: what comes next for the object at hand."""

    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:  # noqa: N807
        __tracebackhide__ = True
        kind: Any = type(self)
        following = super(owner, self).__init__
        if getattr(following, "__objclass__", None) is not object:
            following(*args, **kwargs)
        elif (args or kwargs) and kind.__new__ is object.__new__:
            raise TypeError(f"{kind.__name__}() takes no arguments")

    return __init__
