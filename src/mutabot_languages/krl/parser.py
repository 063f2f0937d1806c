"""KRL as it reads: lines end statements, capital letters do not matter, ``;`` begins a comment."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from mutabot_languages.core.names import name_set
from mutabot_languages.core.parser import StatementParser, Unexpected
from mutabot_languages.core.tokens import Lexis
from mutabot_languages.core.tree import ProgramNode

MOTIONS = name_set(
    """ptp lin circ ptp_rel lin_rel circ_rel sptp slin scirc spl sptp_rel slin_rel scirc_rel spl_rel async_ptp
    asyptp"""
)
TYPES = name_set("int real bool char frame pos e6pos axis e6axis e3pos e3axis signal channel load")
#: instructions that are a word and nothing else
_BARE = name_set("brake resume on_error_proceed")
_ENDS = {"def": "end", "deffct": "endfct", "defdat": "enddat"}
RESERVED = name_set(
    """def deffct defdat end endfct enddat if then else endif for to step endfor while endwhile repeat until
    loop endloop switch case default endswitch goto return exit halt wait decl global struc enum signal ext
    extfct import interrupt trigger when with do continue and or not exor b_and b_or b_exor b_not spline
    endspline const public"""
)


class KrlParser(StatementParser):
    """The parser of KRL."""

    lexis: ClassVar = Lexis.of(
        {
            "space": r"[ \t\f\v\ufeff\xa0\x00\x1a]+",
            "comment": r";[^\r\n]*|^[ \t]*&[^\r\n]*",
            "newline": r"\r\n|\r|\n",
            "name": r"\$?[^\W\d][\w$]*",
            "number": r"'[HhBb][0-9A-Fa-f]+'|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?",
            "text": r'"[^"\r\n]*"',
            "sign": r"==|<>|<=|>=|[-+*/<>=()\[\]{},.:#!?^%|&@~\\]",
        },
        ignores_case=True,
    )
    binary: ClassVar = {
        "or": 1, "b_or": 1, "exor": 2, "b_exor": 2, "and": 3, "b_and": 3, "==": 5, "<>": 5, "<": 5, ">": 5,
        "<=": 5, ">=": 5, "+": 6, "-": 6, "*": 7, "/": 7, ":": 8,
    }  # fmt: skip
    unary: ClassVar = {"not": 4, "b_not": 4, "-": 9, "+": 9}
    openers: ClassVar = {"if": "then"}
    keywords: ClassVar = RESERVED | MOTIONS | {"true", "false"}
    terminators: ClassVar = name_set(
        """end endfct enddat endif else endfor endwhile until endloop case default endswitch endspline def
        deffct
        defdat"""
    )

    def begins_statement(self) -> bool:
        """Return whether a routine begins here and may: it does not stand in another one."""
        return self.words[self.at] in _ENDS and not self.within.startswith("DEF")

    def statement(self) -> ProgramNode | None:
        """Read a statement or a declaration; None for an empty line."""
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if kind == "newline":
            self.at += 1
            is_blank = self.at < 2 or self.kinds[self.at - 2] == "newline"
            return self.node("empty", "", start) if is_blank else None
        reader = _READERS.get(word) if kind == "name" else None
        if reader is None or self._is_assigned():
            found = self._simple(start)
        else:
            self.at += 1
            found = reader(self, start)
        self._end_of_line()
        return found

    def _is_assigned(self) -> bool:
        return self.words[self.at + 1] == "=" and self.words[self.at] not in ("def", "deffct")

    def _end_of_line(self) -> None:
        if self.kinds[self.at] not in ("newline", "end"):
            raise Unexpected("the end of the line")

    # routines and declarations

    def _global(self, start: int) -> ProgramNode:
        word = self.words[self.at]
        if word in ("def", "deffct"):
            self.at += 1
            return self._routine(start, scope="global")
        if word in ("interrupt", "decl", "struc", "enum", "signal", "const"):
            self.at += 1
            return _READERS[word](self, start)
        return self._declaration(start)

    def _routine(self, start: int, scope: str = "") -> ProgramNode:
        kind = self.words[self.at - 1]
        type = ""
        if kind == "deffct":
            type = self.identifier("the type of a function")
            if self.accept("["):
                self.sequence("]", self.index)
        name = self.identifier("the name of a routine")
        with self.inside(f"{kind.upper()} {name}"):
            parameters: list[ProgramNode] = []
            if kind == "defdat":
                self.accept("public")
            elif self.accept("("):
                parameters = self.sequence(")", self._parameter)
            body = self.block(frozenset({_ENDS[kind]}))
            self.close(_ENDS[kind], start)
        if kind == "defdat":
            return self.node("module", name, start, bodies=[body], value="data")
        value = {"kind": kind, "type": type, "scope": scope}
        return self.node("routine", name, start, parameters, [body], value)

    def _parameter(self) -> ProgramNode:
        start = self.starts[self.at]
        name = self.identifier("a parameter")
        if self.accept("["):
            self.sequence("]", self.index)
        mode = "out"
        if self.accept(":"):
            mode = self.identifier("IN or OUT")
        return self.node("parameter", name, start, value={"mode": mode, "type": "", "optional": False})

    def index(self) -> ProgramNode:
        """Read an index or a size, which may be left out."""
        if self.words[self.at] in (",", "]"):
            return self.node("omitted", "", self.starts[self.at])
        return self.expression()

    def _declaration(self, start: int) -> ProgramNode:
        """Parse ``DECL TYPE name[2]=value, name …``, or the words before it."""
        while self.words[self.at] in ("global", "const", "decl", "public"):
            self.at += 1
        if self.words[self.at] in ("struc", "enum", "signal"):
            self.at += 1
            return _READERS[self.words[self.at - 1]](self, start)
        type = self.identifier("a type")
        if self.accept("["):
            self.sequence("]", self.index)
        found: list[ProgramNode] = []
        while True:
            at = self.starts[self.at]
            name = self.identifier("the name of a variable")
            sizes = self.sequence("]", self.index) if self.accept("[") else []
            initial = [self.expression()] if self.accept("=") else []
            found.append(self.node("declare", name, at, initial, value={"type": type, "sizes": sizes}))
            if not self.accept(","):
                break
        if len(found) == 1:
            found[0].start = start
            return found[0]
        return self.node("declarations", type, start, bodies=[found])

    def _struc(self, start: int) -> ProgramNode:
        name = self.identifier("the name of a structure")
        components: list[tuple[str, str]] = []
        type = ""
        while self.kinds[self.at] == "name":
            word = self.identifier()
            if self.kinds[self.at] == "name":
                type = word
                word = self.identifier()
            if self.accept("["):
                self.sequence("]", self.index)
            components.append((word, type))
            if not self.accept(","):
                break
        return self.node("record", name, start, value=components)

    def _enum(self, start: int) -> ProgramNode:
        name = self.identifier("the name of an enumeration")
        while self.kinds[self.at] == "name" or self.words[self.at] == ",":
            self.at += 1
        return self.node("record", name, start, value=[])

    def _signal(self, start: int) -> ProgramNode:
        name = self.identifier("the name of a signal")
        parts = [self.primary()]
        if self.accept("to"):
            parts.append(self.primary())
        return self.node("signal", name, start, parts)

    def _to_line_end(self, start: int) -> ProgramNode:
        """Parse a statement without a meaning here, up to the end of its line: EXT, IMPORT."""
        word = self.words[self.at - 1]
        while self.kinds[self.at] not in ("newline", "end"):
            self.at += 1
        return self.node("record", word, start, value=[])

    # statements

    def _if(self, start: int) -> ProgramNode:
        condition = self.expression()
        self.opened("if")
        return self.branches(start, condition, "endif")

    def _repeat(self, start: int) -> ProgramNode:
        body = self.block(frozenset({"until"}))
        self.expect("until")
        return self.node("repeat", "", start, [self.expression()], [body])

    def _loop(self, start: int) -> ProgramNode:
        body = self.block(frozenset({"endloop"}))
        self.close("endloop", start)
        return self.node("loop", "", start, [], [body])

    def _switch(self, start: int) -> ProgramNode:
        parts = [self.expression()]
        while self.kinds[self.at] == "newline":
            self.at += 1
        labels, bodies = self.cases("endswitch", lambda: self.accept(":"))
        self.close("endswitch", start)
        return self.node("switch", "", start, parts, bodies, labels)

    def _wait(self, start: int) -> ProgramNode:
        word = self.words[self.at]
        if word not in ("sec", "for"):
            raise Unexpected("SEC or FOR")
        self.at += 1
        return self.node("call", f"wait {word}", start, [self.expression()])

    def _interrupt(self, start: int) -> ProgramNode:
        if not self.accept("decl"):
            name = f"interrupt {self.identifier('ON, OFF, ENABLE or DISABLE')}"
            parts = [] if self.kinds[self.at] in ("newline", "end") else [self.expression()]
            return self.node("call", name, start, parts)
        number = self.expression()
        self.expect("when")
        condition = self.expression()
        self.expect("do")
        action = self._simple(self.starts[self.at])
        return self.node("call", "interrupt decl", start, [number, condition], [[action]])

    def _trigger(self, start: int) -> ProgramNode:
        self.expect("when")
        options: list[ProgramNode] = []
        while self.words[self.at] in ("distance", "path", "delay", "on_start", "onstart"):
            at = self.starts[self.at]
            name = self.identifier()
            parts = [self.expression()] if self.accept("=") else []
            options.append(self.node("option", name, at, parts))
        self.expect("do")
        action = self._simple(self.starts[self.at])
        if self.kinds[self.at] == "name" and self.words[self.at] == "prio":
            self.at += 1
            self.expect("=")
            self.expression()
        return self.node("call", "trigger", start, options, [[action]])

    def _spline(self, start: int) -> ProgramNode:
        name = self.words[self.at - 1]
        options = self._after_target()
        body = self.block(frozenset({"endspline"}))
        self.close("endspline", start)
        self._after_target()
        return self.node("spline", name, start, options, [body])

    def _motion(self, start: int) -> ProgramNode:
        word = self.words[self.at - 1]
        parts = [self.expression()]
        while self.accept(","):
            if self.words[self.at] == "ca":
                at = self.starts[self.at]
                self.at += 1
                parts.append(self.node("option", "ca", at, [self.expression()]))
            else:
                parts.append(self.expression())
        return self.node("call", word, start, [*parts, *self._after_target()])

    def _after_target(self) -> list[ProgramNode]:
        """Parse approximation, ``#BASE`` or ``#TOOL``, and WITH after a motion."""
        found: list[ProgramNode] = []
        while self.kinds[self.at] not in ("newline", "end"):
            at = self.starts[self.at]
            if self.accept("with"):
                while True:
                    place = self.starts[self.at]
                    target = self.primary()
                    self.expect("=")
                    value = self.expression()
                    found.append(self.node("option", "with", place, [target, value]))
                    if not self.accept(","):
                        break
            elif self.words[self.at] == "#":
                found.append(self.node("option", "frame", at, [self.primary()]))
            elif self.kinds[self.at] == "name":
                self.at += 1
                found.append(self.node("option", self.words[self.at - 1], at))
            else:
                raise Unexpected("the end of the line")
        return found

    def _simple(self, start: int) -> ProgramNode:
        """Parse an assignment, a call, a label, or a declaration without DECL."""
        if self.kinds[self.at] != "name" or (self.words[self.at] in RESERVED and not self._is_assigned()):
            raise Unexpected("a statement")
        word, follows = self.words[self.at], self.words[self.at + 1]
        if follows == ":" and self.kinds[self.at + 2] in ("newline", "end"):
            self.at += 2
            return self.node("label", word, start)
        if follows == ":" and word == "channel":
            self.at += 1
            return self._to_line_end(start)
        if (self.kinds[self.at + 1] == "name" and not (word in _BARE and follows == "f")) or (
            word in TYPES and follows == "["
        ):
            return self._declaration(start)
        if word in _BARE and (self.kinds[self.at + 1] in ("newline", "end") or follows == "f"):
            self.at += 1 + (follows == "f")
            return self.node("call", word, start)
        target = self.primary()
        if self.accept("="):
            return self.node("assign", "", start, [target, self.expression()])
        if target.kind == "call":
            return target
        raise Unexpected("'=' or '('")

    def argument(self) -> ProgramNode:
        """Read an argument, which may be left out."""
        if self.words[self.at] in (",", ")"):
            return ProgramNode("omitted", "", self.starts[self.at], self.starts[self.at])
        return self.expression()

    def primary(self) -> ProgramNode:
        """Read a literal, a name, a call, or what stands in parentheses, with what follows it."""
        found = self.literal()
        if found is not None:
            return found
        kind, word, start = self.kinds[self.at], self.words[self.at], self.starts[self.at]
        if word == "#":
            self.at += 1
            return self.node("enum", self.identifier("a value of an enumeration"), start)
        if word == "{":
            return self._aggregate(start)
        if word in ("!", "?"):  # an axis position that is to be taught
            self.at += 1
            return self.node("omitted", word, start)
        if kind != "name" or word in RESERVED:
            raise Unexpected("an expression")
        self.at += 1
        if word in ("true", "false"):
            return self.node("constant", word, start, value=word == "true")
        return self.after(self.node("name", word, start), start)

    def _aggregate(self, start: int) -> ProgramNode:
        self.at += 1
        type = ""
        if self.kinds[self.at] == "name" and self.words[self.at + 1] == ":":
            type = self.words[self.at]
            self.at += 2
        pairs = self.sequence("}", self._pair)
        return self.node("aggregate", type, start, pairs)

    def _pair(self) -> ProgramNode:
        start = self.starts[self.at]
        name = self.identifier("a component")
        if self.accept("["):
            self.sequence("]", self.index)
        return self.node("pair", name, start, [self.expression()])

    def number_of(self, word: str) -> int | float:
        """Return the value of a number, which may be of hexadecimal or binary digits."""
        if word.startswith("'"):
            return int(word[2:-1], 16 if word[1] in "hH" else 2)
        return super().number_of(word)


_READERS: dict[str, Callable[[KrlParser, int], ProgramNode]] = {
    "global": KrlParser._global, "def": KrlParser._routine, "deffct": KrlParser._routine,
    "defdat": KrlParser._routine, "decl": KrlParser._declaration, "const": KrlParser._declaration,
    "struc": KrlParser._struc, "enum": KrlParser._enum, "signal": KrlParser._signal,
    "ext": KrlParser._to_line_end, "extp": KrlParser._to_line_end, "extfctp": KrlParser._to_line_end,
    "extfct": KrlParser._to_line_end, "import": KrlParser._to_line_end,
    "if": KrlParser._if,
    "for": lambda parser, start: parser.for_loop(start, "=", 1),
    "while": lambda parser, start: parser.while_loop(start, "endwhile"), "repeat": KrlParser._repeat,
    "loop": KrlParser._loop, "switch": KrlParser._switch, "goto": KrlParser.jump,
    "return": KrlParser.leave, "exit": lambda parser, start: parser.word(start, "break"),
    **dict.fromkeys(("halt", "continue"), lambda parser, start: parser.word(start, "call")),
    "wait": KrlParser._wait, "interrupt": KrlParser._interrupt,
    "trigger": KrlParser._trigger, "spline": KrlParser._spline, "ptp_spline": KrlParser._spline,
    "cp_spline": KrlParser._spline,
    **dict.fromkeys(MOTIONS, KrlParser._motion),
}  # fmt: skip


def is_data(node: ProgramNode) -> bool:
    """Return whether a node is the DEFDAT of a data file."""
    value: Any = node.value
    return node.kind == "module" and value == "data"
