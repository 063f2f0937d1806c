"""What one process sees of the calls in some files: which callables, with which values.

Every call and every attribute that is read asks the watch first: ``arm.move(1)`` becomes
``__mutabot_method__(arm, 'move', 7)(1)``, where 7 is the place; a function's name likewise. Nothing is
written: the text is changed while it is imported, and nothing changes that the program can see.
"""

from __future__ import annotations

import ast
import builtins
import functools
import inspect
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from types import FrameType, ModuleType
from typing import Any

from mutabot.model.path import class_name
from mutabot.model.watched import Command, Values, WatchedCallable, WatchedCalls
from mutabot.runtime.interception.adapter import is_mock
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text import loading as scripts
from mutabot.runtime.targets.target import Where
from mutabot.runtime.watching.callee import Callee, any_method, described, function_of, meant_by, method_of
from mutabot.runtime.watching.names import NamesSeen
from mutabot.runtime.watching.values import look, plain

METHOD, NAME, READ = "__mutabot_method__", "__mutabot_name__", "__mutabot_read__"
#: these look at the frame that calls them
_BOUND_TO_FRAME = frozenset({"super", "locals", "globals", "vars", "dir", "eval", "exec", "breakpoint"})


class _Watched:
    """Puts the watch into files while they are compiled. See ``loading.Step``."""

    def __init__(self, files: Mapping[str, str], new_place: Callable[[str, int], int]) -> None:
        self._files, self._new_place = files, new_place

    def wants(self, path: str) -> bool:
        """Whether the file is to be watched."""
        return os.path.realpath(path) in self._files

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Let every call and every attribute that is read ask the watch first."""
        name = self._files[os.path.realpath(path)]
        watch(tree, lambda line: self._new_place(name, line))

    def give_up(self, path: str, error: Exception) -> None:
        """What cannot be compiled says so itself."""


def watch(tree: ast.Module, place: Callable[[int], int]) -> None:
    """Put the watch into a tree."""
    ast.fix_missing_locations(_Watcher(place).visit(tree))


class _Watcher(ast.NodeTransformer):
    """Puts the watch into a tree."""

    def __init__(self, place: Callable[[int], int]) -> None:
        self._place = place

    def visit_Call(self, node: ast.Call) -> ast.expr:
        node.args = [self.visit(one) for one in node.args]
        for keyword in node.keywords:
            keyword.value = self.visit(keyword.value)
        match node.func:
            case ast.Attribute(value=inner, attr=name) if not name.startswith("_"):
                node.func = self._asked(METHOD, node.func, self.visit(inner), ast.Constant(name))
            case ast.Name(id=name) if name not in _BOUND_TO_FRAME:
                node.func = self._asked(NAME, node.func, node.func)
            case _:
                node.func = self.visit(node.func)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        node.value = self.visit(node.value)
        if not isinstance(node.ctx, ast.Load) or node.attr.startswith("_"):
            return node
        return self._asked(READ, node, node.value, ast.Constant(node.attr))

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        node.value = self.visit(node.value) if node.value is not None else None
        return node

    def visit_arg(self, node: ast.arg) -> ast.arg:
        return node  # an annotation may be read as text

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        return self._function(node)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> ast.AST:
        return self._function(node)

    def visit_match_case(self, node: ast.match_case) -> ast.match_case:
        node.guard = self.visit(node.guard) if node.guard is not None else None
        node.body = [self.visit(one) for one in node.body]
        return node

    def _function(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> ast.AST:
        node.decorator_list = [self.visit(one) for one in node.decorator_list]
        self.visit(node.args)
        node.body = [self.visit(one) for one in node.body]
        return node

    def _asked(self, function: str, at: ast.expr, *arguments: ast.expr) -> ast.Call:
        place = ast.Constant(self._place(at.end_lineno or at.lineno))
        asked = ast.Call(ast.Name(function, ast.Load()), [*arguments, place], [])
        return ast.copy_location(asked, at)


#: calls of one callable whose values are looked at; more are only counted
MOST_CALLS = 300
#: packages that talk to no robot
_NO_ROBOTS = frozenset(
    {
        "_pytest", "pytest", "pluggy", "mutabot", "numpy", "scipy", "pandas", "matplotlib", "hypothesis",
        "yaml", "loguru", "attr", "attrs", "pydantic", "typing_extensions", "torch", "jax", "sympy", "rich",
        "networkx", "click", "typer", "PIL", "math3d", "transforms3d",
    }
)  # fmt: skip
#: names of arguments that tell which command a call is
_TELLING = frozenset(
    {
        "node", "node_id", "nodeid", "name", "address", "register", "tag", "channel", "signal", "topic",
        "variable",
    }
)  # fmt: skip
_TALKS = re.compile(r"(?:^|_)(?:read|write|get|set|send|publish)(?:_|$)", re.IGNORECASE)
#: more commands than these, and longer texts, are no list of commands
_MOST_COMMANDS, _LONGEST = 24, 60


@dataclass(slots=True)
class _Seen:
    """A callable and what was seen of it."""

    callee: Callee
    call: WatchedCallable
    is_coroutine: bool
    returns_coroutine: bool = False
    looked_at: int = 0
    raised: dict[str, None] = field(default_factory=dict)
    has_no_commands: bool = False


#: the calls that are under way here, the outermost first
_under_way: ContextVar[tuple[_Seen, ...]] = ContextVar("mutabot_watched_calls", default=())


class Watch:
    """What is seen of the calls in some files.

    Args:
        program, tests: real paths to names for people.
        libraries: client libraries of middlewares, with ``*`` for any text: what is done through them has a
            name of its own.
        pulse: called whenever something is seen, while nothing is held.
    """

    def __init__(
        self,
        program: dict[str, str],
        tests: dict[str, str],
        libraries: Iterable[str] = (),
        pulse: Callable[[], None] = lambda: None,
    ) -> None:
        self._program, self._tests, self._libraries, self._pulse = program, tests, tuple(libraries), pulse
        self._places: list[tuple[str, int]] = []
        self._numbers: dict[tuple[str, int], int] = {}
        self._seen: dict[tuple[str, bool], _Seen] = {}
        self._known: dict[tuple[Any, str], Callee | None] = {}
        self._patches: dict[tuple[str, str], type | None] = {}
        self._names: NamesSeen | None = None
        self._files: dict[str, tuple[str, bool] | None] = {}

    def install(self) -> None:
        """Watch what is imported from now on."""
        self._names = NamesSeen(self._place_of, self._leads, self._pulse)
        setattr(builtins, METHOD, self.method)
        setattr(builtins, NAME, self.named)
        setattr(builtins, READ, self.read)
        loading.add(_Watched({**self._program, **self._tests}, self._place))
        scripts.hook_runpy()

    def method(self, value: Any, name: str, place: int) -> Any:
        """``value.name`` is about to be called."""
        found = getattr(value, name)
        if isinstance(found, type):
            return found
        callee = self._method(value, name)
        if not self._is_of_tests(place):
            callee = self._stood_for(value, name, callee, found)
        return self._wrapped(found, self._of(callee, place), place)

    def named(self, function: Any, place: int) -> Any:
        """A function is about to be called by its name."""
        if isinstance(function, type):
            return function
        return self._wrapped(function, self._of(function_of(function), place), place)

    def read(self, value: Any, name: str, place: int) -> Any:
        """``value.name`` is read."""
        found = getattr(value, name)
        raw = inspect.getattr_static(type(value), name, None)
        if isinstance(raw, property | functools.cached_property):
            seen = self._of(method_of(value, name), place)
            if seen is not None and self._counts(seen, place):
                self._answer(seen, found)
        return found

    def data(self) -> WatchedCalls:
        """What was seen: callables, and what was done under names."""
        uses = list(self._names.uses.values()) if self._names is not None else []
        return WatchedCalls([self._call(seen) for seen in list(self._seen.values())], uses)

    def _place_of(self, frame: FrameType | None, where: Where | None) -> tuple[str, int, bool] | None:
        """File, line and side of a frame or the nearest one around it, or of what is called back."""
        if where is not None and where.code is not None:
            found = self._side(where.code.co_filename)
            return (found[0], where.code.co_firstlineno, found[1]) if found is not None else None
        while frame is not None:
            found = self._side(frame.f_code.co_filename)
            if found is not None:
                return found[0], frame.f_lineno, found[1]
            frame = frame.f_back
        return None

    def _side(self, file: str) -> tuple[str, bool] | None:
        """A file's name for people, and whether it is on the tests' side; None if it is on none."""
        if file not in self._files:
            real = os.path.realpath(file)
            name = self._program.get(real, self._tests.get(real))
            self._files[file] = (name, real not in self._program) if name is not None else None
        return self._files[file]

    def _leads(self) -> None:
        """Something is done under a name: the calls that are under way lead to it."""
        for seen in _under_way.get():
            seen.call.leads_to_names = True

    def _place(self, file: str, line: int) -> int:
        if (file, line) not in self._numbers:
            self._numbers[file, line] = len(self._places)
            self._places.append((file, line))
        return self._numbers[file, line]

    def _method(self, value: Any, name: str) -> Callee | None:
        """A method by its name; looked up once for each class."""
        if inspect.ismodule(value) or isinstance(value, super) or name in getattr(value, "__dict__", ()):
            return method_of(value, name)
        key = (value if isinstance(value, type) else type(value), name)
        if key not in self._known:
            self._known[key] = method_of(value, name)
        return self._known[key]

    def _stood_for(self, value: Any, name: str, callee: Callee | None, found: Any) -> Callee | None:
        """What a mock or a class of the tests stands for: the robot's callable, or any of its name."""
        if is_mock(value):
            kind = vars(value).get("_spec_class") or self._patched(value._extract_mock_name(), name)
            return (meant_by(kind, name) if kind is not None else None) or any_method(name)
        if is_mock(found) and isinstance(value, type | ModuleType):
            where = f"{value.__name__}:" if isinstance(value, ModuleType) else f"{class_name(value)}."
            is_class = name[:1].isupper()
            return None if is_class else Callee(f"{where}{name}", None, None, "", stands_in=True)
        if callee is None or callee.owner is None or callee.file not in self._tests:
            return callee
        meant = (meant_by(kind, name) for kind in callee.owner.__mro__[1:-1])
        robots = next((one for one in meant if one is not None and one.file not in self._tests), None)
        return robots or any_method(name, callee)

    def _patched(self, spelt: str, name: str) -> type | None:
        """The class that a mock of this name stands for: the only one of that name with such a method."""
        root = re.split(r"\W", spelt)[0]
        if (root, name) in self._patches:
            return self._patches[root, name]
        kinds = {
            id(kind): kind
            for module in list(sys.modules.values())
            for kind in [getattr(module, "__dict__", {}).get(root)]
            if isinstance(kind, type) and kind.__name__ == root and callable(getattr(kind, name, None))
        }
        self._patches[root, name] = next(iter(kinds.values())) if len(kinds) == 1 else None
        return self._patches[root, name]

    def _of(self, callee: Callee | None, place: int) -> _Seen | None:
        """What this side, program or tests, has seen of a callable; None for one that is no robot's."""
        if callee is None:
            return None
        key = (callee.target, self._is_of_tests(place))
        known = self._seen.get(key)
        if known is None or (known.callee.raw is None and callee.raw is not None):
            top = callee.target.partition(":")[0].partition(".")[0]
            if _is_no_robot(top) or any(fnmatchcase(top, name) for name in self._libraries):
                return None
            call = described(callee, of_tests=key[1], own=callee.file in self._program)
            call.sites = known.call.sites if known is not None else {}  # a mock told no more than them
            is_coroutine = inspect.iscoroutinefunction(getattr(callee.raw, "__func__", callee.raw))
            known = self._seen[key] = _Seen(callee, call, is_coroutine)
        return known

    def _wrapped(self, function: Any, seen: _Seen | None, place: int) -> Any:
        if seen is None or not self._counts(seen, place):
            return function

        instance = getattr(function, "__self__", None)

        def watched(*args: Any, **kwargs: Any) -> Any:
            command: Command | None = None
            with suppress(Exception):  # looking at values must not disturb the program
                values = self._arguments(seen, args, kwargs, instance)
                command = _command(seen, instance, values)
            token = _under_way.set((*_under_way.get(), seen))
            try:
                result = function(*args, **kwargs)
            except Exception as error:
                seen.raised[class_name(type(error))] = None
                raise
            finally:
                _under_way.reset(token)
            if inspect.iscoroutine(result):
                seen.returns_coroutine = not seen.is_coroutine
                return self._awaited(seen, command, result)
            self._answer(seen, result, command)
            return result

        return watched

    async def _awaited(self, seen: _Seen, command: Command | None, waiting: Any) -> Any:
        token = _under_way.set((*_under_way.get(), seen))
        try:
            result = await waiting
        except Exception as error:
            seen.raised[class_name(type(error))] = None
            raise
        finally:
            with suppress(ValueError):  # a coroutine that is closed from elsewhere
                _under_way.reset(token)
        self._answer(seen, result, command)
        return result

    def _counts(self, seen: _Seen, place: int) -> bool:
        """Count a call; whether its values are to be looked at."""
        if seen.call.of_tests and (seen.call.own or seen.callee.file in self._tests):
            return False
        self._pulse()
        file, line = self._places[place]
        where = f"{file}:{line}"
        seen.call.sites[where] = seen.call.sites.get(where, 0) + 1
        seen.looked_at += 1
        return seen.looked_at <= MOST_CALLS

    def _is_of_tests(self, place: int) -> bool:
        return self._places[place][0] in self._tests.values()

    def _arguments(
        self, seen: _Seen, args: tuple[Any, ...], kwargs: dict[str, Any], instance: Any
    ) -> dict[str, Any]:
        """Look at the arguments of a call, and return those whose names are known."""
        values, signature, call = dict(kwargs), seen.callee.signature, seen.call
        if signature is None:
            for index, value in enumerate(args):
                look(call.positional, value, f"#{index}")
        else:
            try:
                bound = signature.bind(*args, **kwargs)
            except TypeError:
                return {}
            bound.apply_defaults()
            values = dict(bound.arguments)
            for name, parameter in signature.parameters.items():
                if parameter.kind is inspect.Parameter.VAR_KEYWORD:
                    values.update(values.pop(name, {}))
        for name, value in values.items():
            known = call.arguments.setdefault(name, Values())
            look(known, value, name)
            limits = _limits(value, instance) if "step" in call.name else None
            for part in known.parts.values():
                if part.length is not None and limits is not None and len(limits) == part.length:
                    part.limits = limits
        return values

    def _answer(self, seen: _Seen, result: Any, command: Command | None = None) -> None:
        with suppress(Exception):
            look(seen.call.result, result)
            if command is not None:
                look(command.result, result)

    def _call(self, seen: _Seen) -> WatchedCallable:
        sides = (self._seen.get((seen.call.target, of_tests)) for of_tests in (False, True))
        raised = [
            name for side in sides if side is not None for name in side.raised
        ]  # tests make robots refuse
        call = replace(seen.call, raised=list(dict.fromkeys([*seen.call.raised, *raised])))
        if seen.returns_coroutine and not call.stands_in:
            call.problem = "it returns a coroutine but is no coroutine function: name the one behind it"
        return call


def _limits(value: Any, instance: Any) -> list[list[float]] | None:
    """Least and greatest values of an action, as the environment or the simulated model tells them."""
    space: Any = getattr(instance, "action_space", None)
    if hasattr(space, "low") and hasattr(space, "high"):
        pairs = zip(plain(space.low), plain(space.high), strict=True)
        return [[float(low), float(high)] for low, high in pairs]
    model = getattr(value, "model", None) if type(value).__name__ == "MjData" else None
    return plain(model.actuator_ctrlrange) if model is not None else None


def _command(seen: _Seen, instance: Any, values: Mapping[str, Any]) -> Command | None:
    """Which command a call is, by a node, register or name that tells it apart; None if nothing does."""
    call = seen.call
    if seen.has_no_commands:
        return None
    by, text = _told_by(call.name, instance, values)
    if not by or call.told_by not in ("", by) or len(text) > _LONGEST or len(call.commands) > _MOST_COMMANDS:
        seen.has_no_commands, call.told_by = True, ""
        call.commands.clear()
        return None
    call.told_by = by
    command = call.commands.setdefault(text, Command())
    for name, value in values.items():
        if name != by:
            look(command.arguments.setdefault(name, Values()), value, name)
    return command


def _told_by(name: str, instance: Any, values: Mapping[str, Any]) -> tuple[str, str]:
    """Path and text of what tells a command apart; empty texts if nothing does."""
    if not _TALKS.search(name):
        return "", ""
    for argument, value in values.items():
        is_plain = isinstance(value, str | int) and not isinstance(value, bool)
        if argument.lower() in _TELLING and (is_plain or _prints_itself(value)):
            return argument, str(value)
    return ("self", str(instance)) if _prints_itself(instance) else ("", "")


def _prints_itself(value: Any) -> bool:
    """Whether an object prints as a name of its own, as a node does by its id."""
    own: Any = type(value).__str__
    if value is None or own is object.__str__ or not hasattr(value, "__dict__"):
        return False
    text = str(value)
    return "\n" not in text and " object at " not in text


def _is_no_robot(top: str) -> bool:
    """Whether nothing of a top-level package is to be described as a call."""
    return top in sys.stdlib_module_names or top in _NO_ROBOTS or top.startswith("pytest")
