"""The text of docs/configuration.md, from the settings and our packages' tables: types, texts, defaults."""

from __future__ import annotations

import ast
import inspect
import json
from collections.abc import Iterator, Mapping
from itertools import pairwise
from textwrap import dedent
from typing import Any

from mutabot.config.configuration import Settings
from mutabot.config.table import Table
from mutabot.extensions import GROUP, brought

HEAD = """\
# Which settings are there?

<!-- Written by tools/make_docs.py from src/mutabot/config/configuration.py and others. Do not edit. -->

The settings stand in `pyproject.toml` under `[tool.mutabot]`, or in `mutabot.toml` without that heading;
`mutabot init` proposes them. Paths are relative to the project's folder and must stay in it. For one command:
`mutabot run -o rounds=5 -o when=once`.

```toml
[tool.mutabot]
program = ["mission.py"]
vocabulary = ["robot.toml"]
```
"""


#: kinds of values that an example shows
_SHOWN = {"list of texts", "text", "table", "tables, with double brackets", "`true` or `false`"}


#: defaults that go without saying
_NONE = {"none", "`[]`"}


def page() -> str:
    """The text of the page."""
    tables = tables_of_ours()
    lines = [HEAD.rstrip(), *_texts_of(Settings)]
    for name, table in tables.items():
        lines += [
            "",
            f"## {name}",
            "",
            f"{inspect.cleandoc(table.__doc__ or '')} Below `[tool.mutabot.{name}]`:",
            *_texts_of(table, name),
        ]
    return "\n".join([*lines, ""])


def tables_of_ours() -> dict[str, type[Table]]:
    """The tables that packages in this repository bring, by name."""
    parts = brought("tables").items()
    return {name: part.load_class(Table) for name, part in parts if part.owner == GROUP}


def _texts_of(model: type[Table], table: str = "") -> Iterator[str]:
    schema = model.model_json_schema()
    for key, (text, example) in documented(model).items():
        name = f"{table}.{key}" if table else key
        yield from ("", f"{'###' if table else '##'} {name}", "", text, "")
        values, default = values_of(schema["properties"][key], schema), _default(model, key)
        told = [] if values in _SHOWN else [values]
        told += [] if default in _NONE else [f"default: {default}"]
        if "\n" in example:
            yield from (*told, "", "```toml", example, "```")
        else:
            yield f"`{example}`" + (f" ({'; '.join(told)})" if told else "")


def documented(model: type[Table]) -> dict[str, tuple[str, str]]:
    """The text and the example below each key."""
    tree = ast.parse(dedent(inspect.getsource(model)))
    body = tree.body[0].body if isinstance(tree.body[0], ast.ClassDef) else []
    found = dict(_texts(body))
    missing = [key for key in model.model_fields if key not in found]
    if missing:
        raise ValueError(
            f"a text with an example is missing below {', '.join(missing)} in {model.__module__}"
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
        return next(values_of(part, whole) for part in schema["anyOf"] if part.get("type") != "null")
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
            return _bounds(schema, "whole number")
        case "number":
            return _bounds(schema, "number")
    raise ValueError(f"no words for {schema}")


def _bounds(schema: Mapping[str, Any], name: str) -> str:
    low, over, high = (schema.get(key) for key in ("minimum", "exclusiveMinimum", "maximum"))
    if over is not None:
        return f"above {over:g}{f', at most {high:,}' if high is not None else ''}"
    if low is not None and high is not None:
        return f"{low:,} to {high:,}"
    if high is not None:
        return f"at most {high:,}"
    return f"from {low:g}" if low is not None else name


def _default(model: type[Table], key: str) -> str:
    field = model.model_fields[key]
    if field.is_required():
        return "none; the key is required"
    if field.default is None:
        return "none"
    if key == "memory":
        return f'`"{field.default / 1e9:g} GB"`'
    return f"`{json.dumps(field.default)}`"
