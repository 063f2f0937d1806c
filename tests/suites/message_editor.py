"""Mutants of what goes under a name over ROS, as edits of the nodes' source text.

As ``editor.py``: from the documented meaning of each operator, without Mutabot. The call that a mutant is
about stands in the program; the call of the client library may stand in a file that the program uses, which
``judge.toml`` tells under ``[raw]``. Then both are edited: the second only acts below the first.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from fnmatch import fnmatchcase
from typing import Any

from .catalogue_editor import catalogue_edits
from .editor import DEVIATIONS, UNITS, CannotWriteError, Edit, Facts, Source, edits_for

MESSAGES = '__import__("_planted_messages")'
VALUES = '__import__("_planted")'
#: by form: the key of an entry of the vocabulary that names it, and those of what it writes and reads
_ENTRIES = {"publish": ("topic", "fields"), "receive": ("topic", "fields"), "call": ("service", "request")}
#: by form that sets something up: where the name stands among the arguments of ROS 1 and ROS 2
_NAMES = {"advertise": ((0, "name"), (1, "topic")), "subscribe": ((0, "name"), (1, "topic")),
          "client": ((0, "name"), (1, "srv_name"))}  # fmt: skip
#: by variant of wrong-deadline: seconds
_DEADLINES = {"tight": 0.001, "none": None}


def edits_of(facts: Facts, mutant: Mapping[str, Any]) -> list[Edit]:
    """The edits that make any mutant.

    Raises CannotWriteError where the editors know none.
    """
    if not is_named(mutant):
        if mutant["family"] == "catalogue":
            return catalogue_edits(facts, Source(facts.folder / mutant["file"], mutant["file"]), mutant)
        return edits_for(facts, mutant)
    return MessageEditor(facts, Source(facts.folder / mutant["file"], mutant["file"]), mutant).edits()


def is_named(mutant: Mapping[str, Any]) -> bool:
    """Whether a mutant is about something under a name; callables have no blank in theirs."""
    return " " in mutant["operation"]


class MessageEditor:
    """Writes the edits of one mutant of something under a name."""

    def __init__(self, facts: Facts, source: Source, mutant: Mapping[str, Any]) -> None:
        self.facts, self.source, self.mutant = facts, source, mutant
        target = mutant["operation"].partition(" of ")[0]
        self.form, _, self.name = target.partition(" ")
        self.target = target
        self.variant = mutant["variant"].removesuffix(f"+{target}")

    def edits(self) -> list[Edit]:
        """The edits.

        Raises CannotWriteError where this editor knows none.
        """
        if self.form == "parameter":
            raise CannotWriteError("what a parameter reads")
        method: Callable[[], str] | None = getattr(
            self, "_" + self.mutant["operator"].replace("-", "_"), None
        )
        if method is None:
            raise CannotWriteError(f"operator {self.mutant['operator']} on a message")
        return self._wrapping(method())

    def _wrapping(self, wrapper: str) -> list[Edit]:
        """The calls' edits; ``wrapper`` is the text of a function that takes a callable and gives another."""
        definition = self._definition()
        if definition is not None:
            if not wrapper.startswith(f"{MESSAGES}.with_reply("):
                raise CannotWriteError("only what a callback is given can be changed at its definition")
            start, _ = self.source.range(definition)
            indentation = " " * definition.col_offset
            return [Edit(self.source.name, start, start, f"@{MESSAGES}.given({wrapper})\n{indentation}")]
        call = self._call_of_the_program()
        file, text = self.facts.hints.get("raw", {}).get(self.target, (None, None))
        if file is None:
            return [self._replaced(self.source, call.func, f'{MESSAGES}.armed("site", {wrapper}(', "))")]
        raw = Source(self.facts.folder / file, file)
        found = [node for node in raw.nodes(ast.Call) if " ".join(raw.text(node).split()) == text]
        if not found:
            raise CannotWriteError(f"{file} does not say {text}")
        below = f'{MESSAGES}.only_below("site", '
        return [
            self._replaced(self.source, call.func, f'{MESSAGES}.armed("site", ', ")"),
            *(self._replaced(raw, wrapped.func, below, f", {wrapper})") for wrapped in found),
        ]

    def _definition(self) -> ast.FunctionDef | None:
        """The callback that the mutant is about, if it stands at one."""
        line = self.mutant["span"]["line"]
        found = (node for node in self.source.nodes(ast.FunctionDef) if node.lineno == line)
        return next(found, None) if self.form == "receive" else None

    def _call_of_the_program(self) -> ast.Call:
        span = self.mutant["span"]
        return self.source.call_ending(span["end_line"], span["end_column"] - 1)

    @staticmethod
    def _replaced(source: Source, node: ast.AST, before: str, after: str) -> Edit:
        return Edit(source.name, *source.range(node), f"{before}{source.text(node)}{after}")

    # the operators of the family robot

    def _skip(self) -> str:
        answer = "None" if self.form == "publish" else self.facts.hints.get("idle", {}).get(self.target)
        if answer is None:
            raise CannotWriteError("judge.toml does not say what is answered when it is left out")
        return f"{MESSAGES}.nothing(lambda: {answer})"

    def _repeat(self) -> str:
        return f"{VALUES}.twice"

    def _reverse(self) -> str:
        quantity = self._quantity()
        if "range" in quantity or quantity.get("mode") == "to":
            raise CannotWriteError("reverse within a range, or of a target")
        return self._with(f"{VALUES}.negative")

    def _opposite(self) -> str:
        first, second = self._quantity()["values"]
        return self._with(f"{VALUES}.partial({VALUES}.other, { {first: second, second: first}!r})")

    def _negate(self) -> str:
        return self._with(f"{VALUES}.negative")

    def _noise(self) -> str:
        quantity = self._quantity()
        amount, unit = DEVIATIONS[quantity["kind"]]
        deviation = quantity.get("noise", amount * UNITS[unit] / UNITS[quantity["unit"]])
        return self._with(f"{VALUES}.partial({VALUES}.noisy, {deviation!r})")

    def _misread(self) -> str:
        values = self._quantity().get("values") or [False, True]
        shift = int(self.variant or "1")
        pairs = {value: values[(index + shift) % len(values)] for index, value in enumerate(values)}
        return self._with(f"{VALUES}.partial({VALUES}.other, {pairs!r})")

    # those of the family middleware

    def _drop(self) -> str:
        if self.form == "receive":
            return f"{MESSAGES}.coming({MESSAGES}.but_lost({self.variant!r}))"
        without = f"{MESSAGES}.nothing(lambda: None)"
        if self.form == "call":
            without = f"{MESSAGES}.unanswered(False)"
        return f"{MESSAGES}.lost({self.variant!r}, {without})"

    def _duplicate(self) -> str:
        return "(lambda function: function)" if self.form == "receive" else f"{VALUES}.twice"

    def _stale(self) -> str:
        return f"{MESSAGES}.{self._direction()}({MESSAGES}.stale({self.variant!r}))"

    def _delay(self) -> str:
        clock = self.facts.hints.get("clock")
        kind = {"publish": "sent", "receive": "come"}.get(self.form, "asked")
        return f"{MESSAGES}.{kind}_late({self.variant}, {f'lambda: {clock}' if clock else 'None'})"

    def _reorder(self) -> str:
        if self.form == "receive":
            return f"{MESSAGES}.coming({MESSAGES}.swapped)"
        return f"{MESSAGES}.held_back()"

    def _kill_node(self) -> str:
        return f"{MESSAGES}.dies(False)"

    def _restart_node(self) -> str:
        return f"{MESSAGES}.dies(True)"

    def _lose_answer(self) -> str:
        return f"{MESSAGES}.unanswered(True)"

    def _wrong_name(self) -> str:
        if self.variant != "misspelt":
            raise CannotWriteError("a name without its namespace")
        place, word = _NAMES[self.form][self._is_ros2()]
        return f"{MESSAGES}.misspelt({place}, {word!r})"

    def _short_queue(self) -> str:
        return f"{MESSAGES}.{'quality(depth=1)' if self._is_ros2() else 'with_settings(queue_size=1)'}"

    def _flip_latch(self) -> str:
        if self._is_ros2():
            raise CannotWriteError("ROS 2 has no latch")
        return f"{MESSAGES}.other_latch"

    def _wrong_reliability(self) -> str:
        return f"{MESSAGES}.other_quality('reliability', 'RELIABLE', 'BEST_EFFORT')"

    def _wrong_durability(self) -> str:
        return f"{MESSAGES}.other_quality('durability', 'VOLATILE', 'TRANSIENT_LOCAL')"

    def _wrong_deadline(self) -> str:
        return f"{MESSAGES}.with_deadline({_DEADLINES[self.variant]})"

    # what they are made of

    def _is_ros2(self) -> bool:
        return bool(self.facts.hints.get("ros2"))

    def _direction(self) -> str:
        return "with_reply" if self.form == "receive" else "with_message"

    def _with(self, change: str) -> str:
        path = self.mutant["quantity"]
        return f"{MESSAGES}.{self._direction()}({MESSAGES}.field({path!r}, {change}))"

    def _quantity(self) -> dict[str, Any]:
        key, fields = _ENTRIES[self.form]
        for file in self.facts.vocabulary:
            for operation in file.get("operation", []):
                is_this = key in operation and fnmatchcase(self.name, operation[key])
                if is_this and operation.get("direction", self.form) == self.form:
                    found = operation.get(fields, {}).get(self.mutant["quantity"])
                    if found is not None:
                        return dict(found)
        raise CannotWriteError(f"no field {self.mutant['quantity']} of {self.target}")


def noting_refusals(facts: Facts) -> list[Edit]:
    """Edits that note where the client hears that the robot refuses, as ``judge.toml`` tells it."""
    edits = []
    for file, text, condition in facts.hints.get("refused", []):
        source = Source(facts.folder / file, file)
        for node in source.nodes(ast.expr):
            if source.text(node) == text:
                told = f"{MESSAGES}.hearing({text}, lambda message: {condition})"
                edits.append(Edit(file, *source.range(node), told))
    return edits
