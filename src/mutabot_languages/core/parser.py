"""What the parsers of all languages share: looking at tokens, expressions by precedence, and recovery."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import ClassVar

from .text import SourceText
from .tokens import Lexis, scan
from .tree import ProgramNode

#: parentheses and blocks that may stand inside each other; deeper ones are no program
DEEPEST = 80


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """Something in a file that is not of its language.

    Attributes:
        offset: where it is.
        line: its line, from 1.
        text: ``file:line:column: expected X, found Y (in PROC name)``.
    """

    offset: int
    line: int
    text: str


@dataclass(frozen=True, slots=True)
class ParsedFile:
    """A file that was read.

    Attributes:
        source: its text.
        tree: a node of the kind ``file``, whose only body has its statements.
        diagnostics: what could not be read; each such statement is an ``opaque`` node.
    """

    source: SourceText
    tree: ProgramNode
    diagnostics: tuple[Diagnostic, ...]


class Unexpected(Exception):  # noqa: N818  (never leaves this package)
    """The next token is not what the grammar wants."""

    def __init__(self, expected: str) -> None:
        super().__init__(expected)
        self.expected = expected


class StatementParser:
    """The parser of a language: a subclass says how its statements and primaries read.

    Class attributes:
        lexis: its tokens.
        binary: the binding of its binary operators, 1 the loosest, by their words.
        unary: the binding of its unary ones.
        keywords: words of the language, which reports mark.
        terminators: words that end the block around a statement that cannot be read.
        ends_with_line: whether a statement does.
        openers: words that stand between the beginning of a block and its statements.
        brackets: what an index stands in.
        callable: kinds of expressions that parentheses behind them call.
    """

    lexis: ClassVar[Lexis]
    binary: ClassVar[Mapping[str, int]]
    unary: ClassVar[Mapping[str, int]]
    keywords: ClassVar[frozenset[str]] = frozenset()
    terminators: ClassVar[frozenset[str]] = frozenset()
    ends_with_line: ClassVar[bool] = True
    openers: ClassVar[Mapping[str, str]] = {}
    brackets: ClassVar[tuple[str, str]] = ("[", "]")
    callable: ClassVar[frozenset[str]] = frozenset({"name"})

    def __init__(self, source: SourceText) -> None:
        self.source = source
        tokens = scan(source.text, self.lexis)
        self.kinds, self.words = tokens.kinds, tokens.words
        self.starts, self.ends = tokens.starts, tokens.ends
        self.at = 0
        self.depth = 0
        self.within = ""
        self.diagnostics: list[Diagnostic] = []

    def parse(self) -> ParsedFile:
        """Read the whole file."""
        body: list[ProgramNode] = []
        while self.kinds[self.at] != "end":
            body += self.block(frozenset())
            if self.kinds[self.at] != "end":  # the end of a block that did not begin
                self._note(Unexpected("a statement"))
                self.at += 1
        tree = ProgramNode("file", self.source.name, 0, len(self.source.text), bodies=[body])
        return ParsedFile(self.source, tree, tuple(self.diagnostics))

    # what a language says

    @contextmanager
    def inside(self, what: str) -> Iterator[None]:
        """Let diagnostics name what is being read, such as ``PROC main``."""
        outer, self.within = self.within, what
        try:
            yield
        finally:
            self.within = outer

    def statement(self) -> ProgramNode | None:
        """Read a statement; None for an empty one. Raises Unexpected."""
        raise NotImplementedError

    def primary(self) -> ProgramNode:
        """Read an expression without operators. Raises Unexpected."""
        raise NotImplementedError

    def argument(self) -> ProgramNode:
        """Read an argument of a call. Raises Unexpected."""
        return self.expression()

    def arguments(self) -> list[ProgramNode]:
        """Read the arguments of a call, behind its opening parenthesis. Raises Unexpected."""
        return self.sequence(")", self.argument)

    def index(self) -> ProgramNode:
        """Read an index. Raises Unexpected."""
        return self.expression()

    def number_of(self, word: str) -> int | float:
        """Return the value of a number as it is written."""
        return int(word) if word.isdecimal() else float(word)

    # blocks and recovery

    def block(self, until: frozenset[str]) -> list[ProgramNode]:
        """Read statements up to one of these words, or to the end of an outer block."""
        body: list[ProgramNode] = []
        self.depth += 1
        depth = self.depth
        while (word := self.words[self.at]) not in until and self.kinds[self.at] != "end":
            if word in self.terminators and not self.begins_statement():
                break
            start, first = self.at, self.starts[self.at]
            try:
                found = self._inner_statement()
            except Unexpected as error:
                self.depth = depth
                self._note(error)
                self._skip(start)
                found = ProgramNode("opaque", "", first, max(first, self.ends[max(self.at - 1, 0)]))
            if found is not None:
                body.append(found)
            elif self.at == start:
                self.at += 1
        self.depth -= 1
        return body

    def _inner_statement(self) -> ProgramNode | None:
        if self.depth > DEEPEST:
            raise Unexpected("fewer blocks inside each other")
        return self.statement()

    def begins_statement(self) -> bool:
        """Return whether a word that can end a block begins a statement here."""
        return False

    def close(self, word: str, opened: int) -> None:
        """Read the end of a block; if it is missing, note that and go on."""
        if self.words[self.at] == word:
            self.at += 1
            return
        line = self.source.line_of(opened)
        self._note(Unexpected(f"{word!r} for the block that begins in line {line}"))

    def _note(self, error: Unexpected) -> None:
        offset = self.starts[self.at]
        found = self.source.text[offset : self.ends[self.at]]
        shown = {"newline": "the end of the line", "end": "the end of the file"}.get(
            self.kinds[self.at], repr(found[:30])
        )
        where = f" (in {self.within})" if self.within else ""
        text = f"{self.source.place(offset)}: expected {error.expected}, found {shown}{where}"
        self.diagnostics.append(Diagnostic(offset, self.source.line_of(offset), text))

    def _skip(self, start: int) -> None:
        """Go to the end of a statement; always at least one token further than it began."""
        self.at = max(self.at, start)
        kinds, words = self.kinds, self.words
        line = self.source.line_of(self.starts[self.at])
        while kinds[self.at] != "end":
            if kinds[self.at] == "newline" or words[self.at] == ";":
                self.at += 1
                return
            begins = self.source.line_of(self.starts[self.at]) > line
            if self.at > start and begins and (not self.ends_with_line or words[self.at] in self.terminators):
                return
            self.at += 1

    # tokens

    def cases(
        self, until: str, colon: Callable[[], object]
    ) -> tuple[list[list[ProgramNode] | None], list[list[ProgramNode]]]:
        """Read the cases of a switch up to a word: their labels, None for the default, and their bodies."""
        labels: list[list[ProgramNode] | None] = []
        bodies: list[list[ProgramNode]] = []
        while self.words[self.at] in ("case", "default"):
            is_case = self.words[self.at] == "case"
            self.at += 1
            found: list[ProgramNode] = []
            while is_case and (not found or self.accept(",")):
                found.append(self.expression())
            colon()
            labels.append(found if is_case else None)
            bodies.append(self.block(frozenset({"case", "default", until})))
        return labels, bodies

    def accept(self, word: str) -> bool:
        """Read this word if it is next."""
        if self.words[self.at] == word:
            self.at += 1
            return True
        return False

    def expect(self, word: str) -> None:
        """Read this word. Raises Unexpected."""
        if self.words[self.at] != word:
            raise Unexpected(repr(word))
        self.at += 1

    def identifier(self, expected: str = "a name") -> str:
        """Read a name. Raises Unexpected."""
        if self.kinds[self.at] != "name":
            raise Unexpected(expected)
        self.at += 1
        return self.words[self.at - 1]

    def node(
        self,
        kind: str,
        name: str,
        start: int,
        parts: list[ProgramNode] | None = None,
        bodies: list[list[ProgramNode]] | None = None,
        value: object = None,
    ) -> ProgramNode:
        """Return a node from an offset to the end of the last token that was read."""
        return ProgramNode(kind, name, start, self.ends[self.at - 1], parts, bodies, value)

    # statements that languages have in common, behind their first word

    def opened(self, word: str) -> None:
        """Read what stands between the beginning of a block and its statements. Raises Unexpected."""
        if word in self.openers:
            self.expect(self.openers[word])

    def branches(self, start: int, first: ProgramNode, closes: str, other: str = "else") -> ProgramNode:
        """Read the blocks of IF behind its first condition, and a word for others. Raises Unexpected."""
        until = frozenset({other, "else", closes})
        conditions, bodies = [first], [self.block(until)]
        while other != "else" and self.accept(other):
            conditions.append(self.expression())
            self.opened("if")
            bodies.append(self.block(until))
        if self.accept("else"):
            self.opened("else")
            bodies.append(self.block(until))
        self.close(closes, start)
        return self.node("if", "", start, conditions, bodies)

    def while_loop(self, start: int, closes: str) -> ProgramNode:
        """Read a loop with a condition. Raises Unexpected."""
        condition = self.expression()
        self.opened("while")
        body = self.block(frozenset({closes}))
        self.close(closes, start)
        return self.node("while", "", start, [condition], [body])

    def for_loop(self, start: int, begins: str, value: object = None) -> ProgramNode:
        """Read a loop with a counter, and a word or sign before its first value. Raises Unexpected."""
        name = self.identifier("a counter")
        self.expect(begins)
        parts = [self.expression()]
        self.expect("to")
        parts.append(self.expression())
        if self.accept("step"):
            parts.append(self.expression())
        self.opened("for")
        body = self.block(frozenset({"endfor"}))
        self.close("endfor", start)
        return self.node("for", name, start, parts, [body], value=value)

    def word(self, start: int, kind: str = "") -> ProgramNode:
        """Read a statement that is a word alone, and of that kind by default."""
        word = self.words[self.at - 1]
        return self.node(kind or word, word, start)

    def leave(self, start: int, kind: str = "return") -> ProgramNode:
        """Read a word, such as RETURN, and the value behind it, if there is one. Raises Unexpected."""
        word = self.words[self.at]
        is_over = self.kinds[self.at] in ("newline", "end") or word == ";" or word in self.terminators
        return self.node(kind, "", start, [] if is_over else [self.expression()])

    def jump(self, start: int) -> ProgramNode:
        """Read GOTO and its label. Raises Unexpected."""
        return self.node("goto", self.identifier("a label"), start)

    # expressions

    def literal(self) -> ProgramNode | None:
        """Read a number, a text, or what stands in parentheses; None if none is next. Raises Unexpected."""
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if kind == "number":
            self.at += 1
            return ProgramNode("number", word, start, self.ends[self.at - 1], value=self.number_of(word))
        if kind == "text":
            self.at += 1
            return self.node(
                "text", word, start, value=self.source.text[start + 1 : self.ends[self.at - 1] - 1]
            )
        if word != "(":
            return None
        self.at += 1
        inner = self.expression()
        self.expect(")")
        return self.after(self.node("group", "", start, [inner]), start)

    def after(self, found: ProgramNode, start: int) -> ProgramNode:
        """Read calls, indexes and components behind an expression. Raises Unexpected."""
        opens, closes = self.brackets
        while self.kinds[self.at] == "sign":
            word = self.words[self.at]
            if word == "(" and found.kind in self.callable:
                self.at += 1
                kind = "method" if found.kind == "field" else "call"
                found = self.node(kind, found.name, start, [*found.parts, *self.arguments()])
            elif word == opens:
                self.at += 1
                indexes = self.sequence(closes, self.index)
                found = self.node("index", "", start, [found, *indexes]) if indexes else found
            elif word == "." and self.kinds[self.at + 1] == "name":
                self.at += 2
                found = self.node("field", self.words[self.at - 1], start, [found])
            else:
                break
        return found

    def expression(self, least: int = 1) -> ProgramNode:
        """Read an expression whose operators bind at least so tightly. Raises Unexpected."""
        if self.kinds[self.at] == "number" and self.words[self.at + 1] not in self.binary:
            return self.primary()  # by far the most of them, in data
        if self.depth > DEEPEST:
            raise Unexpected("fewer parentheses inside each other")
        self.depth += 1
        start = self.starts[self.at]
        word = self.words[self.at]
        if word in self.unary and self.kinds[self.at] != "text":
            self.at += 1
            left = self.expression(self.unary[word])
            left = ProgramNode("unary", word, start, left.end, [left])
        else:
            left = self.primary()
        while (binding := self.binary.get(self.words[self.at], 0)) >= least:
            if self.kinds[self.at] == "text":
                break
            operator = self.words[self.at]
            self.at += 1
            right = self.expression(binding + 1)
            left = ProgramNode("binary", operator, start, right.end, [left, right])
        self.depth -= 1
        return left

    def sequence(self, closing: str, item: Callable[[], ProgramNode]) -> list[ProgramNode]:
        """Read items with commas between them, and what closes them. Raises Unexpected."""
        items: list[ProgramNode] = []
        if self.accept(closing):
            return items
        while True:
            items.append(item())
            if self.accept(closing):
                return items
            if not self.accept(","):
                raise Unexpected(f"',' or {closing!r}")
