"""An import hook: what a function returns is of the type that it says."""

import ast
import builtins
import importlib.abc
import importlib.machinery
import sys


def check(value, kind):
    if type(value) is not getattr(builtins, kind):
        raise TypeError(f"no {kind}: {value!r}")
    return value


class Checks(ast.NodeTransformer):
    def visit_FunctionDef(self, node):
        for one in ast.walk(node):
            if isinstance(one, ast.Return) and isinstance(node.returns, ast.Name):
                one.value = ast.Call(ast.Name("check"), [one.value, ast.Constant(node.returns.id)], [])
                one.value.func.ctx = ast.Load()
        return node


class Loader(importlib.machinery.SourceFileLoader):
    def source_to_code(self, data, path, *, _optimize=-1):
        tree = Checks().visit(ast.parse(data, path))
        tree.body.insert(0, ast.parse("from checked import check").body[0])
        return compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)


class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name != "gait.walk":
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        spec.loader = Loader(spec.loader.name, spec.loader.path)
        return spec


def install():
    sys.meta_path.insert(0, Finder())
