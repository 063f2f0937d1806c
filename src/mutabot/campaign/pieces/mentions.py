"""Mentions: the names by which a piece of program text may get at others, and whether names alone tell."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

#: text that consists of names: ``"holding"``, ``"robot:Arm.move_by"``, ``"mission.left"``
_NAMES = re.compile(r"[\w.:\[\]-]{1,200}")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
#: what a format string asks of its arguments
_FIELD = re.compile(r"\{([^{}!:]*)")
#: by these anything can be reached whose name stands nowhere
_ANY_NAME = {
    "__import__", "import_module", "reload",
    "getmembers", "iter_modules", "walk_packages", "__subclasses__", "__getattribute__", "__dict__",
    "get_type_hints", "run_path", "run_module", "resolve_name", "find_loader", "find_spec",
}  # fmt: skip
_ANY_BUILTIN = {"eval", "exec", "compile", "globals", "locals", "vars", "dir"}
#: these do so where the name is computed: the position of the name among the arguments
_COMPUTED = {
    "getattr": 1, "setattr": 1, "delattr": 1, "hasattr": 1, "attrgetter": 0, "methodcaller": 0,
    "getfixturevalue": 0, "importorskip": 0,
}  # fmt: skip
#: by these the text itself and its lines can be seen
_TEXT = {
    "getsource", "getsourcelines", "getsourcefile", "findsource", "f_lineno", "tb_lineno", "co_firstlineno",
    "lineno", "linecache", "tokenize", "getframeinfo", "extract_stack", "format_stack", "print_stack",
}  # fmt: skip
_READS = {"open", "read_text", "read_bytes", "readlines", "parse", "hash_file"}
#: by these other processes begin, which run what stands under ``if __name__ == "__main__"``
STARTS = {
    "subprocess", "Popen", "system", "popen", "runpy", "run_path", "run_module", "multiprocessing", "Process",
    "ProcessPoolExecutor", "create_subprocess_exec", "create_subprocess_shell", "posix_spawn", "execv",
    "execve", "execvp", "LaunchDescription", "ROSLaunchParent", "__main__",
}  # fmt: skip


@dataclass(slots=True)
class Mentions:
    """What a piece of text mentions.

    Attributes:
        names: identifiers of every kind, also those in strings that consist of names.
        dotted: attributes of names, as far as they go: ``robot.Arm.move_by``.
        bare: names that are not only asked for an attribute.
        words: identifiers in strings that consist of names.
        any: whether it may reach what it does not mention.
        text: whether it may read program text or its line numbers.
    """

    names: set[str] = field(default_factory=set)
    dotted: set[str] = field(default_factory=set)
    bare: set[str] = field(default_factory=set)
    words: set[str] = field(default_factory=set)
    any: bool = False
    text: bool = False

    @classmethod
    def of(cls, nodes: Iterable[ast.AST]) -> Mentions:
        """Those of some nodes and all below them."""
        found = cls()
        files = False
        for node in nodes:
            owners = {id(one.value) for one in ast.walk(node) if isinstance(one, ast.Attribute)}
            for one in ast.walk(node):
                files = _take(found, one) or files
                if isinstance(one, ast.Name) and id(one) not in owners:
                    found.bare.add(one.id)
        found.any = found.any or not _ANY_NAME.isdisjoint(found.names)
        found.text = not _TEXT.isdisjoint(found.names) or (files and not _READS.isdisjoint(found.names))
        return found


def names_in(text: str) -> set[str]:
    """The identifiers in a text."""
    return set(_IDENTIFIER.findall(text))


def _take(found: Mentions, node: ast.AST) -> bool:
    """Note what one node mentions; returns whether it names a Python file."""
    match node:
        case ast.Attribute(attr=name):
            found.names.add(name)
            dotted = _dotted(node)
            if dotted:
                found.dotted.add(dotted)
        case ast.Name(id=name) | ast.arg(arg=name):
            found.names.add(name)
        case ast.keyword(arg=str(name)):
            found.names.add(name)
        case ast.alias(name=name):
            found.names.update(names_in(name))
        case ast.ImportFrom(module=str(name)):
            found.names.update(names_in(name))
        case ast.MatchClass(kwd_attrs=names):
            found.names.update(names)
        case ast.Constant(value=str(text)):
            return _take_text(found, text)
        case ast.Call():
            _take_call(found, node)
    return False


def _dotted(node: ast.expr) -> str:
    """``a.b.c`` if that is all it is."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return f"{before}.{node.attr}" if before else ""
    return ""


def _take_text(found: Mentions, text: str) -> bool:
    if _NAMES.fullmatch(text):
        found.words.update(names_in(text))
        found.names.update(names_in(text))
    elif "{" in text:
        found.names.update(name for part in _FIELD.findall(text) for name in names_in(part))
    return text.endswith((".py", "__file__"))


def _take_call(found: Mentions, call: ast.Call) -> None:
    name = getattr(call.func, "id", getattr(call.func, "attr", ""))
    if isinstance(call.func, ast.Name) and name in _ANY_BUILTIN:
        found.any = True
    position = _COMPUTED.get(name)
    if position is None:
        return
    given = call.args[position] if len(call.args) > position else None
    if not (isinstance(given, ast.Constant) and isinstance(given.value, str)):
        found.any = True
