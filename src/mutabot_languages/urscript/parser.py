"""URScript as it reads: lines end statements, names keep their capitals, ``end`` closes blocks."""

from __future__ import annotations

from typing import ClassVar

from mutabot_languages.core.names import name_set
from mutabot_languages.core.parser import StatementParser, Unexpected
from mutabot_languages.core.text import SourceText
from mutabot_languages.core.tokens import Lexis
from mutabot_languages.core.tree import ProgramNode

_END = frozenset({"end"})
_BRANCH = frozenset({"end", "elif", "else"})
#: words that begin a line whatever brackets are still open
_BEGINNINGS = name_set("def thread sec if elif else while end return global local break continue")
_OPENING = frozenset("([{")
_CLOSING = frozenset(")]}")
CONSTANTS = {"True": True, "False": False, "true": True, "false": False, "None": None}
KEYWORDS = _BEGINNINGS | name_set("halt run and or xor not pass")


class URScriptParser(StatementParser):
    """The parser of URScript."""

    lexis: ClassVar = Lexis.of(
        {
            "space": r"[ \t\f\v\ufeff\xa0\x00]+|\\\r?\n",
            "comment": r"#[^\r\n]*",
            "newline": r"\r\n|\r|\n",
            "label": r"\$[^\r\n]*",
            "name": r"[^\W\d]\w*",
            "number": r"0[xX][0-9a-fA-F]+|0[bB][01]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?",
            "text": r'"[^"\r\n]*"|\'[^\'\r\n]*\'',
            "sign": r"<=|>=|==|!=|[-+*/%<>=()\[\]{},.:;@^&|~]",
        },
        ignores_case=False,
    )
    binary: ClassVar = {
        "or": 1, "xor": 1, "and": 2, "==": 3, "!=": 3, "<": 3, ">": 3, "<=": 3, ">=": 3, "+": 4, "-": 4,
        "*": 5, "/": 5, "%": 5,
    }  # fmt: skip
    unary: ClassVar = {"not": 3, "-": 6, "+": 6}
    keywords: ClassVar = KEYWORDS | CONSTANTS.keys()
    terminators: ClassVar = _BRANCH
    callable: ClassVar = frozenset({"name", "field"})

    def __init__(self, source: SourceText) -> None:
        super().__init__(source)
        self._join_lines()

    def _join_lines(self) -> None:
        """Take out ends of lines in brackets, and behind AND and OR, but not before a statement."""
        depth, kept = 0, list[int]()
        kinds, words = self.kinds, self.words
        for index, (kind, word) in enumerate(zip(kinds, words, strict=True)):
            if kind == "sign":
                depth = depth + 1 if word in _OPENING else max(depth - 1, 0) if word in _CLOSING else depth
            elif kind == "newline" and (depth or (kept and words[kept[-1]] in ("and", "or", "xor"))):
                if words[index + 1] not in _BEGINNINGS:
                    continue
                depth = 0
            kept.append(index)
        self.kinds, self.words = [kinds[n] for n in kept], [words[n] for n in kept]
        self.starts = [self.starts[index] for index in kept]
        self.ends = [self.ends[index] for index in kept]

    def statement(self) -> ProgramNode | None:
        """Read a statement; None for an empty line."""
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if kind == "newline" or word == ";":
            self.at += 1
            return None
        if kind == "label":
            self.at += 1
            return self.node("empty", "label", start)
        if kind == "sign" and word == "@":  # an annotation of the next definition
            while self.kinds[self.at] not in ("newline", "end"):
                self.at += 1
            return None
        reader = getattr(self, f"_{word}", None) if word in KEYWORDS else None
        self.at += reader is not None
        found: ProgramNode = (reader or self._simple)(start)
        self._end_of_line()
        return found

    def _end_of_line(self) -> None:
        if self.kinds[self.at] not in ("newline", "end") and self.words[self.at] not in {";", *_BRANCH}:
            raise Unexpected("the end of the statement")

    def _def(self, start: int) -> ProgramNode:
        kind = self.words[self.at - 1]
        name = self.identifier("the name of a function")
        with self.inside(f"{kind} {name}"):
            self.expect("(")
            parameters = self.sequence(")", self._parameter)
            self.expect(":")
            body = self.block(_END)
            self.close("end", start)
        return self.node("routine", name, start, parameters, [body], kind)

    _thread = _sec = _def

    def _parameter(self) -> ProgramNode:
        start = self.starts[self.at]
        name = self.identifier("a parameter")
        default = [self.expression()] if self.accept("=") else []
        return self.node("parameter", name, start, default)

    def _if(self, start: int) -> ProgramNode:
        condition = self.expression()
        self.opened("if")
        return self.branches(start, condition, "end", "elif")

    def opened(self, word: str) -> None:
        """Read the colon of a block; without it the block is clear as well."""
        if not self.accept(":"):
            self._note(Unexpected("':'"))

    def _while(self, start: int) -> ProgramNode:
        return self.while_loop(start, "end")

    def _switch(self, start: int) -> ProgramNode:
        subject = self.expression()
        self.expect(":")
        while self.kinds[self.at] == "newline":
            self.at += 1
        labels, bodies = self.cases("end", lambda: self.expect(":"))
        self.close("end", start)
        return self.node("switch", "", start, [subject], bodies, labels)

    def _pass(self, start: int) -> ProgramNode:
        return self.word(start, "empty")

    _return = StatementParser.leave
    _break = _continue = StatementParser.word

    def _halt(self, start: int) -> ProgramNode:
        if self.accept("("):
            self.expect(")")
        return self.node("exit", "halt", start)

    def _global(self, start: int) -> ProgramNode:
        scope = self.words[self.at - 1]
        target = self.primary()
        if not self.accept("="):
            return self.node("empty", scope, start)
        return self.node("assign", scope, start, [target, self.expression()])

    _local = _global

    def _simple(self, start: int) -> ProgramNode:
        word = self.words[self.at]
        follows = self.words[self.at + 1] if self.kinds[self.at] != "end" else ""
        if word == "switch" and follows != "=":
            self.at += 1
            return self._switch(start)
        if word in ("enter_critical", "exit_critical", "halt"):
            self.at += 1
            return self.node("empty", word, start)
        if word in ("kill", "join") and self.kinds[self.at + 1] == "name":
            self.at += 1
            return self.node("call", word, start, [self.primary()])
        if word in self.unary or self.kinds[self.at] in ("number", "text"):
            raise Unexpected("a statement")
        target = self.expression()
        if self.accept("="):
            if target.kind not in ("name", "index", "field"):
                raise Unexpected("a variable before '='")
            return self.node("assign", "", start, [target, self.expression()])
        if target.kind in ("call", "method"):
            return target
        raise Unexpected("'=' or '('")

    def argument(self) -> ProgramNode:
        """Read an argument, which may have a name."""
        start = self.starts[self.at]
        if self.kinds[self.at] == "name" and self.words[self.at + 1] == "=":
            name = self.words[self.at]
            self.at += 2
            return self.node("option", name, start, [self.expression()])
        return self.expression()

    def primary(self) -> ProgramNode:
        """Read a literal, a name, a call, or what stands in parentheses, with what follows it."""
        found = self.literal()
        if found is not None:
            return found
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if word in ("[", "{"):
            self.at += 1
            closing = "]" if word == "[" else "}"
            return self.after(self.node("list", "", start, self.sequence(closing, self.argument)), start)
        if word == "run" and self.kinds[self.at + 1] == "name":
            self.at += 1
            return self.node("call", "run", start, [self.primary()])
        if kind != "name" or (word in KEYWORDS and word not in ("run", "pass", "sec")):
            raise Unexpected("an expression")
        self.at += 1
        if word in CONSTANTS:
            return self.node("constant", word, start, value=CONSTANTS[word])
        if word == "p" and self.words[self.at] == "[":
            self.at += 1
            parts = self.sequence("]", self.expression)
            if len(parts) == 1:  # an element of a variable of this name
                owner = ProgramNode("name", "p", start, start + 1)
                return self.after(self.node("index", "", start, [owner, *parts]), start)
            return self.after(self.node("pose", "", start, parts), start)
        return self.after(self.node("name", word, start), start)

    def number_of(self, word: str) -> int | float:
        """Return the value of a number, which may be of hexadecimal or binary digits."""
        return int(word, 0) if word[:2].lower() in ("0x", "0b") else super().number_of(word)
