"""What the parsers of all languages share: looking at tokens, expressions by precedence, and recovery."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
    """

    lexis: ClassVar[Lexis]
    binary: ClassVar[Mapping[str, int]]
    unary: ClassVar[Mapping[str, int]]
    keywords: ClassVar[frozenset[str]] = frozenset()
    terminators: ClassVar[frozenset[str]] = frozenset()
    ends_with_line: ClassVar[bool] = True

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

    def statement(self) -> ProgramNode | None:
        """Read a statement; None for an empty one. Raises Unexpected."""
        raise NotImplementedError

    def primary(self) -> ProgramNode:
        """Read an expression without operators. Raises Unexpected."""
        raise NotImplementedError

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
        """Whether a word that can end a block begins a statement here."""
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
        """A node from an offset to the end of the last token that was read."""
        return ProgramNode(kind, name, start, self.ends[self.at - 1], parts, bodies, value)

    # expressions

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
