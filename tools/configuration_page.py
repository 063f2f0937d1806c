"""The text of docs/configuration.md, from the settings themselves: their types, defaults and texts."""

from __future__ import annotations

import ast
import inspect
import json
from collections.abc import Iterator, Mapping
from itertools import pairwise
from textwrap import dedent
from typing import Any

from mutabot.settings.configuration import Settings

HEAD = """\
# Which settings are there?

<!-- Written by tools/make_docs.py from src/mutabot/settings/configuration.py. Do not edit. -->

The configuration stands in `pyproject.toml` under `[tool.mutabot]`, or in `mutabot.toml`, there without that
heading. `mutabot init` proposes one. An unknown key or a wrong value is an error that names the line and the
nearest key. Paths are relative to the project's folder, in which the file lies, and must not lead out of it.
`-o KEY=VALUE` sets a key for one command: `mutabot run -o rounds=5 -o when=once`.

```toml
[tool.mutabot]
program = ["mission.py"]
vocabulary = ["robot.toml"]
rounds = 5
```
"""


def page() -> str:
    """The text of the page."""
    texts = documented()
    schema = Settings.model_json_schema()
    lines = [HEAD, "| key | value | default |", "|---|---|---|"]
    for key in Settings.model_fields:
        values, default = values_of(schema["properties"][key], schema), _default(key)
        lines.append(f"| [`{key}`](#{key}) | {values} | {default} |")
    for key in Settings.model_fields:
        text, example = texts[key]
        lines += ["", f"## {key}", "", text, "", "```toml", example, "```"]
    return "\n".join([*lines, ""])


def documented() -> dict[str, tuple[str, str]]:
    """The text and the example below each key."""
    tree = ast.parse(dedent(inspect.getsource(Settings)))
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    found = dict(_texts(body))
    missing = [key for key in Settings.model_fields if key not in found]
    if missing:
        raise ValueError(
            f"a text with an example is missing below {', '.join(missing)} in {Settings.__module__}"
        )
    return found


def _texts(body: list[ast.stmt]) -> Iterator[tuple[str, tuple[str, str]]]:
    for statement, below in pairwise(body):
        if not isinstance(statement, ast.AnnAssign) or not isinstance(statement.target, ast.Name):
            continue
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            text, _, example = inspect.cleandoc(str(below.value.value)).partition("\n\n")
            if example:
                yield statement.target.id, (text, dedent(example))


def values_of(schema: Mapping[str, Any], whole: Mapping[str, Any]) -> str:
    """What a key takes, in words."""
    if schema.get("title") == "Memory":
        return 'text such as `"512 MiB"`, or bytes'
    if "anyOf" in schema:
        return next(values_of(one, whole) for one in schema["anyOf"] if one.get("type") != "null")
    if "enum" in schema:
        return " or ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    match schema.get("type"):
        case "array":
            items = schema.get("items", {})
            if items.get("type") == "object":
                return "tables, with double brackets"
            return f"list of {values_of(items, whole)}" if "enum" in items else "list of texts"
        case "object":
            return "table"
        case "string":
            return "text"
        case "boolean":
            return "`true` or `false`"
        case "integer":
            return f"whole number{_bounds(schema)}"
        case "number":
            return f"number{_bounds(schema)}"
    raise ValueError(f"no words for {schema}")


def _bounds(schema: Mapping[str, Any]) -> str:
    low, over, high = (schema.get(key) for key in ("minimum", "exclusiveMinimum", "maximum"))
    if over is not None:
        return f" above {over:g}{f', at most {high:,}' if high is not None else ''}"
    if low is not None and high is not None:
        return f" from {low:,} to {high:,}"
    if high is not None:
        return f", at most {high:,}"
    return f" from {low:g}" if low is not None else ""


def _default(key: str) -> str:
    field = Settings.model_fields[key]
    if field.is_required():
        return "must be given"
    if field.default is None:
        return "none"
    if key == "memory":
        return f'`"{field.default / 1e9:g} GB"`'
    return f"`{json.dumps(field.default)}`"
