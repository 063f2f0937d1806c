"""Whatever a file contains, mutabot answers with a result or with one of its own errors."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mutabot.config.configuration import Settings, load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import ConfigurationError
from mutabot.model import Vocabulary
from mutabot.model.codec import from_data, to_data

COMMON = settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
WORDS = ["operation", "call", "arguments", "result", "patterns", "kind", "unit", "axis", "values", "text"]
WORDS += ["range", "clock", "tick", "time", "probe", "message", "mode", "current", "opposite"]
WORDS += ["signature", "overrides", "step", "argument", "self", "true"]
WORDS += ["x", ".x", "[0:3]", "[-3:]", ""]
TEXTS = [
    "",
    "x",
    "xyz",
    "m",
    "by",
    "label",
    "a:b",
    "up/{a:g}",
    "[0:3]",
    "é\n'\"{",
    "/",
    "..",
    "**",
    "mission.py",
    "self.x",
    "(x, …)",
]

scalars = st.booleans() | st.integers() | st.floats() | st.sampled_from(TEXTS)
keys = st.sampled_from(WORDS)
anything = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4),
    max_leaves=12,
)
kinds = st.sampled_from(["translation", "rotation", "opening", "position", "angle", "label", "flag"])
quantities = st.fixed_dictionaries(
    {"kind": kinds},
    optional={
        "axis": st.sampled_from(["x", "xyz", "j1", "j1..j3", "q"]),
        "unit": st.sampled_from(["m", "deg", "s", "percent"]),
        "mode": st.sampled_from(["by", "to"])
        | st.dictionaries(
            st.sampled_from(["argument", "true", "false", "{"]), st.sampled_from(["x.y", "self", "by", "to"])
        ),
        "values": st.lists(scalars, max_size=3),
        "range": st.lists(st.floats() | st.integers(), min_size=1, max_size=3),
        "noise": st.floats(),
    },
)
paths = st.sampled_from(
    ["x", "x[0:3]", "x.y", ".x", "[0]", "[0:3]", "[-3:]", "[:]", "[::2]", "[3:1]", "['k']"]
)
described = st.dictionaries(paths, quantities | anything, max_size=2)
operations = st.fixed_dictionaries(
    {"call": st.sampled_from(["a:b", "a:c"]) | scalars},
    optional={
        "arguments": described,
        "result": quantities | described | anything,
        "message": st.sampled_from(["m", "self", "self.m", "m.x", "x.", "self.["]),
        "signature": st.sampled_from(["(m, x)", "(x, …)", "(self)", "x", "(x=y)"]) | scalars,
        "overrides": scalars,
        "patterns": st.lists(quantities.map(lambda q: {"text": "up/{a:g}", **q}) | anything, max_size=2),
        "current": st.just("a:b"),
        "opposite": st.just("a:c"),
    },
)


@COMMON
@given(
    data=st.dictionaries(keys, anything, max_size=2), described=st.lists(operations | anything, max_size=3)
)
def test_any_vocabulary_is_loaded_or_refused(
    data: dict[str, Any], described: list[Any], tmp_path: Path
) -> None:
    write(tmp_path / "robot.toml", {**data, "operation": described})
    found: list[Vocabulary] = []
    error = refusal(lambda: found.append(load_vocabulary(["robot.toml"], tmp_path)))
    assert error is None or str(error).startswith("robot.toml")
    for vocabulary in found:
        assert from_data(Vocabulary, json.loads(json.dumps(to_data(vocabulary)))) == vocabulary
        for operation in vocabulary.operations:
            assert set(operation.described) >= {argument.path.root for argument in operation.arguments}
            assert all(pattern.name for pattern in operation.patterns)


@COMMON
@given(data=st.dictionaries(st.sampled_from([*Settings.model_fields, "root", "file"]), anything, max_size=5))
def test_any_configuration_is_loaded_or_refused(data: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "mission.py").touch()
    write(tmp_path / "mutabot.toml", {"program": ["mission.py"], "vocabulary": ["a"], "tests": ["."], **data})
    error = refusal(lambda: load_configuration(tmp_path))
    assert error is None or str(error).startswith("mutabot.toml:")


def refusal(action: Callable[[], Any]) -> ConfigurationError | None:
    try:
        action()
    except ConfigurationError as error:
        return error
    return None


def write(path: Path, data: dict[str, Any]) -> None:
    lines = [f"{text(key)} = {toml(item)}" for key, item in data.items()]
    path.write_text("\n".join(lines), encoding="utf-8")


def toml(value: Any) -> str:
    """A value as TOML prints it in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{text(key)} = {toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, str):
        return text(value)
    return str(value).lower() if isinstance(value, bool) else repr(value)


def text(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
