"""The pieces of a Python file: each function, class and constant by itself, and the rest of the module.

What a piece says is its syntax tree, without positions, comments and layout, and what the names in it stand
for: two pieces that say the same do the same.
"""

from __future__ import annotations

import ast
import copy
import hashlib
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from mutabot.frozen import frozen

from .mentions import Mentions


class Kind(StrEnum):
    """What a piece is."""

    FUNCTION = "function"
    CLASS = "class"
    CONSTANT = "constant"
    #: what runs whenever the module is imported
    MODULE = "module"
    #: what stands under ``if __name__ == "__main__"``
    MAIN = "main"
    #: a name of another module that this one only passes on
    PASSED = "passed"
    #: a file that cannot be taken apart
    FILE = "file"


@frozen
class Piece:
    """One piece of a file.

    Attributes:
        file: its path relative to the project.
        name: its qualified name in the module; empty for the rest of the module.
        kind: what it is.
        nodes: the statements that it consists of.
        mentions: the names that it mentions.
        is_root: whether it is reached by whoever imports the module, mentioned or not.
        bases: of a class, the last names of its bases.
        methods: of a class, the names of its methods.
        text: of a file that cannot be taken apart, its digest.
    """

    file: str
    name: str
    kind: Kind
    nodes: tuple[ast.AST, ...] = field(default=(), compare=False, hash=False)
    mentions: Mentions = field(default_factory=Mentions, compare=False, hash=False)
    is_root: bool = False
    bases: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    text: str = ""

    @property
    def last(self) -> str:
        """The last part of its name, by which others mention it."""
        return self.name.rpartition(".")[2]

    @property
    def shown(self) -> str:
        """In words: ``place() in sorting.py``."""
        match self.kind:
            case Kind.FUNCTION:
                return f"{self.name}() in {self.file}"
            case Kind.CLASS | Kind.CONSTANT | Kind.PASSED:
                return f"{self.name} in {self.file}"
            case Kind.MODULE:
                return f"module level of {self.file}"
            case Kind.MAIN:
                return f"the main block of {self.file}"
            case Kind.FILE:
                return self.file

    def digest(self, bound: Iterable[tuple[str, tuple[str, ...]]]) -> str:
        """What it says, as a digest.

        Args:
            bound: names in it that stand for something elsewhere, and for what.
        """
        if self.kind is Kind.FILE:
            return self.text
        whole = [ast.dump(node) for node in self.nodes]
        return hashlib.blake2b(repr((whole, sorted(bound))).encode(), digest_size=12).hexdigest()


#: decorators that call what they decorate only where it is mentioned, by the last part of their names
_HARMLESS = {
    "staticmethod", "classmethod", "property", "setter", "getter", "deleter", "cached_property", "cache",
    "lru_cache", "wraps", "contextmanager", "asynccontextmanager", "abstractmethod", "override", "overload",
    "dataclass", "final", "total_ordering", "unique", "runtime_checkable", "no_type_check", "fixture",
}  # fmt: skip
#: functions whose results depend on their arguments only
_PURE = {
    "Path", "PurePath", "PurePosixPath", "frozenset", "tuple", "dict", "list", "set", "range", "float", "int",
    "str", "bool", "bytes", "complex", "round", "abs", "min", "max", "sum", "len", "sorted", "Decimal",
    "Fraction", "timedelta", "TypeVar", "ParamSpec", "radians", "degrees", "sqrt", "getLogger", "re.compile",
    "namedtuple", "MappingProxyType", "NewType",
}  # fmt: skip


@dataclass(slots=True)
class Module:
    """One file, taken apart.

    Attributes:
        file: its path relative to the project.
        pieces: its pieces.
        defined: names that are defined at its module level.
        imports: names that imports bind, anywhere in it, to ``module`` or ``module:name``, with the level
            of relative imports as dots in front.
        stars: modules of which it imports all names.
        modules: all modules that it imports, in order, in the same notation.
    """

    file: str
    pieces: list[Piece] = field(default_factory=list)
    defined: set[str] = field(default_factory=set)
    imports: dict[str, list[str]] = field(default_factory=dict)
    stars: list[str] = field(default_factory=list)
    modules: list[str] = field(default_factory=list)


def pure_classes(tree: ast.Module) -> Iterator[tuple[str, bool]]:
    """The classes of a module, and whether making an object of each does nothing but hold its values."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            own = {one.name for one in node.body if isinstance(one, ast.FunctionDef)}
            makes = own & {"__init__", "__new__", "__post_init__", "__init_subclass__", "__set_name__"}
            is_plain = all(_last(base) in {"NamedTuple", "object", "Generic"} for base in node.bases)
            yield node.name, not makes and is_plain and not node.keywords


def take_apart(file: str, tree: ast.Module, pure: Collection[str], *, is_test: bool) -> Module:
    """The pieces of a file.

    Args:
        file: its path relative to the project.
        tree: what stands in it.
        pure: classes whose objects can be made without any effect.
        is_test: whether it holds tests: making an object at its module level then concerns only whoever
            mentions that.
    """
    module = Module(file)
    _note_imports(module, tree)
    rest: list[ast.AST] = []
    for index, node in enumerate(tree.body):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                module.defined.add(node.name)
                rest += _function(module, node, node.name)
            case ast.ClassDef():
                module.defined.add(node.name)
                rest += _class(module, node, node.name)
            case ast.Import() | ast.ImportFrom():
                continue
            case ast.Expr(value=ast.Constant(value=str())):
                if index == 0:
                    _add(module, "__doc__", Kind.CONSTANT, [node])
            case ast.If() if _is_main(node):
                _add(module, "__main__", Kind.MAIN, [node])
            case _:
                name = _constant(node)
                value = getattr(node, "value", None)
                module.defined.update(_stored(node))
                if name and (value is None or _is_plain(value, pure, any_class=is_test)):
                    _add(module, name, Kind.CONSTANT, [node])
                else:
                    rest.append(node)
    if rest:
        _add(module, "", Kind.MODULE, rest, is_root=True)
    return module


def _add(module: Module, name: str, kind: Kind, nodes: list[ast.AST], *, is_root: bool = False) -> None:
    module.pieces.append(
        Piece(
            module.file,
            name,
            kind,
            tuple(nodes),
            Mentions.of(nodes),
            is_root or name.rpartition(".")[2] in _ROOTS,
        )
    )


#: names that pytest looks for by itself
_ROOTS = {
    "setUp", "tearDown", "setUpClass", "tearDownClass", "setUpModule", "tearDownModule", "asyncSetUp",
    "asyncTearDown", "setup_module", "teardown_module", "setup_function", "teardown_function", "setup_class",
    "teardown_class", "setup_method", "teardown_method", "setup", "teardown", "pytestmark", "pytest_plugins",
    "load_tests", "collect_ignore", "collect_ignore_glob", "__getattr__", "__dir__",
}  # fmt: skip


def _function(module: Module, node: ast.FunctionDef | ast.AsyncFunctionDef, name: str) -> Iterator[ast.AST]:
    """Add a function; yields what of it runs when the module is imported, beyond making the function."""
    is_root = node.name.startswith("pytest_") or any(_is_autouse(one) for one in node.decorator_list)
    registered = [one for one in node.decorator_list if not _is_harmless(one)]
    _add(module, name, Kind.FUNCTION, [node], is_root=is_root or bool(registered))
    yield from registered
    defaults = [*node.args.defaults, *(one for one in node.args.kw_defaults if one is not None)]
    yield from (one for one in defaults if not _is_plain(one, ()))


def _class(module: Module, node: ast.ClassDef, name: str) -> Iterator[ast.AST]:
    """Add a class and its methods; yields what of them runs at import beyond making the class."""
    methods, own = [], []
    loud: list[ast.AST] = [one for one in node.decorator_list if not _is_harmless(one)]
    for one in node.body:
        match one:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                methods.append(one.name)
                loud += _function(module, one, f"{name}.{one.name}")
            case ast.ClassDef():
                loud += _class(module, one, f"{name}.{one.name}")
            case _:
                own.append(one)
                loud += [] if _is_quiet(one) else [one]
    header = copy.copy(node)
    header.body = own or [ast.Pass()]
    module.pieces.append(
        Piece(
            module.file, name, Kind.CLASS, (header,), Mentions.of([header]),
            is_root=bool(node.keywords or loud), bases=tuple(_last(base) for base in node.bases),
            methods=tuple(methods),
        )
    )  # fmt: skip
    yield from loud


def _is_quiet(node: ast.stmt) -> bool:
    """Whether a statement of a class body only gives a name to a plain value."""
    match node:
        case ast.Pass() | ast.Expr(value=ast.Constant()):
            return True
        case ast.AnnAssign(value=None):
            return True
        case ast.Assign(value=value) | ast.AnnAssign(value=ast.expr() as value):
            return _is_plain(value, ()) or _is_field(value)
    return False


def _is_field(value: ast.expr) -> bool:
    return isinstance(value, ast.Call) and _last(value.func) == "field"


def _constant(node: ast.stmt) -> str:
    """The one name that a statement gives a value to; empty if it does anything else."""
    match node:
        case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
            return name
    return ""


def _stored(node: ast.AST) -> set[str]:
    return {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}


def _is_plain(value: ast.expr, pure: Collection[str], *, any_class: bool = False) -> bool:
    """Whether an expression only makes a value."""
    match value:
        case ast.Constant() | ast.Name() | ast.Attribute():
            return True
        case ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.Set(elts=parts):
            return _are_plain(parts, pure, any_class)
        case ast.Dict(keys=keys, values=values):
            return _are_plain([*(one for one in keys if one is not None), *values], pure, any_class)
        case ast.BinOp(left=left, right=right):
            return _are_plain([left, right], pure, any_class)
        case ast.UnaryOp(operand=operand) | ast.Starred(value=operand):
            return _is_plain(operand, pure, any_class=any_class)
        case ast.Subscript(value=whole, slice=part):
            return _are_plain([whole, part], pure, any_class)
        case ast.Call(func=function, args=parts, keywords=keywords):
            name = _last(function)
            is_known = name in pure or name in _PURE or ast.unparse(function) in _PURE
            is_class = any_class and name[:1].isupper()
            arguments = [*parts, *(one.value for one in keywords)]
            return (is_known or is_class) and _are_plain(arguments, pure, any_class)
    return False


def _are_plain(values: Iterable[ast.expr], pure: Collection[str], any_class: bool) -> bool:
    return all(_is_plain(one, pure, any_class=any_class) for one in values)


def _is_harmless(decorator: ast.expr) -> bool:
    function = decorator.func if isinstance(decorator, ast.Call) else decorator
    words = ast.unparse(function).split(".")
    return words[-1] in _HARMLESS or words[:2] == ["pytest", "mark"] or words[0] == "mark"


def _is_autouse(decorator: ast.expr) -> bool:
    return isinstance(decorator, ast.Call) and any(one.arg in ("autouse", None) for one in decorator.keywords)


def _is_main(node: ast.If) -> bool:
    return "__main__" in {one.value for one in ast.walk(node.test) if isinstance(one, ast.Constant)}


def _last(node: ast.expr) -> str:
    """The last name of ``a.b.C[…]`` or of a call of it."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
        case ast.Subscript(value=inner) | ast.Call(func=inner):
            return _last(inner)
    return ""


def _note_imports(module: Module, tree: ast.Module) -> None:
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                for one in names:
                    module.modules.append(one.name)
                    bound = one.asname or one.name.partition(".")[0]
                    target = one.name if one.asname else bound
                    module.imports.setdefault(bound, []).append(target)
            case ast.ImportFrom(module=name, names=names, level=level):
                origin = "." * level + (name or "")
                module.modules.append(origin)
                for one in names:
                    if one.name == "*":
                        module.stars.append(origin)
                    else:
                        module.imports.setdefault(one.asname or one.name, []).append(f"{origin}:{one.name}")
