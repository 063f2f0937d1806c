"""Mistakes in TOML files, told in the user's words: file, line, key and what would have worked."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from mutabot.errors import ConfigurationError, UnknownNameError, nearest_name, unknown_name_text
from mutabot.limits import shortened
from mutabot.model.events import Problem

from .document import Document
from .toml_lines import KeyPath

M = TypeVar("M", bound=BaseModel)

#: more than these are not listed one by one
MOST_REPORTED = 10

#: what people call it -> what it is called here
ALSO_KNOWN_AS: Mapping[str, Mapping[str, str]] = {
    "unit": {
        **dict.fromkeys(("meter", "meters", "metre", "metres"), "m"),
        **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
        **dict.fromkeys(("centimeter", "centimeters", "centimetre", "centimetres"), "cm"),
        **dict.fromkeys(("degree", "degrees", "°"), "deg"),
        **dict.fromkeys(("radian", "radians"), "rad"),
        **dict.fromkeys(("sec", "second", "seconds"), "s"),
        **dict.fromkeys(("msec", "millisecond", "milliseconds"), "ms"),
        **dict.fromkeys(("%", "per cent"), "percent"),
        **dict.fromkeys(("ratio", "1"), "fraction"),
    },
    "kind": {
        **dict.fromkeys(("color", "colour", "text", "string", "enum"), "label"),
        **dict.fromkeys(("bool", "boolean"), "flag"),
        **dict.fromkeys(("gripper", "grip"), "opening"),
        **dict.fromkeys(("joint", "joint angle"), "angle"),
        **dict.fromkeys(("time", "wait"), "duration"),
        **dict.fromkeys(("range", "length"), "distance"),
    },
    "mode": {
        **dict.fromkeys(("relative", "rel", "incremental"), "by"),
        **dict.fromkeys(("absolute", "abs"), "to"),
    },
    "axis": {"roll": "x", "pitch": "y", "yaw": "z"},
}

#: keys of the configuration that there were, and why there are none any more
_GONE = dict.fromkeys(("order", "pairs"), "a mutant is one fault, no pair of them")
_EXPECTED = {
    "string_type": "text",
    "bool_type": "true or false",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "finite_number": "a finite number",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
}
_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_SOURCE = re.compile(r"(?P<file>.+?)(?::(?P<line>\d+))?(?: · (?P<key>.*))?")


@dataclass
class Check:
    """One document under inspection; mistakes are collected, so that all can be told at once."""

    document: Document
    errors: list[ConfigurationError] = field(default_factory=list)

    def source(self, place: KeyPath, name: str) -> str:
        """Where something is described: ``robot.toml:12 · robot:Arm.move_by``."""
        line = self.document.line(place)
        return f"{self.document.file}{f':{line}' if line is not None else ''} · {name}"

    def error(self, place: KeyPath, problem: str) -> None:
        """Note a mistake."""
        self.errors.append(self.document.error(place, problem))

    def unknown(self, place: KeyPath, kind: str, name: str, known: Iterable[str]) -> None:
        """Note a name that does not exist."""
        known = list(known)
        document = self.document
        where: dict[str, Any] = {
            "file": document.file,
            "key": document.key(place),
            "line": document.line(place),
        }
        error = UnknownNameError(kind, name, known, **where)
        alias = ALSO_KNOWN_AS.get(kind, {}).get(name.casefold())
        if alias in known:
            error.nearest = alias
            _reword(error, f"unknown {kind} {name!r}; did you mean {alias!r}?")
        self.errors.append(error)

    def table(
        self,
        model: type[M],
        raw: Any,
        place: KeyPath,
        *,
        salvage: bool = False,
        also: Collection[str] = (),
    ) -> M | None:
        """``raw`` as a ``model``; None if it has mistakes, which are noted.

        With ``salvage``, what is sound comes back all the same where that makes sense. ``also``: keys that
        there are beside the model's.
        """
        try:
            return model.model_validate(raw)
        except ValidationError as error:
            details = error.errors(include_url=False)
        self._explain(details, model, place, also)
        if not salvage or not isinstance(raw, dict):
            return None
        bad = {detail["loc"][0] for detail in details if detail["loc"]}
        try:
            return model.model_validate({key: value for key, value in raw.items() if key not in bad})
        except ValidationError:
            return None

    def _explain(
        self, details: list[ErrorDetails], model: type[BaseModel], place: KeyPath, also: Collection[str]
    ) -> None:
        keys = [*known_keys(model), *also]
        extras = [str(detail["loc"][-1]) for detail in details if detail["type"] == "extra_forbidden"]
        meant = {nearest_name(extra, keys) for extra in extras}
        for detail in details:
            where = place + detail["loc"]
            name = str(where[-1]) if where else ""
            if detail["type"] == "extra_forbidden" and name in _GONE and "program" in keys:
                self.error(where, f"the key {name!r} is gone: {_GONE[name]}")
            elif detail["type"] == "extra_forbidden":
                self.unknown(where, "key", name, keys)
            elif detail["type"] == "enum":
                self._explain_enum(where, name, detail, model)
            elif detail["type"] != "missing":
                self.error(where, explained(detail))
            elif name not in meant:
                self.error(where[:-1], f"the key {name!r} is missing")

    def _explain_enum(self, where: KeyPath, name: str, detail: ErrorDetails, model: type[BaseModel]) -> None:
        value = detail["input"]
        known = re.findall(r"'([^']*)'", detail["ctx"]["expected"])
        if isinstance(value, str):
            self.unknown(where, name, value, known)
        else:
            self.error(where, f"expected text, got {shown(value)}; known: {', '.join(known)}")


def known_keys(model: type[BaseModel]) -> list[str]:
    """The keys a table may have."""
    return [info.alias or name for name, info in model.model_fields.items()]


def explained(detail: ErrorDetails) -> str:
    """One sentence for a mistake that pydantic found, in the words of the files' authors."""
    kind, value = detail["type"], detail["input"]
    if kind in _EXPECTED:
        return f"expected {_EXPECTED[kind]}, got {shown(value)}{_list_hint(detail)}"
    if kind in _BOUNDS:
        bound, words = _BOUNDS[kind]
        return f"must be {words} {detail['ctx'][bound]}, got {shown(value)}"
    if kind in ("too_short", "too_long"):
        return _length_text(detail)
    if kind == "mutabot":  # our own validators say it all
        return detail["msg"]
    return f"{shown(value)} does not fit here"


def _length_text(detail: ErrorDetails) -> str:
    context = detail["ctx"]
    least, most = context.get("min_length"), context.get("max_length")
    wanted = f"at least {least}" if least is not None else f"at most {most}"
    found = context["actual_length"]
    return "must not be empty" if found == 0 else f"needs {wanted} entries, got {found}"


def _list_hint(detail: ErrorDetails) -> str:
    if detail["type"] not in ("list_type", "tuple_type") or not detail["loc"]:
        return ""
    key, value = detail["loc"][-1], detail["input"]
    if isinstance(value, dict):
        return f"; write [[{key}]] with double brackets"
    return f'; write {key} = ["{value}"]' if isinstance(value, str) else ""


def shown(value: Any) -> str:
    """A value of a TOML file, in words."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return f"the number {value}"
    if isinstance(value, str):
        return f"the text {shortened(value)!r}"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return "a list"
    return f"the {type(value).__name__} {value}"


def raise_errors(errors: list[ConfigurationError]) -> None:
    """Raise the first error in the order of the files' lines, telling about the others as well."""
    if not errors:
        return
    files = list(dict.fromkeys(error.file for error in errors))
    errors = sorted(errors, key=lambda error: (files.index(error.file), error.line or 0))
    first = errors[0]
    lines = [str(error) for error in errors[:MOST_REPORTED]]
    if len(errors) > MOST_REPORTED:
        lines.append(f"… and {len(errors) - MOST_REPORTED} more")
    first.args = ("\n".join(lines),)
    raise first


def problem_error(problem: Problem) -> ConfigurationError:
    """The error for a problem that was noticed beside the robot program.

    ``problem.text`` is either a sentence or, if it does not mention the name that is wrong, what kind
    of name it is (``argument``).
    """
    source = _SOURCE.fullmatch(problem.source)
    line = source["line"] if source else None
    key = " · ".join(part for part in (source["key"] if source else None, problem.key) if part)
    where: dict[str, Any] = {
        "file": (source["file"] if source else problem.source) or None,
        "key": key or None,
        "line": int(line) if line else None,
    }
    if problem.name is None:
        return ConfigurationError(problem.text, **where)
    error = UnknownNameError(problem.text, problem.name, problem.known, **where)
    if problem.name in problem.text:
        _reword(error, problem.text + "".join(_hint(problem)))
    return error


def _hint(problem: Problem) -> Iterator[str]:
    # unknown_name_text knows how to end such a sentence: "…; did you mean 'x'?"
    if ";" not in problem.text and problem.known and problem.name is not None:
        yield ";" + unknown_name_text("", problem.name, problem.known).partition(";")[2]


def _reword(error: ConfigurationError, text: str) -> None:
    ConfigurationError.__init__(error, text, file=error.file, key=error.key, line=error.line)
