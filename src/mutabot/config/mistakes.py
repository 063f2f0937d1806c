"""Report mistakes in TOML files: file, line, key and the valid alternatives."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from mutabot.errors import ConfigurationError, UnknownNameError, nearest_name, shortened, unknown_name_text

from .document import Document, KeyPath

if TYPE_CHECKING:
    from mutabot.model.events import Problem

M = TypeVar("M", bound=BaseModel)
P = ParamSpec("P")
T = TypeVar("T")

#: more than these are not listed one by one
MOST_REPORTED = 10

#: what people call things for which vocabularies have other words
_ALSO_CALLED = {
    **{"roll": "x", "pitch": "y", "yaw": "z", "relative": "by", "absolute": "to"},
    **{"meters": "m", "metres": "m", "millimeters": "mm", "degrees": "deg", "seconds": "s"},
    **{"color": "label", "colour": "label", "joint": "angle", "gripper": "opening", "transform": "tf"},
}
#: keys of the configuration that there were, and why there are none any more
_GONE = dict.fromkeys(("order", "pairs"), "a mutant is one fault, no pair of them")
#: what is expected, by how the kind of pydantic's mistake begins
_EXPECTED = {
    "string": "text",
    "bool": "true or false",
    "int": "a whole number",
    "float": "a number",
    "finite": "a finite number",
    "list": "a list",
    "tuple": "a list",
    "dict": "a table",
    "model": "a table",
}
_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}


_LENGTHS = {"too_short": ("at least", "min_length"), "too_long": ("at most", "max_length")}


@dataclass(frozen=True)
class DocumentPlace:
    """A place in a document under inspection; ``place / "key"`` is one inside it.

    All places of a document collect their mistakes in one list, so that all can be reported at once.
    """

    document: Document
    errors: list[ConfigurationError] = field(default_factory=list)
    path: KeyPath = ()

    def __truediv__(self, key: str | int) -> DocumentPlace:
        return replace(self, path=(*self.path, key))

    def each(self, raw: Any) -> list[tuple[DocumentPlace, Any]]:
        """Return the items of a list with their places; any other value counts as the only item."""
        if not isinstance(raw, list):
            return [(self, raw)]
        return [(self / index, item) for index, item in enumerate(raw)]

    def source(self, name: str) -> str:
        """Return where something is described: ``robot.toml:12 · robot:Arm.move_by``."""
        line = self.document.line(self.path)
        return f"{self.document.file}{f':{line}' if line is not None else ''} · {name}"

    def error(self, problem: str) -> None:
        """Note a mistake."""
        self.errors.append(self.document.error(self.path, problem))

    def unknown(self, kind: str, name: str, known: Iterable[str]) -> None:
        """Note a name that does not exist."""
        document, meant = self.document, _ALSO_CALLED.get(name.casefold())
        known = list(known)
        text = unknown_name_text(kind, name, known, meant if meant in known else None)
        key = document.key(self.path)
        self.errors.append(UnknownNameError(text, file=document.file, key=key, line=document.line(self.path)))

    def attempt(self, read: Callable[P, T], *given: P.args, **named: P.kwargs) -> T | None:
        """Call ``read``; note the ValueError that it raises as a mistake, and return None."""
        try:
            return read(*given, **named)
        except ValueError as error:
            self.error(str(error))
            return None

    def table(
        self, model: type[M], raw: Any, *, salvage: bool = False, also: Collection[str] = ()
    ) -> M | None:
        """Validate ``raw`` as a ``model``; note its mistakes and return None if it has any.

        With ``salvage``, keys with mistakes are left out and the others validated once more. ``also``: keys
        that may stand beside the model's.
        """
        try:
            return model.model_validate(raw)
        except ValidationError as error:
            details = error.errors(include_url=False)
        self._explain(details, [*model.model_fields, *also])
        bad = {detail["loc"][0] for detail in details if detail["loc"]}
        if not salvage or not isinstance(raw, dict):
            return None
        try:
            return model.model_validate({key: value for key, value in raw.items() if key not in bad})
        except ValidationError:
            return None

    def _explain(self, details: list[ErrorDetails], keys: list[str]) -> None:
        extras = [str(detail["loc"][-1]) for detail in details if detail["type"] == "extra_forbidden"]
        meant = {nearest_name(extra, keys) for extra in extras}
        for detail in details:
            at = replace(self, path=self.path + detail["loc"])
            name = str(at.path[-1]) if at.path else ""
            match detail["type"]:
                case "extra_forbidden" if name in _GONE and "program" in keys:
                    at.error(f"the key {name!r} is gone: {_GONE[name]}")
                case "extra_forbidden":
                    at.unknown("key", name, keys)
                case "enum" | "literal_error" if isinstance(detail["input"], str):
                    at.unknown(name, detail["input"], re.findall(r"'([^']*)'", detail["ctx"]["expected"]))
                case "missing" if name not in meant:
                    replace(at, path=at.path[:-1]).error(f"the key {name!r} is missing")
                case other if other != "missing":
                    at.error(explained(detail))


def explained(detail: ErrorDetails) -> str:
    """Return a sentence about a mistake that pydantic found, in the terms of the file."""
    kind, value = detail["type"], detail["input"]
    if kind in ("enum", "literal_error"):
        return f"expected text, got {shown(value)}; known: {detail['ctx']['expected']}"
    if (wanted := _EXPECTED.get(kind.partition("_")[0])) is not None:
        return f"expected {wanted}, got {shown(value)}{_list_hint(detail)}"
    if kind in _BOUNDS:
        bound, condition = _BOUNDS[kind]
        return f"must be {condition} {detail['ctx'][bound]}, got {shown(value)}"
    if kind in _LENGTHS:
        found, (wanted, bound) = detail["ctx"]["actual_length"], _LENGTHS[kind]
        return f"needs {wanted} {detail['ctx'][bound]} entries, got {found}" if found else "must not be empty"
    if kind == "value_error":  # our own validators say it all
        return str(detail["ctx"]["error"])
    return f"{shown(value)} does not fit here"


def _list_hint(detail: ErrorDetails) -> str:
    if detail["type"] not in ("list_type", "tuple_type") or not detail["loc"]:
        return ""
    key, value = detail["loc"][-1], detail["input"]
    if isinstance(value, dict):
        return f"; write [[{key}]] with double brackets"
    return f'; write {key} = ["{value}"]' if isinstance(value, str) else ""


def shown(value: Any) -> str:
    """Return a value of a TOML file as text."""
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
    """Raise the first error in the order of the files' lines; its message mentions the others as well."""
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
    """Return the error for a problem that was noticed beside the robot program.

    ``problem.text`` is either a sentence or, if it does not mention the name that is wrong, what kind
    of name it is (``argument``).
    """
    where: dict[str, Any] = {"file": problem.source or None, "key": problem.key or None}
    name, text = problem.name, problem.text
    if name is None:
        return ConfigurationError(text, **where)
    if name not in text:
        return UnknownNameError(unknown_name_text(text, name, problem.known), **where)
    if ";" not in text and problem.known:  # the text of an unknown name ends with what would be right
        text += ";" + unknown_name_text("", name, problem.known).partition(";")[2]
    return UnknownNameError(text, **where)
