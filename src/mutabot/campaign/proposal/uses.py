"""Which callables of other modules a piece of code uses, and with which constants."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from .resolve import Instance, Resolver, Scope, is_property
from .sources import Definition, Function, Module


@dataclass
class Use:
    """A callable that the code uses.

    Attributes:
        definition: the callable.
        constants: per argument, the constants it is called with, in the order they occur.
        compared: constants its result is compared with.
        certain: whether the text shows that it is this one, or only the names suggest it.
    """

    definition: Definition
    constants: dict[str, list[Any]] = field(default_factory=dict)
    compared: list[Any] = field(default_factory=list)
    certain: bool = True


class Uses:
    """What some modules use of all others."""

    def __init__(self, resolver: Resolver, modules: Sequence[Module]) -> None:
        self.found: dict[str, Use] = {}
        self.by_module: dict[str, set[str]] = {}
        self._resolver = resolver
        self._own = {module.name for module in modules}
        for module in modules:
            self._read(module)

    def _read(self, module: Module) -> None:
        for function, owner, nodes in _pieces(module):
            scope = self._resolver.scope(module, function, owner)
            names: dict[str, str] = {}
            for node in nodes:
                self._read_node(module, scope, node, names)
            for node in nodes:
                if isinstance(node, ast.Compare):
                    self._read_comparison(module, scope, node, names)

    def _read_node(self, module: Module, scope: Scope, node: ast.AST, names: dict[str, str]) -> None:
        if isinstance(node, ast.Call):
            self._read_call(module, scope, node)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            self._read_property(module, scope, node)
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            callee = self._callee(scope, node.value)
            if callee is not None:
                names[node.targets[0].id] = callee.target

    def _read_call(self, module: Module, scope: Scope, call: ast.Call) -> None:
        definition, certain = scope.value(call.func), True
        if definition is None and isinstance(call.func, ast.Attribute):
            definition, certain = scope.method_by_name(call.func), False
        if not isinstance(definition, Definition) or isinstance(definition.node, ast.ClassDef):
            return
        use = self._use(module, definition, certain)
        if use is None:
            return
        for name, value in _bound(definition, call):
            constant = _constant(value, module, self._resolver)
            if constant is not None and constant not in use.constants.setdefault(name, []):
                use.constants[name].append(constant)

    def _read_property(self, module: Module, scope: Scope, node: ast.Attribute) -> None:
        base = scope.value(node.value)
        if isinstance(base, Instance):
            member = self._resolver.member(base.type, node.attr)
            if isinstance(member, Definition) and is_property(member):
                self._use(module, member, True)

    def _read_comparison(
        self, module: Module, scope: Scope, node: ast.Compare, names: dict[str, str]
    ) -> None:
        sides = [node.left, *node.comparators]
        for side in sides:
            callee = self._callee(scope, side)
            target = names.get(side.id) if isinstance(side, ast.Name) else callee and callee.target
            if target in self.found:
                compared = self.found[target].compared
                others = (_constants_in(other, module, self._resolver) for other in sides)
                compared += [value for values in others for value in values if value not in compared]

    def _callee(self, scope: Scope, node: ast.expr) -> Definition | None:
        if isinstance(node, ast.Await):
            return self._callee(scope, node.value)
        if not isinstance(node, ast.Call):
            return None
        found = scope.value(node.func)
        if found is None and isinstance(node.func, ast.Attribute):
            found = scope.method_by_name(node.func)
        return found if isinstance(found, Definition) else None

    def _use(self, module: Module, definition: Definition, certain: bool) -> Use | None:
        if definition.module.name in self._own or definition.node.name.startswith("_"):
            return None
        use = self.found.setdefault(definition.target, Use(definition, certain=certain))
        use.certain = use.certain or certain
        self.by_module.setdefault(module.name, set()).add(definition.target)
        return use


def parameters(definition: Definition) -> list[ast.arg]:
    """The parameters of a callable without ``self`` and ``cls``."""
    node = definition.node
    assert not isinstance(node, ast.ClassDef)
    plain = [*node.args.posonlyargs, *node.args.args]
    static = any(isinstance(one, ast.Name) and one.id == "staticmethod" for one in node.decorator_list)
    return [*(plain[1:] if definition.owner is not None and not static else plain), *node.args.kwonlyargs]


def _pieces(module: Module) -> Iterator[tuple[Function | None, Definition | None, list[ast.AST]]]:
    """Each function with the nodes of its own, and the top level."""
    yield None, None, list(_own_nodes(module.tree))
    owners: list[tuple[ast.AST, Definition | None]] = [(module.tree, None)]
    while owners:
        parent, owner = owners.pop(0)
        for node in _own_nodes(parent):
            if isinstance(node, ast.ClassDef):
                owners.append((node, Definition(module, node.name, node)))
                yield None, owners[-1][1], list(_own_nodes(node))
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                owners.append((node, owner))
                yield node, owner, list(_own_nodes(node))


def _own_nodes(parent: ast.AST) -> Iterator[ast.AST]:
    """Nodes below ``parent``, without going into the functions and classes it holds."""
    for node in ast.iter_child_nodes(parent):
        yield node
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield from _own_nodes(node)


def _bound(definition: Definition, call: ast.Call) -> Iterator[tuple[str, ast.expr]]:
    names = [one.arg for one in parameters(definition)]
    yield from zip(names, (one for one in call.args if not isinstance(one, ast.Starred)), strict=False)
    yield from ((one.arg, one.value) for one in call.keywords if one.arg is not None)


def _constant(node: ast.expr, module: Module, resolver: Resolver) -> Any:
    """The value of a constant, a named constant, or an f-string as a notation; else None."""
    match node:
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int(value) | float(value))):
            return -value
        case ast.Constant(value=value):
            return value if isinstance(value, str | int | float) else None
        case ast.JoinedStr(values=parts):
            return _notation(parts)
        case ast.Name(id=name):
            return _named_constant(module, name, resolver)
        case ast.Attribute(value=ast.Name(id=base), attr=name):
            other = resolver.sources.lookup(module, base)
            return _named_constant(other, name, resolver) if isinstance(other, Module) else None
    return None


def _constants_in(node: ast.expr, module: Module, resolver: Resolver) -> list[Any]:
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    found = (_constant(part, module, resolver) for part in parts)
    return [value for value in found if value is not None]


def _named_constant(module: Module, name: str, resolver: Resolver, depth: int = 4) -> Any:
    for statement in module.tree.body:
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if isinstance(statement, ast.AnnAssign):
            target = statement.target
        value = getattr(statement, "value", None)
        if isinstance(target, ast.Name) and target.id == name and isinstance(value, ast.Constant):
            return value.value if isinstance(value.value, str | int | float) else None
    if name in module.imports and depth:
        source, inner = module.imports[name]
        other = resolver.sources.module(source)
        return _named_constant(other, inner, resolver, depth - 1) if other is not None and inner else None
    return None


def _notation(parts: Sequence[ast.expr]) -> str | None:
    texts = []
    for part in parts:
        if isinstance(part, ast.Constant):
            texts.append(str(part.value).replace("{", "{{").replace("}", "}}"))
        elif isinstance(part, ast.FormattedValue):
            name = part.value.id if isinstance(part.value, ast.Name) else f"value{len(texts)}"
            texts.append(f"{{{name}:g}}")
    return "".join(texts)
