"""Find calls of operations in program text that no test runs, by their names.

What is called there is known from the text alone. A call counts as one of an operation if its last name is
the operation's, unless the text says that it is something else: a function or method of the program, what was
imported from elsewhere, a built-in. Where what it is called on comes from elsewhere, or the command depends
on what is computed, the call is doubtful: it is reported, and gets no mutants.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from mutabot.frozen import frozen
from mutabot.languages.python import FRONT_END, extent_of, outer_of
from mutabot.model import Operation, Pattern, Site
from mutabot.model.notation import Notation
from mutabot.model.operation import ANY, owner_of
from mutabot.model.path import Path
from mutabot.model.source_units import FunctionNode, last_name

_FunctionOrLambda = FunctionNode | ast.Lambda
_NamedNode = FunctionNode | ast.ClassDef
#: built-in functions whose value is of the user's making
_HANDS_THROUGH = {"getattr", "iter", "max", "min", "next", "super", "vars"}
#: an origin within the program, or of a module that is imported relative to it
_HERE = "."
_DEEPEST = 8


@frozen
class NamedCall:
    """A call that has an operation's name.

    Attributes:
        site: where it stands.
        operation: the operation.
        pattern: the command, if the operation has several.
        doubt: why it may be none; empty if nothing says so.
    """

    site: Site
    operation: str
    pattern: str | None = None
    doubt: str = ""


@frozen
class KnownCalls:
    """The operations and calls that tests reach.

    Attributes:
        operations: the operations that can be called, by their last names.
        own: first parts of the names of the program's modules.
        reached: the operations that texts of calls stand for where a test reaches them.
        alone: texts of calls that were no operation's where a test reached them.
    """

    operations: Mapping[str, Sequence[Operation]]
    own: Collection[str]
    reached: Mapping[str, Collection[str]]
    alone: Collection[str]


def calls_in(source: str, file: str, known: KnownCalls) -> Iterator[NamedCall]:
    """Yield the calls of a file that have an operation's name. Raises SyntaxError or ValueError."""
    tree = ast.parse(source)
    origins = _Origins(tree, file)
    names = FRONT_END.names(source)
    for call, scope in _calls(tree.body, _CallScope()):
        last = origins.last_name(call.func)
        if last not in known.operations:
            continue
        name, occurrence = names[extent_of(call)]
        site = Site.in_program(file, extent_of(call), scope.name, name, occurrence)
        found = _operation(call, last, name, scope, origins, known)
        if found is not None:
            operation, doubt = found
            pattern = _pattern(call, operation)
            if not doubt and pattern is None and operation.patterns:
                doubt = "which command it is depends on what is computed"
            text = pattern.text if pattern is not None else None
            yield NamedCall(site, operation.target, text, doubt)


@frozen
class _CallScope:
    """The code around a call: its function, class and module.

    Attributes:
        name: as in ``code.co_qualname``.
        functions: the functions around it, the inner one last.
        owner: the class whose method it stands in.
    """

    name: str = "<module>"
    functions: tuple[_FunctionOrLambda, ...] = ()
    owner: ast.ClassDef | None = None
    is_class: bool = False

    def inner(self, name: str) -> str:
        if self.name == "<module>":
            return name
        return f"{self.name}.{name}" if self.is_class else f"{self.name}.<locals>.{name}"


def _calls(nodes: Sequence[ast.AST], scope: _CallScope) -> Iterator[tuple[ast.Call, _CallScope]]:
    """Yield all calls below these nodes, without annotations and code for type checkers."""
    for node in nodes:
        if isinstance(node, ast.Call):
            yield node, scope
        if isinstance(node, _FunctionOrLambda):
            yield from _calls(outer_of(node), scope)
            name = "<lambda>" if isinstance(node, ast.Lambda) else node.name
            inner = _CallScope(scope.inner(name), (*scope.functions, node), scope.owner)
            yield from _calls([node.body] if isinstance(node.body, ast.expr) else node.body, inner)
        elif isinstance(node, ast.ClassDef):
            yield from _calls(outer_of(node), scope)
            inner = _CallScope(scope.inner(node.name), scope.functions, node, is_class=True)
            yield from _calls(node.body, inner)
        elif isinstance(node, ast.If) and last_name(node.test) == "TYPE_CHECKING":
            yield from _calls(node.orelse, scope)
        elif isinstance(node, ast.AnnAssign):
            yield from _calls([node.value] if node.value is not None else [], scope)
        else:
            yield from _calls(list(ast.iter_child_nodes(node)), scope)


class _Origins:
    """Find where the names of a file come from, by its text alone."""

    def __init__(self, tree: ast.Module, file: str) -> None:
        self.file = file
        self.imported: dict[str, str] = {}
        self.defined = {statement.name for statement in tree.body if isinstance(statement, _NamedNode)}
        self._module = tree
        self._values: dict[ast.AST, dict[str, ast.expr]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    top = alias.name.partition(".")[0]
                    self.imported[alias.asname or top] = alias.name if alias.asname else top
            elif isinstance(node, ast.ImportFrom):
                module = "." * node.level + (node.module or "")
                self.imported |= {name.asname or name.name: f"{module}.{name.name}" for name in node.names}

    def last_name(self, function: ast.expr) -> str:
        """Return the last part of a called name, before it was renamed by an import."""
        if isinstance(function, ast.Name):
            return self.imported.get(function.id, function.id).rpartition(".")[2]
        return last_name(function) if not isinstance(function, ast.Call) else ""

    def of(self, node: ast.AST, scope: _CallScope, depth: int = 0) -> str | None:
        """Return the dotted name from which an expression derives; None if the text does not determine it."""
        if depth > _DEEPEST:
            return None
        match node:
            case ast.Name(id=name):
                return self._of_name(name, scope, depth)
            case ast.Attribute(value=ast.Name(id="self" | "cls"), attr=attribute) if scope.owner is not None:
                if attribute in _methods(scope.owner):
                    return _HERE + attribute
                return self._of_value(self._stored(scope.owner, "self." + attribute), scope, depth)
            case ast.Attribute(value=value, attr=attribute):
                origin = self.of(value, scope, depth + 1)
                return f"{origin}.{attribute}" if origin is not None else None
            case ast.Call(func=function):
                origin = self.of(function, scope, depth + 1)
                is_through = origin is not None and origin.removeprefix("builtins.") in _HANDS_THROUGH
                return None if is_through else origin
            case ast.Await(value=value):
                return self.of(value, scope, depth + 1)
            case ast.Constant(value=str(text)) if depth:  # an annotation may be a text
                is_name = all(part.isidentifier() for part in text.split("."))
                return self.of(ast.parse(text, mode="eval").body, scope, depth + 1) if is_name else None
            case ast.Constant() | ast.JoinedStr() | ast.List() | ast.Dict() | ast.Set() | ast.Tuple():
                return "builtins"
        return None

    def _of_name(self, name: str, scope: _CallScope, depth: int) -> str | None:
        for function in reversed(scope.functions):
            arguments = function.args
            for parameter in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
                if parameter.arg == name:
                    return self._of_value(parameter.annotation, scope, depth)
            stored = self._stored(function, name)
            if stored is not None:
                return self._of_value(stored, scope, depth)
        if name in self.imported:
            return self.imported[name]
        if name in self.defined:
            return _HERE + name
        stored = self._stored(self._module, name)
        if stored is None and hasattr(builtins, name):
            return f"builtins.{name}"
        return self._of_value(stored, _CallScope(), depth)

    def _stored(self, around: ast.AST, name: str) -> ast.expr | None:
        if around not in self._values:
            self._values[around] = _stored_in(around)
        return self._values[around].get(name)

    def _of_value(self, value: ast.AST | None, scope: _CallScope, depth: int) -> str | None:
        return self.of(value, scope, depth + 1) if value is not None else None


def _methods(owner: ast.ClassDef) -> set[str]:
    return {statement.name for statement in owner.body if isinstance(statement, _NamedNode)}


def _stored_in(around: ast.AST) -> dict[str, ast.expr]:
    """Return the last values, or the annotations, that names get in a function, class or module."""
    found: dict[str, ast.expr] = {}
    for node in ast.walk(around):
        match node:
            case ast.Assign(targets=targets, value=value):
                found |= dict.fromkeys(map(ast.unparse, targets), value)
            case ast.AnnAssign(target=target, annotation=annotation):
                found[ast.unparse(target)] = annotation
            case ast.withitem(optional_vars=ast.Name(id=name), context_expr=value):
                found[name] = value
            case ast.NamedExpr(target=ast.Name(id=name), value=value):
                found[name] = value
    return found


def _operation(
    call: ast.Call, last: str, text: str, scope: _CallScope, origins: _Origins, known: KnownCalls
) -> tuple[Operation, str] | None:
    """Return the operation that a call is of, and why that is in doubt; None if it is of none."""
    candidates = known.operations[last]
    reached = [operation for operation in candidates if operation.target in known.reached.get(text, ())]
    if reached:
        return reached[0], ""
    doubts: list[tuple[Operation, str]] = []
    sure: list[Operation] = []
    for candidate in candidates:
        doubt = _doubt(call, candidate, scope, origins, known)
        if doubt == "":
            sure.append(candidate)
        elif doubt is not None:
            doubts.append((candidate, doubt))
    if sure and text in known.alone:
        return sure[0], "where tests reach this text, it is not an operation"
    if sure:
        return _best(call, sure, scope, origins), ""
    return doubts[0] if doubts else None


def _doubt(
    call: ast.Call, operation: Operation, scope: _CallScope, origins: _Origins, known: KnownCalls
) -> str | None:
    """Return why it is doubtful that a call is of this operation; "" if it is not, None if it cannot be."""
    function = call.func
    if operation.target.startswith(ANY):
        return "" if isinstance(function, ast.Attribute) else None
    module, is_method = operation.module.partition(".")[0], bool(owner_of(operation.target))
    if isinstance(function, ast.Name):
        origin = origins.of(function, scope)
        if origin is None:
            return "" if not (scope.functions or is_method) else "it is a variable that is called"
        is_own = function.id in origins.defined and origin == _HERE + function.id
        is_elsewhere = is_own and not _is_in(operation, origins.file)
        return "" if _is_of(origin, module, known) and not is_elsewhere else None
    value = function.value if isinstance(function, ast.Attribute) else function
    origin = origins.of(function, scope)
    if origin == _HERE + getattr(function, "attr", "") and _is_self(value):
        return None  # the program's own method
    if isinstance(value, ast.Call) and last_name(value.func) == "super":
        return ""
    origin = origins.of(value, scope)
    if origin is None:
        return "" if is_method else "what it is called on is not known"
    if _is_of(origin, module, known):
        return ""
    is_module = isinstance(value, ast.Name | ast.Attribute) and _root(value) in origins.imported
    if is_module or origin == "builtins":
        return None
    return f"what it is called on comes from {origin}"


def _is_of(origin: str, module: str, known: KnownCalls) -> bool:
    """Return whether something comes from the operation's package, or from the program."""
    top = origin.partition(".")[0]
    return top in ("", module) or top in known.own


def _is_in(operation: Operation, file: str) -> bool:
    """Return whether an operation is defined in this file of the program."""
    return file.removesuffix(".py").replace("/", ".").endswith(operation.module)


def _is_self(node: ast.AST) -> bool:
    return isinstance(node, ast.Name) and node.id in ("self", "cls")


def _root(node: ast.AST) -> str:
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _best(call: ast.Call, operations: Sequence[Operation], scope: _CallScope, origins: _Origins) -> Operation:
    """Return the operation of this name whose class or arguments fit; the first if none does."""
    value = call.func.value if isinstance(call.func, ast.Attribute) else call.func
    origin = origins.of(value, scope) or ""
    given = {keyword.arg for keyword in call.keywords}

    def fits(operation: Operation) -> tuple[bool, bool]:
        owner = owner_of(operation.target).rpartition(":")[2]
        return bool(owner) and origin.endswith(owner), not given.isdisjoint(operation.described)

    return max(operations, key=fits)


def _pattern(call: ast.Call, operation: Operation) -> Pattern | None:
    """Return the text command of a call, by its string literals; None if these do not determine it."""
    named = {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    root = Path.parse(operation.message, rooted=True).root if operation.message is not None else None
    values = [named[root]] if root in named else [*call.args, *named.values()]
    texts = [text for value in values for text in _texts(value)]
    for pattern in operation.patterns:
        cases = {Path.parse(case.argument, rooted=True).root or "": case.value for case in pattern.when}
        if not all(_is_case(named.get(name), value) for name, value in cases.items()):
            continue
        if pattern.notation is None or _reads(pattern.notation, texts):
            return pattern
    return None


def _reads(notation: str, texts: Iterable[str]) -> bool:
    return any(Notation.compile(notation).read(text) is not None for text in texts)


def _is_case(value: ast.expr | None, wanted: str) -> bool:
    return isinstance(value, ast.Constant) and str(value.value).lower() == wanted.lower()


def _texts(node: ast.expr) -> Iterator[str]:
    """Yield the texts that an expression may give: literals, and f-strings with samples of computed parts."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        for sample in ("1", "1.0", "a"):
            parts = (value.value if isinstance(value, ast.Constant) else sample for value in node.values)
            yield "".join(map(str, parts))
