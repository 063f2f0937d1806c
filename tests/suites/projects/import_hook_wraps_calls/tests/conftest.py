"""Compiles the program so that each of its calls is counted."""

import ast
import importlib.machinery
import sys

import counts


class Counting(ast.NodeTransformer):
    def visit_Call(self, node):
        self.generic_visit(node)
        made = ast.Call(ast.Name("__counted__", ast.Load()), [node.func, *node.args], node.keywords)
        return ast.copy_location(made, node)


class Loader(importlib.machinery.SourceFileLoader):
    def source_to_code(self, data, path, *, _optimize=-1):
        tree = Counting().visit(ast.parse(data))
        return compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)

    def exec_module(self, module):
        module.__counted__ = counts.counted
        super().exec_module(module)


class Finder:
    def find_spec(self, name, path=None, target=None):
        if name != "mission":
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path)
        spec.loader = Loader(name, spec.origin)
        return spec


sys.meta_path.insert(0, Finder())
