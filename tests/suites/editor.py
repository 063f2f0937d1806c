"""Mutants as edits of the source text, from the documented meaning of each operator, without Mutabot.

Of a mutant only its facts are taken: where it stands, which operation and quantity, which operator. What it
does is written here a second time, as a change of the text that a person could have made by hand.
"""

from __future__ import annotations

import ast
import math
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .graded_editor import CannotSayError
from .graded_editor import edit as graded_edit

ROOT = Path(__file__).resolve().parents[2]
#: what the judge must know of the examples; a project of the corpus brings its own ``judge.toml``
EXAMPLES = Path(__file__).resolve().parent / "examples"
SHIPPED = (ROOT / "src" / "mutabot" / "vocabulary" / "shipped", ROOT / "src" / "mutabot_cell")
PLANTED = '__import__("_planted")'
DEVIATIONS = {"position": (0.02, "m"), "distance": (0.02, "m"), "orientation": (0.05, "rad"),
              "angle": (0.05, "rad")}  # fmt: skip
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "rad": 1.0, "deg": math.pi / 180}
#: what can be evaluated twice, or not at all; an attribute may be a property
_PURE = (ast.Constant, ast.Name, ast.UnaryOp, ast.BinOp, ast.Tuple, ast.List, ast.keyword, ast.operator,
         ast.unaryop, ast.expr_context, ast.Dict)  # fmt: skip


class CannotWriteError(Exception):
    """This editor knows no edit of the text for the mutant; the message says why."""


@dataclass(frozen=True)
class Edit:
    """One replacement in one file: ``text`` for the bytes from ``start`` to ``end``."""

    file: str
    start: int
    end: int
    text: str

    def applied(self, source: bytes) -> bytes:
        """The source with the edit in it."""
        return source[: self.start] + self.text.encode() + source[self.end :]


@dataclass
class Facts:
    """What a project says about its robot API: the vocabulary, read as plain data."""

    folder: Path
    settings: dict[str, Any]
    vocabulary: list[dict[str, Any]]
    hints: dict[str, Any]

    @classmethod
    def of(cls, folder: Path) -> Facts:
        """Read configuration, vocabularies, and what the judge must know beside them."""
        own = folder / "mutabot.toml"
        settings = _toml(own) if own.exists() else _toml(folder / "pyproject.toml")["tool"]["mutabot"]
        files = [folder / name for name in settings.get("vocabulary", ())]
        files = [file if file.is_file() else _shipped(file.name) for file in files]
        hints = folder / "judge.toml"
        hints = hints if hints.exists() else EXAMPLES / f"{folder.name}.toml"
        return cls(folder, settings, [_toml(file) for file in files], _toml(hints) if hints.exists() else {})

    @property
    def refusals(self) -> list[str]:
        """Names of the exceptions by which the robot refuses."""
        found = [name for file in self.vocabulary for name in file.get("refusals", [])]
        return found + [name for operation in self.operations for name in operation.get("refusals", [])]

    @property
    def operations(self) -> list[dict[str, Any]]:
        """All operations of all files."""
        return [operation for file in self.vocabulary for operation in file.get("operation", [])]

    def operation(self, target: str) -> dict[str, Any]:
        """The operation of this name."""
        for operation in self.operations:
            if operation.get("call") == target or f"*:*.{operation.get('method')}" == target:
                return operation
        raise CannotWriteError(f"no operation {target}")

    def definition(self, target: str) -> ast.FunctionDef | ast.AsyncFunctionDef | None:
        """Where the operation is defined, if that is a file that can be found."""
        module, _, name = target.partition(":")
        path = module.replace(".", "/")
        for file in (self.folder / f"{path}.py", self.folder / path / "__init__.py",
                     self.folder / "tests" / f"{path}.py", ROOT / "src" / f"{path}.py"):  # fmt: skip
            if file.is_file():
                return _definition(ast.parse(file.read_bytes()), name.split("."))
        return None


def _shipped(name: str) -> Path:
    return next(file for folder in SHIPPED if (file := folder / f"{name}.toml").is_file())


def _toml(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def _definition(tree: Any, names: list[str]) -> Any:
    for node in tree.body:
        if getattr(node, "name", None) == names[0]:
            return node if len(names) == 1 else _definition(node, names[1:])
    return None


def edits_for(facts: Facts, mutant: Mapping[str, Any]) -> list[Edit]:
    """The edits that make the mutant.

    Raises CannotWriteError where this editor knows none.
    """
    source = Source(facts.folder / mutant["file"], mutant["file"])
    if mutant["family"] in ("conventional", "text", "bugs"):
        return [text_edit(source, mutant)]
    if mutant["family"] not in ("robot", "graded"):
        raise CannotWriteError(f"family {mutant['family']}")
    return [CallEditor(facts, source, mutant).edit()]


class Source:
    """A file with its syntax tree."""

    def __init__(self, path: Path, name: str) -> None:
        self.name = name
        self.bytes = path.read_bytes()
        self.tree = ast.parse(self.bytes)
        self._starts = [0]
        for line in self.bytes.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self.parents = {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}

    def offset(self, line: int, column: int) -> int:
        """Bytes before a 1-based line and 0-based column."""
        return self._starts[line - 1] + column

    def range(self, node: Any) -> tuple[int, int]:
        """First byte of a node, and the one after its last."""
        return (
            self.offset(node.lineno, node.col_offset),
            self.offset(node.end_lineno, node.end_col_offset),
        )

    def text(self, node: ast.AST) -> str:
        """The source of a node."""
        start, end = self.range(node)
        return self.bytes[start:end].decode()

    def nodes(self, kind: Any) -> Iterator[Any]:
        """All nodes of a kind."""
        return (node for node in ast.walk(self.tree) if isinstance(node, kind))

    def call_ending(self, line: int, column: int, name: str | None = None) -> ast.Call:
        """The call whose closing parenthesis stands there: a chain of calls may start anywhere.

        Or one without a place, of what is read there, if it has this name.
        """
        for node in self.nodes(ast.Call):
            if (node.end_lineno, node.end_col_offset) == (line, column):
                return node  # type: ignore[no-any-return]
        for node in self.nodes(ast.For):  # the call whose items are fetched one by one
            if (node.end_lineno, node.end_col_offset) == (line, column) and isinstance(node.iter, ast.Call):
                return node.iter
        for node in self.nodes(ast.Attribute | ast.Name):
            if (node.end_lineno, node.end_col_offset) == (line, column) and _last_name(node) == name:
                return ast.Call(node, [], [])
        raise CannotWriteError("no call ends there")


class CallEditor:
    """Writes the edit of one mutant of a call."""

    def __init__(self, facts: Facts, source: Source, mutant: Mapping[str, Any]) -> None:
        self.facts, self.source, self.mutant = facts, source, mutant
        self._called = mutant["operation"].rpartition(":")[2].rpartition(".")[2]
        span = mutant["span"]
        self.call = source.call_ending(span["end_line"], span["end_column"] - 1, self._called)
        if _last_name(self.call.func) in ("exec", "eval"):
            raise CannotWriteError("the call stands in a text that is run")
        self.operation = facts.operation(mutant["operation"])
        handed = self._handed()
        self.callee = handed or self.call.func
        self.is_handed = handed is not None or not hasattr(self.call, "lineno")
        parent = source.parents.get(self.call)
        if isinstance(parent, ast.withitem) and handed is None and _last_name(self.call.func) != self._called:
            raise CannotWriteError("the block may call the operation as it ends")
        self.awaited = parent if isinstance(parent, ast.Await) else None
        self.definition = facts.definition(mutant["operation"])
        self.is_async = isinstance(self.definition, ast.AsyncFunctionDef)
        self.pattern = next(
            (
                pattern
                for pattern in self.operation.get("patterns", [])
                if pattern["text"] == mutant["pattern"]
            ),
            None,
        )
        if mutant["pattern"] is not None and self.pattern is None:
            raise CannotWriteError("an unknown pattern")
        meant = facts.hints.get("meant", {})
        #: whether a call of one thing or another is one of this operation, as the text of an expression
        self.meant = next((meant[site] for site in meant if mutant["id"].startswith(f"{site}:")), None)

    def edit(self) -> Edit:
        """The edit."""
        if self.mutant.get("moment") is not None:
            raise CannotWriteError("a moment")
        if self.mutant["family"] == "graded":
            try:
                return graded_edit(self, self.mutant)
            except CannotSayError as error:
                raise CannotWriteError(str(error)) from error
        method = getattr(self, "_" + self.mutant["operator"].replace("-", "_"), None)
        if method is None:
            raise CannotWriteError(f"operator {self.mutant['operator']}")
        return method()  # type: ignore[no-any-return]

    # the operators

    def _skip(self) -> Edit:
        answer = self._idle()
        if self.pattern is None and answer.isidentifier() and answer != "self" and self._is_simple():
            return self._replace(self.whole, answer)
        planted = f"{PLANTED}.skipped({self._callee()}, lambda self: {answer})"
        return self._with_callee(planted)

    def _repeat(self) -> Edit:
        if self.pattern is None and self._is_simple():
            text = self.source.text(self.whole)
            return self._replace(self.whole, f"({text}, {text})[1]")
        return self._with_callee(f"{PLANTED}.twice({self._callee()})")

    def _reverse(self) -> Edit:
        quantity = self._quantity()
        if quantity["kind"] == "quaternion":  # the inverse rotation
            return self._argument(f"{PLANTED}.partial({PLANTED}.conjugate, {quantity['order']!r})")
        if quantity["kind"] == "euler":
            raise CannotWriteError("the inverse of Euler angles")
        limits = quantity.get("range")
        if limits is None:
            return self._argument(f"{PLANTED}.negative", minus=True)
        turn = 0.0
        if quantity["kind"] == "rotation":
            full = 360.0 if quantity["unit"] == "deg" else 2 * math.pi
            turn = full if abs(limits[1] - limits[0] - full) < 1e-6 * full else 0.0
        return self._argument(
            f"{PLANTED}.partial({PLANTED}.negative_within, {limits[0]}, {limits[1]}, {turn:g})"
        )

    def _by_to(self) -> Edit:
        quantity = self._quantity()
        if quantity.get("range") is not None or self.pattern is not None:
            raise CannotWriteError("by-to with a range or in a text command")
        current = self._current()
        if quantity["mode"] == "by":
            return self._argument(f"(lambda value: value - {current} if value else value)")
        return self._argument(f"(lambda value: value + {current})")

    def _opposite(self) -> Edit:
        if self.mutant["quantity"] is not None:
            quantity = self._quantity()
            first, second = quantity.get("values") or quantity["range"]
            return self._argument(f"{PLANTED}.partial({PLANTED}.other, { {first: second, second: first}!r})")
        if self.pattern is not None:
            message = self._given(self.operation["message"])
            told = f"{PLANTED}.told_as({self.pattern['text']!r}, {self.pattern['opposite']!r}"
            return self._replace(message, f"{told}, {self.source.text(message)})")
        name = self.operation["opposite"].rpartition(":")[2].rpartition(".")[2]
        start, end = self.source.range(self.call.func)
        if isinstance(self.call.func, ast.Attribute):
            start = end - len(self.call.func.attr.encode())
        return Edit(self.source.name, start, end, name)

    def _negate(self) -> Edit:
        return self._result(f"{PLANTED}.negative", minus=True)

    def _misread(self) -> Edit:
        quantity = self._quantity()
        values = quantity.get("values") or [False, True]
        shift = int(self.mutant["variant"] or "1")
        pairs = {value: values[(index + shift) % len(values)] for index, value in enumerate(values)}
        return self._result(f"{PLANTED}.partial({PLANTED}.other, {pairs!r})")

    def _noise(self) -> Edit:
        quantity = self._quantity()
        if "noise" in quantity:
            deviation = quantity["noise"]
        else:
            amount, unit = DEVIATIONS[quantity["kind"]]
            deviation = amount * UNITS[unit] / UNITS[quantity["unit"]]
        return self._result(f"{PLANTED}.partial({PLANTED}.noisy, {deviation!r})")

    # what they are made of

    @property
    def whole(self) -> Any:
        """The call with the ``await`` around it."""
        return self.awaited or self.call

    def _quantity(self) -> dict[str, Any]:
        name = self.mutant["quantity"]
        if self.pattern is not None:
            arguments = self.pattern.get("arguments", {})
            result = self.pattern.get("result", {})
            return dict(arguments.get(name) or (result if result and name == "result" else self.pattern))
        for group in (self.operation.get("arguments", {}), self.operation.get("result", {})):
            if name in group:
                return dict(group[name])
        result = self.operation.get("result", {})
        if name == "result" and "kind" in result:
            return dict(result)
        for group in (self.operation.get("arguments", {}), result):
            for path, quantity in group.items():
                if name.partition("[")[0] == path.partition("[")[0]:
                    return dict(quantity)
        raise CannotWriteError(f"no quantity {name}")

    def _idle(self) -> str:
        idle = self.facts.hints.get("idle", {})
        told = next((idle[key] for key in idle if self.mutant["id"].startswith(f"{key}:")), None)
        told = idle.get(self.mutant["operation"]) if told is None else told
        if told is not None:
            return str(told)
        if self.definition is None:
            raise CannotWriteError("nobody says what is answered when it is left out")
        returns = [node for node in ast.walk(self.definition) if isinstance(node, ast.Return) and node.value]
        if any(
            not (isinstance(returned.value, ast.Constant) and returned.value.value is None)
            for returned in returns
        ):
            raise CannotWriteError("judge.toml does not say what is answered when it is left out")
        return "None"

    def _current(self) -> str:
        told = self.facts.hints.get("current", {}).get(self.mutant["operation"], {})
        text = told.get(self.mutant["quantity"]) if isinstance(told, dict) else told
        if text is None:
            raise CannotWriteError("judge.toml does not say how to ask where the robot is")
        receiver = self.source.text(self.call.func.value) if isinstance(self.call.func, ast.Attribute) else ""
        return f"({text.replace('SELF', receiver)})"

    def _is_simple(self) -> bool:
        """Whether the call can stand twice, or not at all, without a change of anything else."""
        if self.is_handed or self.meant is not None:
            return False
        if self.is_async and self.awaited is None:
            return False
        is_named = all(isinstance(node, (*_PURE, ast.Attribute)) for node in ast.walk(self.call.func))
        given = [*self.call.args, *self.call.keywords]
        return is_named and all(isinstance(node, _PURE) for part in given for node in ast.walk(part))

    def _callee(self) -> str:
        return self.source.text(self.callee)

    def _handed(self) -> ast.expr | None:
        """The operation itself, where the call does not make it but is given it: ``submit(arm.move, 1)``."""
        if _last_name(self.call.func) == self._called:
            return None
        given = [*self.call.args, *(keyword.value for keyword in self.call.keywords)]
        also = self.facts.hints.get("handed", {}).get(self.mutant["operation"])
        found = [node for part in given for node in ast.walk(part)
                 if _last_name(node) == self._called or ast.unparse(node) == also]  # fmt: skip
        called = {node.func for part in given for node in ast.walk(part) if isinstance(node, ast.Call)}
        return next((node for node in found if node not in called), None)  # type: ignore[return-value]

    def _with_callee(self, planted: str) -> Edit:
        if self.pattern is not None:
            message, text = self.operation["message"], self.pattern["text"]
            planted = f"{PLANTED}.only_for({self._callee()}, {planted}, {message!r}, {text!r})"
        if self.meant is not None:
            planted = f"({planted} if {self.meant} else {self._callee()})"
        return self._replace(self.callee, planted)

    def _parameters(self) -> list[str]:
        if self.definition is None and "method" in self.operation:
            told = self.operation["signature"].strip("()").split(",")
            return [parameter.partition("=")[0].strip() for parameter in told]
        if self.definition is None:
            raise CannotWriteError("where the operation is defined cannot be found")
        names = [
            parameter.arg for parameter in [*self.definition.args.posonlyargs, *self.definition.args.args]
        ]
        static = any(
            getattr(decorator, "id", "") == "staticmethod" for decorator in self.definition.decorator_list
        )
        is_method = "." in self.mutant["operation"].partition(":")[2] and not static
        return names[1:] if is_method else names

    def _given(self, name: str) -> ast.expr:
        """The expression that the call gives for a parameter."""
        for keyword in self.call.keywords:
            if keyword.arg == name:
                return keyword.value
        index = self._parameters().index(name) if name in self._parameters() else None
        if index is None or index >= len(self.call.args):
            raise CannotWriteError(f"the call does not give {name}")
        if any(isinstance(argument, ast.Starred) for argument in self.call.args[: index + 1]):
            raise CannotWriteError("arguments with a star")
        return self.call.args[index]

    def _argument(self, change: str, *, minus: bool = False) -> Edit:
        name = self.mutant["quantity"]
        if self.pattern is not None:
            message = self._given(self.operation["message"])
            told = f"{PLANTED}.retold({self.pattern['text']!r}, {name!r}, {change}"
            return self._replace(message, f"{told}, {self.source.text(message)})")
        root = name.partition(".")[0].partition("[")[0]
        path = name.removeprefix(root)
        if self.is_handed:
            given = f"{self._callee()}, {root!r}, {path!r}, {change}, {self._parameters()!r}"
            return self._with_callee(f"{PLANTED}.with_argument({given})")
        try:
            value = self._given(root)
        except CannotWriteError:
            if any(isinstance(argument, ast.Starred) for argument in self.call.args) or any(
                keyword.arg is None for keyword in self.call.keywords
            ):
                planted = f"{PLANTED}.with_argument({self._callee()}, {root!r}, {path!r}, {change})"
                return self._with_callee(planted)
            raise
        text = self.source.text(value)
        if not path:
            plain = minus and not isinstance(value, ast.List | ast.Tuple)
            is_number = isinstance(value, ast.Constant | ast.UnaryOp | ast.BinOp)
            return self._replace(value, f"-({text})" if plain and is_number else f"{change}({text})")
        return self._replace(value, f"{PLANTED}.changed({path!r}, {change}, {text})")

    def _result(self, change: str, *, minus: bool = False) -> Edit:
        name = self.mutant["quantity"]
        path = "" if name == "result" else name
        is_elsewhere = self.is_handed or self.meant is not None or (self.is_async and self.awaited is None)
        if self.pattern is not None or is_elsewhere:
            planted = f"{PLANTED}.answering({self._callee()}, {path!r}, {change})"
            return self._with_callee(planted)
        text = self.source.text(self.whole)
        if not path and minus:
            return self._replace(self.whole, f"({change}({text}))")
        return self._replace(self.whole, f"{PLANTED}.changed({path!r}, {change}, {text})")

    def _replace(self, node: ast.AST, text: str) -> Edit:
        for written in (text, text.replace(PLANTED, PLANTED.replace('"', "'"))):  # one may end an f-string
            edit = Edit(self.source.name, *self.source.range(node), written)
            with suppress(SyntaxError):
                ast.parse(edit.applied(self.source.bytes))
                return edit
        raise CannotWriteError("the text with it cannot be parsed")


def _last_name(node: ast.AST) -> str | None:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else None


def text_edit(source: Source, mutant: Mapping[str, Any]) -> Edit:
    """The edit of a mutant of the program text: its description says what stands there instead."""
    span = mutant["span"]
    start = source.offset(span["line"], span["column"] - 1)
    end = source.offset(span["end_line"], span["end_column"] - 1)
    node = _node_at(source, start, end)
    before = source.bytes[start:end].decode()
    if mutant["operator"] == "BSR":
        return Edit(source.name, start, end, f"raise {PLANTED}.PlantedError()")
    told, arrow, after = mutant["description"].partition(" → ")
    if not arrow or "→" in after:
        raise CannotWriteError("the description has no single arrow")
    whole = {"abs": f"abs({before})", "negAbs": f"-abs({before})", "failOnZero": f"failOnZero({before})",
             "neg": f"-({before})", "not": f"not ({before})", "invert": f"~({before})"}  # fmt: skip
    if mutant["operator"] in ("ABS", "UOI") and mutant["variant"] in whole:
        after = whole[mutant["variant"]]
    elif "…" in mutant["description"]:
        raise CannotWriteError("the description is shortened")
    elif " ".join(before.split()) != told:
        raise CannotWriteError("the text there is not what the description says")
    written = after if isinstance(node, ast.stmt) else f"({after})"
    for quoted in (PLANTED, PLANTED.replace('"', "'")):  # in an f-string, one of them may end it
        edit = Edit(source.name, start, end, written.replace("failOnZero(", f"{quoted}.fail_on_zero("))
        with suppress(SyntaxError):
            ast.parse(edit.applied(source.bytes))
            return edit
    raise CannotWriteError("the text with it cannot be parsed")


def _node_at(source: Source, start: int, end: int) -> ast.AST:
    kinds = (ast.stmt, ast.expr)
    found = [node for node in source.nodes(kinds) if source.range(node) == (start, end)]
    if not found:
        raise CannotWriteError("no expression or statement stands there")
    return found[0]
