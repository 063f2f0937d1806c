"""Instrument calls in the text that may be calls of operations.

Files of the program and of the oracle are compiled with a question at each call whose last name is that of an
operation: ``x.f(args)`` becomes ``S[17](x)(args)``, and ``f(args)`` becomes ``S[17](f)(args)``. The answer is
what is called: the very object that stands there, or what makes the call a site. So no frame is added to a
call that is left alone, and lines and columns stay the user's. ``S`` is a plain list under a built-in name.
In files of the program an operation may also be handed on without being called (``handed_on``).

Which expressions of the text hand on what they read, and to which call.

An operation need not be called where it is read: ``go = arm.move``, ``Thread(target=arm.move)``,
``{"home": arm.home}``. What is compared, or only looked at, is not handed on.
"""

from __future__ import annotations

import ast
import builtins
import copy
from collections.abc import Callable, Collection, Container, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter
from sys import _getframe
from types import FrameType, FunctionType, MethodType
from typing import Any

from mutabot.languages.python import extent_of
from mutabot.model import Role
from mutabot.model.mutant import Extent
from mutabot.model.source_units import FunctionNode
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text.compiling import SourceStep
from mutabot.runtime.program_text.instrument import declare_global, is_instrumentation, is_switch
from mutabot.runtime.program_text.returns import is_translated
from mutabot.runtime.targets.target import CallPlace
from mutabot.runtime.targets.wrapper import WRAPPERS, unbound

_PLACE = "handed_to"


def is_passed_on(node: ast.expr) -> bool:
    """Return whether the value of an expression is passed on."""
    return isinstance(getattr(node, "ctx", None), ast.Load) and hasattr(node, _PLACE)


def _place(node: ast.AST) -> ast.expr | None:
    if isinstance(node, ast.Call) and not is_instrumentation(node.func):
        return node
    return getattr(node, _PLACE, None)


def _parts(node: ast.AST) -> Iterator[ast.expr]:
    match node:
        case ast.Call():
            if hasattr(node, _PLACE) or not is_instrumentation(node.func):
                yield from (*node.args, *(keyword.value for keyword in node.keywords))
        case ast.Assign(targets=[ast.Name(id=name), *_]) if name.startswith("@"):  # pytest's own
            return
        case ast.Assign() | ast.NamedExpr():
            yield node.value
        case ast.AnnAssign() | ast.Return() | ast.Yield():
            if node.value is not None:
                yield node.value
        case ast.Lambda():
            yield node.body
        case ast.arguments():
            yield from (*node.defaults, *(default for default in node.kw_defaults if default is not None))
        case ast.BoolOp(values=[ast.Call(func=entered), _]) if is_switch(entered):  # a witness
            yield from node.values[1:] if hasattr(node, _PLACE) else ()
        case ast.Dict() | ast.BoolOp():
            yield from node.values
        case ast.List() | ast.Tuple() | ast.Set():
            yield from node.elts
        case ast.IfExp() if hasattr(node, _PLACE):
            yield from (node.body, node.orelse)


#: the built-in name of the list
CALLS = "__mutabot_calls__"
#: of all sites of this process: text that was loaded before is asked as before
_entries: list[Any] = []
#: the most arguments that Python gives a method without binding it first
_MOST_OF_METHOD = 30


#: names in modules, and what they meant
Guards = tuple[tuple[dict[str, Any], str, Any], ...]


@dataclass(slots=True, eq=False)
class CallSite:
    """A call in the text, or a place where a callable is passed on.

    Attributes:
        path: its file, as code objects name it.
        role: whose file it is.
        name: the last name of what is called.
        extent: where it stands, as the interpreter reports the running call.
        is_handed: whether something is handed on there, rather than called.
        is_awaited: whether it is awaited where it stands.
        is_given: whether what is handed on is given to the call that stands there.
        left_alone: what is called as it is there, by the classes of its object and of itself, as long as some
            names mean what they did.
        place: the same as a span, once it was looked up.
        number: its number among the questions of this process.
        is_attribute: whether what stands there is read from an object.
    """

    path: str
    role: Role
    name: str
    extent: Extent
    is_handed: bool = False
    is_awaited: bool = False
    is_given: bool = False
    left_alone: dict[tuple[type, Any], Guards] = field(default_factory=dict)
    place: CallPlace | None = None
    number: int = -1
    is_attribute: bool = False


#: decides what is called at a site: gets the site, what stands there, the object that it was read from
#: (``NOTHING`` where it was read from a name) and the frame
Decide = Callable[[CallSite, Any, Any, FrameType], Any]

#: called at an assignment with the site, the object that it changes, and what ``__setattr__`` or
#: ``__setitem__`` would be given of it beside the name of an attribute
Stored = Callable[[CallSite, Any, list[Any]], None]

#: the receiver of what was read from a name
NOTHING = object()
#: a guard that never holds
_ASK: Guards = (({}, "", NOTHING),)


@dataclass(slots=True, eq=False)
class CallSites(SourceStep):
    """Instruments files with a hook at each call site, and answers the hooks.

    Of a file that is compiled without, calls are seen by what they call.

    Args:
        names: last names that are asked about: those of the operations.
        role: whose file a path is.
        stands: decides what is called.
        sees_itself: handlers of what sees its calls itself: of that nothing is asked.
        hands: decides what is handed on; None to leave that as it is.
        are_read: whether ``hands`` decides about each attribute that is read, handed on or not.
        stored: called at each assignment to an attribute or an item, before it is made; None if not wanted.

    Attributes:
        loaded: files that were given questions.
        is_last: what rewrites calls sees none of the questions.
    """

    is_last = True

    names: Container[str]
    role: Callable[[str], Role | None]
    stands: Decide
    sees_itself: Collection[Any] = ()
    hands: Decide | None = None
    are_read: bool = False
    stored: Stored | None = None
    loaded: set[str] = field(default_factory=set)
    _numbers: dict[tuple[Any, ...], int] = field(default_factory=dict)
    #: what was worked out of the assignment that a frame is about to make, by the frame's identity
    _parts: dict[int, list[Any]] = field(default_factory=dict)

    def install(self) -> None:
        """Instrument all files that are loaded from now on."""
        if self.names:
            setattr(builtins, CALLS, _entries)
            loading.add(self)

    def hook_pytest(self) -> None:
        """Instrument files that pytest rewrites, after pytest has done so."""
        if self.names:
            loading.hook_pytest(self.wants, self.change)

    def wants(self, path: str) -> bool:
        """Return whether a file may have call sites."""
        return self.role(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Instrument the tree of a file, which pytest may have rewritten."""
        role = self.role(path)
        assert role is not None
        are_handed = self.hands is not None and role is Role.PROGRAM and not self.are_read
        number = partial(self._number, path, role)
        writer = _Writer(self.names, number, are_handed, self.are_read, self.stored is not None)
        writer.visit(tree)
        if writer.written:
            declare_global(tree, CALLS)
            self.loaded.add(path)

    @property
    def asked(self) -> set[str]:
        """The instrumented files, as code objects name them."""
        return {key[0] for key in self._numbers}

    def _number(self, path: str, role: Role, node: ast.expr, name: str, form: str) -> int:
        is_handed = form.startswith("handed")
        given_to = getattr(node, _PLACE, None) if is_handed else None
        is_awaited, extent = bool(getattr(node, "is_awaited", False)), extent_of(given_to or node)
        # an alternative may call or hand on something else where the original stands
        key = (path, extent_of(node), form, name, extent, is_awaited, given_to is not None)
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(_entries)
            site = CallSite(path, role, name, extent, is_handed, is_awaited, given_to is not None)
            site.number, site.is_attribute = number, form in ("attribute", "handed_attribute")
            _entries.append(getattr(self, f"_{form}")(site))
        return number

    @staticmethod
    def leave(site: CallSite) -> None:
        """Ask nothing more about what is called, handed on or read at a site."""
        _entries[site.number] = attrgetter(site.name) if site.is_attribute else _itself

    def _decide(self, site: CallSite, found: Any, receiver: Any, frame: FrameType) -> Any:
        decide = self.hands if site.is_handed else self.stands
        return found if decide is None else decide(site, found, receiver, frame)

    def _attribute(self, site: CallSite) -> Callable[[Any], Any]:
        name, left_alone, seen, frame_of = site.name, site.left_alone, self.sees_itself, _getframe

        def read(receiver: Any) -> Any:
            __tracebackhide__ = True
            # this is run at each call of such a name, so it calls nothing that it need not
            found = getattr(receiver, name)
            kind = type(found)
            function = found.__func__ if kind is MethodType else found
            if type(function) in WRAPPERS:
                if function._self_wrapper in seen:
                    return found
            elif left_alone:
                own = function if kind is MethodType or kind is FunctionType else kind
                for names, known_name, value in left_alone.get((type(receiver), own), _ASK):
                    if names.get(known_name) is not value:
                        break
                else:
                    return found
            return self._decide(site, found, receiver, frame_of(1))

        return read

    def _name(self, site: CallSite) -> Callable[..., Any]:
        left_alone, seen, frame_of = site.left_alone, self.sees_itself, _getframe

        def read(found: Any, receiver: Any = NOTHING) -> Any:
            function = unbound(found)
            if type(function) in WRAPPERS and not site.is_handed and function._self_wrapper in seen:
                return found
            if left_alone and type(found) is FunctionType:
                guards = left_alone.get((type(receiver), found), _ASK)
                if all(names.get(name) is value for names, name, value in guards):
                    return found
            return self._decide(site, found, receiver, frame_of(1))

        return read

    _handed_name = _name

    def _handed_attribute(self, site: CallSite) -> Callable[[Any], Any]:
        def read(receiver: Any) -> Any:
            __tracebackhide__ = True
            return self._decide(site, getattr(receiver, site.name), receiver, _getframe(1))

        return read

    def _handed_by_name(self, site: CallSite) -> Callable[[Any], Any]:
        sites: dict[str, CallSite] = {}

        def read(function: Any) -> Any:
            return partial(self._got, site, sites, _getframe(1)) if function is getattr else function

        return read

    def _stored_value(self, site: CallSite) -> Callable[[Any], Any]:
        def read(value: Any) -> Any:
            self._parts[id(_getframe(1))] = [value]
            return value

        return read

    def _stored_holder(self, site: CallSite) -> Callable[[Any], Any]:
        def read(holder: Any) -> Any:
            self._parts.setdefault(id(_getframe(1)), []).append(holder)
            return holder

        return read

    def _stored_item(self, site: CallSite) -> Callable[[Any], Any]:
        def read(key: Any) -> Any:
            value, holder = self._parts.pop(id(_getframe(1)))
            assert self.stored is not None
            self.stored(site, holder, [key, value])
            return key

        return read

    def _stored_attribute(self, site: CallSite) -> Callable[[Any], Any]:
        def read(holder: Any) -> Any:
            (value,) = self._parts.pop(id(_getframe(1)))
            assert self.stored is not None
            self.stored(site, holder, [value])
            return holder

        return read

    def _got(
        self, site: CallSite, sites: dict[str, CallSite], frame: FrameType, /, receiver: Any, name: str,
        *default: Any,
    ) -> Any:  # fmt: skip
        __tracebackhide__ = True
        found = getattr(receiver, name, *default)
        if name not in self.names:
            return found
        return self._decide(sites.setdefault(name, replace(site, name=name)), found, receiver, frame)


def _itself(found: Any, receiver: Any = NOTHING) -> Any:
    return found


#: annotations may be read as text, and the names of a pattern are no values
_NOT_RUN = ("annotation", "returns", "pattern", "type_params")


@dataclass(eq=False)
class _Writer(ast.NodeTransformer):
    """Writes hooks into a tree.

    What pytest has rewritten reads an attribute into a variable and calls that: ``S[17](variable, x)``, since
    its messages show the variable.
    """

    names: Container[str]
    number: Callable[[ast.expr, str, str], int]
    are_handed: bool
    are_read: bool
    are_stored: bool
    written: bool = False
    _read: dict[str, ast.expr] = field(default_factory=dict)

    def visit(self, node: ast.AST) -> Any:
        if isinstance(node, FunctionNode) and is_translated(node):
            return node
        if self.are_handed:
            for part in _parts(node):  # before these are visited
                setattr(part, _PLACE, _place(node))
        hidden = {name: vars(node).pop(name) for name in _NOT_RUN if name in vars(node)}
        try:
            return super().visit(node)
        finally:
            vars(node).update(hidden)

    def visit_Await(self, node: ast.Await) -> ast.AST:  # the name that ast looks for
        awaited = extent_of(node.value)
        for part in ast.walk(node.value):  # an instrumented call stands within what was put around it
            if isinstance(part, ast.Call) and extent_of(part) == awaited:
                part.is_awaited = True  # type: ignore[attr-defined]
        return self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> ast.AST:  # as above
        self.generic_visit(node)
        target = node.targets[0]
        if isinstance(target, ast.Name) and target.id.startswith("@py_"):
            self._read[target.id] = node.value
        elif self.are_stored and len(node.targets) == 1:
            self._ask_stored(node, target)
        return node

    def _ask_stored(self, node: ast.Assign, target: ast.expr) -> None:
        """Put a hook into an assignment, keeping the order: value, object, key."""
        if isinstance(target, ast.Attribute) and target.attr in self.names:
            forms = [("stored_attribute", target.attr, "value")]
        elif isinstance(target, ast.Subscript) and not isinstance(target.slice, ast.Slice | ast.Tuple):
            forms = [("stored_holder", "__setitem__", "value"), ("stored_item", "__setitem__", "slice")]
        else:
            return
        node.value = self._question(self.number(target, "", "stored_value"), node.value, [node.value])
        for form, name, part in forms:
            inner = getattr(target, part)
            setattr(target, part, self._question(self.number(target, name, form), inner, [inner]))

    def visit_Call(self, node: ast.Call) -> ast.AST:  # as above
        function = node.func
        self.generic_visit(node)
        asked = self._called(node, function)
        if asked is not function:
            node.func = asked
        return node

    def _called(self, node: ast.Call, function: ast.expr) -> ast.expr:
        """Return what a call calls, with a hook in it, and in what may take its place."""
        match function:
            case ast.IfExp() if is_switch(function.test):
                function.body = self._called(node, function.body)
                function.orelse = self._called(node, function.orelse)
                return function
            case ast.BoolOp(values=[ast.Call(func=entered), ast.Call() as shown]) if is_switch(entered):
                shown.args = [self._called(node, *shown.args)]
                return function
            case ast.Call(args=[*_, value]) if is_instrumentation(function.func):
                function.args[-1] = self._called(node, value)
                return function
        read = self._read.get(function.id, function) if isinstance(function, ast.Name) else function
        if isinstance(read, ast.Attribute) and read.attr in self.names and not is_instrumentation(read):
            if read is function:
                _as_compiled(node, read)
                return self._question(self.number(node, read.attr, "attribute"), function, [read.value])
            given = [function, copy.deepcopy(read.value)]
            return self._question(self.number(node, read.attr, "name"), function, given)
        if isinstance(read, ast.Name) and read.id == "getattr" and self.are_handed:
            return self._question(self.number(node, "", "handed_by_name"), function, [function])
        if isinstance(read, ast.Name) and read.id in self.names:
            return self._question(self.number(node, read.id, "name"), function, [function])
        return function

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:  # as above
        self.generic_visit(node)
        is_asked = is_passed_on(node) or (self.are_read and isinstance(node.ctx, ast.Load))
        if is_asked and node.attr in self.names and not is_instrumentation(node):
            number = self.number(node, node.attr, "handed_attribute")
            return self._question(number, node, [node.value])
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:  # as above
        if is_passed_on(node) and node.id in self.names:
            return self._question(self.number(node, node.id, "handed_name"), node, [node])
        return node

    def _question(self, number: int, function: ast.expr, given: list[ast.expr]) -> ast.expr:
        self.written = True
        entry = ast.Subscript(ast.Name(CALLS, ast.Load()), ast.Constant(number), ast.Load())
        for part in ast.walk(entry):
            if isinstance(part, ast.expr):
                ast.copy_location(part, given[0])
        return ast.copy_location(ast.Call(entry, given, []), function)


def _as_compiled(node: ast.Call, function: ast.Attribute) -> None:
    """Move a call, and the attribute it calls, to the positions that the compiler would give them.

    In a chain over several lines that is from the attribute's name on; for the call only where its method is
    not bound first.
    """
    last, end = function.end_lineno, function.end_col_offset
    if last is None or end is None or function.lineno == last:
        return
    start = max(end - len(function.attr), 0)
    is_method = len(node.args) + len(node.keywords) + bool(node.keywords) < _MOST_OF_METHOD
    is_plain = not any(isinstance(argument, ast.Starred) for argument in node.args)
    if is_method and is_plain and all(keyword.arg is not None for keyword in node.keywords):
        node.lineno, node.col_offset = last, start
    function.lineno, function.col_offset = last, start
