"""RAPID as it reads: semicolons end statements, capital letters do not matter, ``!`` begins a comment."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from mutabot_languages.core.names import name_set
from mutabot_languages.core.parser import StatementParser, Unexpected
from mutabot_languages.core.tokens import Lexis
from mutabot_languages.core.tree import ProgramNode

_ROUTINES = {"proc": "endproc", "func": "endfunc", "trap": "endtrap"}
_SECTIONS = ("backward", "error", "undo")
_OUTER = name_set("module endmodule proc func trap endproc endfunc endtrap local task record alias")
_DATA = name_set("var pers const")
_MODES = name_set("var pers inout")
#: words that no expression and no instruction begins with
RESERVED = name_set(
    """alias and backward case connect const default div do else elseif endfor endfunc endif endmodule endproc
    endrecord endtest endtrap endwhile error exit for from func goto if inout local mod module not or pers
    proc raise record retry return task test then to trap trynext undo var while with xor step"""
)


class RapidParser(StatementParser):
    """The parser of RAPID."""

    lexis: ClassVar = Lexis.of(
        {
            "space": r"[ \t\r\n\f\v\ufeff\xa0\u3000\x00\x1a]+",
            "comment": r"![^\r\n]*",
            "header": r"%%%.*?%%%",
            "name": r"[^\W\d]\w*|\d+_\w*",
            "number": r"0[xX][0-9a-fA-F]+|0[bB][01]+|0[oO][0-7]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?",
            "text": r'"(?:[^"\r\n]|"")*"',
            "placeholder": r"<(?:SMT|EXP|ID|DDN|RDN|TDN|VAR|DIM|PAR|ARG|ALT|EIT|CSE|VIT|COMMENT)>",
            "sign": r":=|<=|>=|<>|[-+*/<>=()\[\]{},.:;\\?%|@#]",
        },
        ignores_case=True,
    )
    binary: ClassVar = {
        "or": 1, "xor": 1, "and": 2, "=": 4, "<>": 4, "<": 4, ">": 4, "<=": 4, ">=": 4, "+": 5, "-": 5,
        "*": 6, "/": 6, "div": 6, "mod": 6,
    }  # fmt: skip
    unary: ClassVar = {"not": 2, "-": 7, "+": 7}
    keywords: ClassVar = RESERVED | {"true", "false"}
    terminators: ClassVar = name_set(
        """endproc endfunc endtrap endmodule endif endfor endwhile endtest elseif else case default
        backward error
        undo proc func trap endrecord"""
    )
    ends_with_line: ClassVar = False
    openers: ClassVar = {"if": "then", "while": "do", "for": "do"}
    brackets: ClassVar = ("{", "}")

    def begins_statement(self) -> bool:
        """Return whether a routine begins here and may: it does not stand in another one."""
        return self.words[self.at] in _ROUTINES and not self.within.startswith(("PROC", "FUNC", "TRAP"))

    def statement(self) -> ProgramNode | None:
        """Read a statement or a declaration; None for a header."""
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if word == ";":
            self.at += 1
            return self.node("empty", "", start)
        if kind == "header":
            self.at += 1
            return None
        if kind == "placeholder":
            self.at += 1
            self.accept(";")
            return self.node("empty", "placeholder", start)
        reader = _READERS.get(word) if kind == "name" else None
        if reader is not None:
            self.at += 1
            return reader(self, start)
        if word == "%":
            return self._late(start)
        if kind != "name" or (word in RESERVED and word != "step"):
            raise Unexpected("a statement")
        if self.words[self.at + 1] == ":" and self.kinds[self.at + 1] == "sign":
            self.at += 2
            return self.node("label", word, start)
        return self._simple(start)

    # modules and routines

    def _module(self, start: int) -> ProgramNode:
        name = self.identifier("the name of a module")
        if self.accept("("):
            while not self.accept(")"):
                if self.kinds[self.at] == "end":
                    raise Unexpected("')'")
                self.at += 1
        with self.inside(f"MODULE {name}"):
            body = self.block(frozenset({"endmodule"}))
        self.close("endmodule", start)
        return self.node("module", name, start, bodies=[body])

    def _scoped(self, start: int) -> ProgramNode:
        scope, word = self.words[self.at - 1 : self.at + 1]
        if word not in {*_ROUTINES, *_DATA, "record", "alias"}:
            raise Unexpected("a declaration")
        self.at += 1
        if word in _ROUTINES:
            return self._routine(start, scope)
        return self._data(start, scope) if word in _DATA else _READERS[word](self, start)

    def _routine(self, start: int, scope: str = "") -> ProgramNode:
        kind = self.words[self.at - 1]
        type = self.identifier("the type of a function") if kind == "func" else ""
        name = self.identifier("the name of a routine")
        with self.inside(f"{kind.upper()} {name}"):
            parameters = self._parameters() if kind != "trap" else []
            until = frozenset({_ROUTINES[kind], *_SECTIONS})
            body = self.block(until)
            sections: dict[str, list[ProgramNode]] = {}
            while self.words[self.at] in _SECTIONS:
                section = self.words[self.at]
                self.at += 1
                if section == "error" and self.accept("("):
                    self.sequence(")", self.expression)
                sections[section] = self.block(until)
            self.close(_ROUTINES[kind], start)
        value: dict[str, Any] = {"kind": kind, "type": type, "scope": scope, "sections": [*sections]}
        return self.node("routine", name, start, parameters, [body, *sections.values()], value)

    def _parameters(self) -> list[ProgramNode]:
        self.expect("(")
        found: list[ProgramNode] = []
        optional = False
        while not self.accept(")"):
            start = self.starts[self.at]
            if self.accept("\\"):
                optional = True
            elif not self.accept("|") and found:
                optional = False
            mode = self.words[self.at] if self.words[self.at] in _MODES else ""
            self.at += bool(mode)
            if self.kinds[self.at] == "placeholder":
                self.at += 1
                self.accept(",")
                continue
            type = self.identifier("the type of a parameter")
            name = self.identifier("a parameter")
            if self.accept("{"):
                self.sequence("}", self._star)
            value = {"type": type, "mode": mode, "optional": optional}
            found.append(self.node("parameter", name, start, value=value))
            if not self.accept(",") and self.words[self.at] not in ("\\", "|", ")"):
                raise Unexpected("',' or ')'")
        return found

    def _star(self) -> ProgramNode:
        start = self.starts[self.at]
        self.expect("*")
        return self.node("omitted", "*", start)

    def _record(self, start: int) -> ProgramNode:
        name = self.identifier("the name of a record")
        components: list[tuple[str, str]] = []
        while (
            self.words[self.at] not in ("endrecord", "endmodule", "proc", "func")
            and self.kinds[self.at] != "end"
        ):
            type = self.identifier("a component")
            component = self.identifier("a component")
            self.expect(";")
            components.append((component, type))
        self.close("endrecord", start)
        return self.node("record", name, start, value=components)

    def _alias(self, start: int) -> ProgramNode:
        type = self.identifier("a type")
        name = self.identifier("a name")
        node = self.node("record", name, start, value=type)
        self.expect(";")
        return node

    def _data(self, start: int, scope: str = "") -> ProgramNode:
        kind = self.words[self.at - 1]
        type = self.identifier("a type")
        if self.kinds[self.at] == "placeholder":
            self.at += 1
            self.accept(";")
            return self.node("empty", "placeholder", start)
        name = self.identifier("the name of the data")
        sizes = self.sequence("}", self.expression) if self.accept("{") else []
        initial: list[ProgramNode] = []
        if self.accept(":="):
            initial = [self.expression()]
        value = {"kind": kind, "type": type, "scope": scope, "sizes": sizes}
        node = self.node("declare", name, start, initial, value=value)
        self.expect(";")
        return node

    # statements

    def _if(self, start: int) -> ProgramNode:
        condition = self.expression()
        if self.accept("then"):
            return self.branches(start, condition, "endif", "elseif")
        inner = self.statement()
        return self.node("if", "compact", start, [condition], [[inner] if inner is not None else []])

    def close(self, word: str, opened: int) -> None:
        """Read the end of a block, and a semicolon that may stand behind it."""
        super().close(word, opened)
        self.accept(";")

    def _test(self, start: int) -> ProgramNode:
        parts = [self.expression()]
        self.accept(";")
        labels, bodies = self.cases("endtest", lambda: self.expect(":"))
        self.close("endtest", start)
        return self.node("switch", "", start, parts, bodies, labels)

    def _connect(self, start: int) -> ProgramNode:
        target = self.expression()
        self.expect("with")
        trap = self.node("name", self.identifier("a trap"), start)
        return self._ended(self.node("call", "connect", start, [target, trap]))

    def _late(self, start: int) -> ProgramNode:
        self.at += 1
        name = self.expression()
        self.expect("%")
        return self._ended(self.node("call", "%", start, [name, *self._arguments(";")], value="late"))

    def _ended(self, node: ProgramNode) -> ProgramNode:
        self.expect(";")
        return node

    def _simple(self, start: int) -> ProgramNode:
        """Parse an assignment or an instruction."""
        word = self.words[self.at]
        follows = self.words[self.at + 1]
        if follows in (":=", ".", "{") and self.kinds[self.at + 1] == "sign":
            target = self.primary()
            if not self.accept(":="):
                raise Unexpected("':='")
            return self._ended(self.node("assign", "", start, [target, self.expression()]))
        self.at += 1
        return self._ended(self.node("call", word, start, self._arguments(";")))

    def arguments(self) -> list[ProgramNode]:
        """Read the arguments and options of a function, behind its opening parenthesis."""
        found = self._arguments(")")
        self.expect(")")
        return found

    def _arguments(self, closes: str) -> list[ProgramNode]:
        found: list[ProgramNode] = []
        while True:
            options = self._options()
            found += options
            if options and self.accept(","):
                continue
            if self.words[self.at] == closes:
                return found
            found += [self.expression(), *self._options()]
            if not self.accept(","):
                return found

    def _options(self) -> list[ProgramNode]:
        found: list[ProgramNode] = []
        while self.words[self.at] == "\\":
            start = self.starts[self.at]
            self.at += 1
            name = self.identifier("the name of an argument")
            value: object = None
            parts: list[ProgramNode] = []
            if self.accept(":="):
                parts = [self.expression()]
            elif self.accept("?"):
                parts, value = [self.primary()], "conditional"
            found.append(self.node("option", name, start, parts, value=value))
            if self.words[self.at] == "," and self.words[self.at + 1] == "\\":
                self.at += 1
        return found

    def primary(self) -> ProgramNode:
        """Read a literal, a name, a call, or what stands in parentheses, with what follows it."""
        found = self.literal()
        if found is not None:
            if found.kind == "text":
                found.value = found.value.replace('""', '"')
            return found
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if kind == "placeholder":
            self.at += 1
            return self.node("omitted", "", start)
        if word == "[":
            self.at += 1
            return self.after(self.node("list", "", start, self.sequence("]", self.expression)), start)
        if kind != "name" or word in RESERVED:
            raise Unexpected("an expression")
        self.at += 1
        if word in ("true", "false"):
            return self.node("constant", word, start, value=word == "true")
        return self.after(self.node("name", word, start), start)

    def index(self) -> ProgramNode:
        """Read an index; a star stands for a whole dimension."""
        return self._star() if self.words[self.at] == "*" else self.expression()

    def number_of(self, word: str) -> int | float:
        """Return the value of a number, which may be of hexadecimal, binary or octal digits."""
        return int(word, 0) if word[1:2] in ("x", "b", "o") else super().number_of(word)


_READERS: dict[str, Callable[[RapidParser, int], ProgramNode]] = {
    "module": RapidParser._module, "local": RapidParser._scoped, "task": RapidParser._scoped,
    "proc": RapidParser._routine, "func": RapidParser._routine, "trap": RapidParser._routine,
    "record": RapidParser._record, "alias": RapidParser._alias, "var": RapidParser._data,
    "pers": RapidParser._data, "const": RapidParser._data, "if": RapidParser._if, "test": RapidParser._test,
    "for": lambda parser, start: parser.for_loop(start, "from"),
    "while": lambda parser, start: parser.while_loop(start, "endwhile"),
    "goto": lambda parser, start: parser._ended(parser.jump(start)),
    "return": lambda parser, start: parser._ended(parser.leave(start)),
    "raise": lambda parser, start: parser._ended(parser.leave(start, "raise")),
    **dict.fromkeys(("exit", "retry", "trynext"), lambda parser, start: parser._ended(parser.word(start))),
    "connect": RapidParser._connect,
}  # fmt: skip
