"""What an expression is: an object of which class, a function, a module. Told from the text alone."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from .sources import Definition, Function, Module, Sources

_DEPTH = 12
#: generic types of which the first argument is what the code handles
_WRAPPERS = frozenset(
    {"Optional", "Iterator", "Iterable", "Generator", "AsyncIterator", "Annotated", "Final"}
)


@dataclass(frozen=True)
class Instance:
    """An object of a class."""

    type: Definition


Value = Instance | Definition | Module | None


class Resolver:
    """Tells what expressions are, as far as the text shows it."""

    def __init__(self, sources: Sources, known_classes: Mapping[str, Definition]) -> None:
        self.sources, self._known = sources, known_classes

    def scope(self, module: Module, function: Function | None, owner: Definition | None) -> Scope:
        """The names of a function, or of the module's top level."""
        return Scope(self, module, function, owner)

    def member(self, of: Definition, name: str, depth: int = _DEPTH) -> Value:
        """A method (as Definition) or attribute of an object of a class, bases included."""
        assert isinstance(of.node, ast.ClassDef)
        if depth == 0:
            return None
        for statement in of.node.body:
            if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef) and statement.name == name:
                return Definition(of.module, f"{of.qualname}.{name}", statement, of)
            if isinstance(statement, ast.AnnAssign) and _is_name(statement.target, name):
                return self.annotated(statement.annotation, of.module)
        return self._assigned_attribute(of, name, depth) or self._inherited(of, name, depth)

    def annotated(self, annotation: ast.expr | None, module: Module) -> Value:
        """The object that an annotation promises."""
        match annotation:
            case ast.Constant(value=str(text)):
                try:
                    return self.annotated(ast.parse(text, mode="eval").body, module)
                except SyntaxError:
                    return None
            case ast.BinOp(left=left, op=ast.BitOr(), right=right):
                return self.annotated(left, module) or self.annotated(right, module)
            case ast.Subscript(value=outer, slice=inner) if _last_name(outer) in _WRAPPERS:
                first = inner.elts[0] if isinstance(inner, ast.Tuple) and inner.elts else inner
                return self.annotated(first, module)
            case ast.Name() | ast.Attribute():
                found = self.scope(module, None, None).value(annotation)
                return Instance(found) if isinstance(found, Definition) and _is_class(found) else None
        return None

    def of_name(self, name: str) -> Value:
        """An object whose variable is named like exactly one known class."""
        folded = name.replace("_", "").casefold()
        exact = [one for key, one in self._known.items() if key.casefold() == folded]
        ending = [one for key, one in self._known.items() if key.casefold().endswith(folded)]
        found = exact or ending
        return Instance(found[0]) if len(found) == 1 and len(folded) > 2 else None

    def of_method(self, name: str) -> Value:
        """The method, if exactly one known class has one of that name."""
        found = [self.member(one, name, 2) for one in self._known.values()]
        methods = {one.target: one for one in found if isinstance(one, Definition)}
        return next(iter(methods.values())) if len(methods) == 1 else None

    def _assigned_attribute(self, of: Definition, name: str, depth: int) -> Value:
        assert isinstance(of.node, ast.ClassDef)
        for method in _functions(of.node):
            for target, value in _assignments(method):
                if (
                    isinstance(target, ast.Attribute)
                    and target.attr == name
                    and _is_name(target.value, "self")
                ):
                    found = self.scope(of.module, method, of).value(value, depth - 1)
                    if found is not None:
                        return found
        return None

    def _inherited(self, of: Definition, name: str, depth: int) -> Value:
        assert isinstance(of.node, ast.ClassDef)
        scope = self.scope(of.module, None, None)
        for base in of.node.bases:
            parent = scope.value(base, depth - 1)
            if isinstance(parent, Definition) and _is_class(parent):
                found = self.member(parent, name, depth - 1)
                if found is not None:
                    return found
        return None


class Scope:
    """The names that a function or the top level of a module can use."""

    def __init__(
        self, resolver: Resolver, module: Module, function: Function | None, owner: Definition | None
    ) -> None:
        self._resolver, self._module, self._owner = resolver, module, owner
        self._function = function
        self._assigned: dict[str, ast.expr] = {}
        self._annotations: dict[str, ast.expr] = {}
        self._parameters: set[str] = set()
        self._read(module.tree, whole=False)
        if function is not None:
            self._read_parameters(function)
            self._read(function, whole=True)

    def value(self, node: ast.expr, depth: int = _DEPTH) -> Value:
        """What an expression is, or None."""
        if depth == 0:
            return None
        match node:
            case ast.Name(id=name):
                return self._named(name, depth)
            case ast.Await(value=inner):
                return self.value(inner, depth)
            case ast.Attribute(value=base, attr=name):
                return self._attribute(self.value(base, depth - 1), name, depth)
            case ast.Call(func=callee):
                return self._called(self.value(callee, depth - 1))
        return None

    def method_by_name(self, node: ast.Attribute) -> Value:
        """The method that ``x.name`` means if ``x`` is not known, but only one class has that method."""
        known = self.value(node.value) is not None or isinstance(node.value, ast.Constant)
        return None if known else self._resolver.of_method(node.attr)

    def _named(self, name: str, depth: int) -> Value:
        if name == "self" and self._owner is not None:
            return Instance(self._owner)
        if name in self._annotations:
            return self._resolver.annotated(self._annotations[name], self._module)
        if name in self._assigned:
            return self.value(self._assigned[name], depth - 1)
        if name in self._parameters:
            return self._resolver.of_name(name)
        return self._resolver.sources.lookup(self._module, name)

    def _attribute(self, base: Value, name: str, depth: int) -> Value:
        if isinstance(base, Module):
            found = self._resolver.sources.lookup(base, name)
            return found or self._resolver.sources.module(f"{base.name}.{name}")
        if isinstance(base, Instance):
            member = self._resolver.member(base.type, name, depth - 1)
            if isinstance(member, Definition) and is_property(member):
                return self._resolver.annotated(_returns(member), member.module) or member
            return member
        if isinstance(base, Definition) and _is_class(base):
            return self._resolver.member(base, name, depth - 1)
        return None

    def _called(self, callee: Value) -> Value:
        if not isinstance(callee, Definition):
            return None
        if _is_class(callee):
            return Instance(callee)
        return self._resolver.annotated(_returns(callee), callee.module)

    def _read_parameters(self, function: Function) -> None:
        for argument in (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs):
            self._forget(argument.arg)
            self._parameters.add(argument.arg)
            if argument.annotation is not None:
                self._annotations[argument.arg] = argument.annotation

    def _read(self, node: ast.AST, *, whole: bool) -> None:
        for target, value in _assignments(node) if whole else _top_assignments(node):
            if isinstance(target, ast.Name):
                self._forget(target.id)
                self._assigned[target.id] = value
        for part in ast.walk(node) if whole else ast.iter_child_nodes(node):
            if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name):
                self._annotations[part.target.id] = part.annotation

    def _forget(self, name: str) -> None:
        self._assigned.pop(name, None)
        self._annotations.pop(name, None)


def is_property(definition: Definition) -> bool:
    """Whether a method is read like an attribute."""
    names = {_last_name(decorator) for decorator in definition.node.decorator_list}
    return bool(names & {"property", "cached_property"})


def _is_class(value: object) -> bool:
    return isinstance(value, Definition) and isinstance(value.node, ast.ClassDef)


def _returns(definition: Definition) -> ast.expr | None:
    return None if isinstance(definition.node, ast.ClassDef) else definition.node.returns


def _functions(node: ast.ClassDef) -> Iterator[Function]:
    return (one for one in node.body if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef))


def _assignments(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    for part in ast.walk(node):
        yield from _assigned_by(part)


def _top_assignments(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    for part in ast.iter_child_nodes(node):
        yield from _assigned_by(part)


def _assigned_by(part: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    if isinstance(part, ast.Assign):
        yield from ((target, part.value) for target in part.targets)
    elif isinstance(part, ast.AnnAssign | ast.NamedExpr) and part.value is not None:
        yield part.target, part.value
    elif isinstance(part, ast.With | ast.AsyncWith):
        for item in part.items:
            if item.optional_vars is not None:
                yield item.optional_vars, item.context_expr


def _is_name(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _last_name(node: ast.expr) -> str:
    if isinstance(node, ast.Call):
        return _last_name(node.func)
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")
