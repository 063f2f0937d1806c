"""ROS arguments of a command line: remapping, parameters, log levels."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import yaml

from ros_in_process.middleware.names import expanded
from ros_in_process.middleware.records import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError

SEVERITIES = {"UNSET": 0, "DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
_SWITCHES = {
    f"--{word}-{what}-logs": (attribute, word == "enable")
    for word in ("enable", "disable")
    for what, attribute in (
        ("rosout", "has_rosout"),
        ("stdout", "has_console"),
        ("external-lib", "has_library"),
    )
}


_NAME = re.compile(r"[\w/~{}:*\\]+")


@dataclass
class RemapRule:
    """A remapping rule `node:match:=replacement`."""

    node: str | None
    match: str
    replacement: str


@dataclass
class Arguments:
    """The ROS arguments of a command line, in order."""

    remaps: list[RemapRule] = field(default_factory=list)
    parameters: list[tuple[str, str, Any]] = field(default_factory=list)  # pattern of nodes, name, value
    levels: dict[str, int] = field(default_factory=dict)
    has_rosout: bool = True
    has_console: bool = True
    has_library: bool = True  # a log file, which is not written here
    others: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)

    def remapped(self, key: str, node: str) -> str | None:
        """Return the name that a rule gives a node instead of `__node` or `__ns`; None without a rule."""
        keys = {"__node", "__name"} if key == "__node" else {key}
        for rule in self.remaps:
            if rule.match in keys and rule.node in {None, node}:
                return rule.replacement
        return None

    def resolved(self, full: str, node: str, namespace: str, scheme: str) -> str | None:
        """Return the name that a rule gives a topic or service; None if no rule applies."""
        for rule in self.remaps:
            prefix, _, match = rule.match.rpartition("://")
            if rule.match.startswith("__") or rule.node not in {None, node} or prefix not in {"", scheme}:
                continue
            if expanded(match, node, namespace) == full:
                return expanded(rule.replacement.rpartition("://")[2], node, namespace)
        return None

    def parameters_of(self, full_name: str) -> dict[str, Any]:
        """Return the parameters that the arguments set for a node; later ones win."""
        return {name: value for pattern, name, value in self.parameters if _fits(full_name, pattern)}


def _fits(full_name: str, pattern: str) -> bool:
    if not pattern.startswith("/"):
        pattern = "/" + pattern
    if pattern == "/**":
        return True
    if "**" in pattern:
        return fnmatchcase(full_name, pattern.replace("/**/", "/*").replace("**", "*"))
    return full_name.count("/") == pattern.count("/") and fnmatchcase(full_name, pattern)


def parse(words: list[str]) -> Arguments:
    """Read a command line. Raises RCLInvalidROSArgsError if an argument is invalid."""
    found, rest, is_inside = Arguments(), iter(words), False
    for word in rest:
        if not is_inside:
            if word == "--ros-args":
                is_inside = True
            else:
                found.others.append(word)
        elif word == "--":
            is_inside = False
        elif word != "--ros-args":
            _read_option(found, word, rest)
    return found


def _read_option(found: Arguments, word: str, rest: Iterator[str]) -> None:
    option = _OPTIONS.get(word)
    if option is not None:
        what, read = option
        value = next(rest, None)
        if value is None:
            raise RCLInvalidROSArgsError(
                f"Failed to parse ROS arguments: Couldn't parse trailing {word} flag. {what}"
            )
        read(found, word, value)
    elif word in _SWITCHES:
        attribute, is_on = _SWITCHES[word]
        setattr(found, attribute, is_on)
    else:
        found.unknown.append(word)


def _bad(what: str, word: str, value: str) -> Exception:
    return RCLInvalidROSArgsError(f"Failed to parse ROS arguments: Couldn't parse {what}: '{word} {value}'.")


def _read_remap(found: Arguments, word: str, value: str) -> None:
    left, is_rule, replacement = value.partition(":=")
    if not is_rule or not _NAME.fullmatch(left) or not _NAME.fullmatch(replacement):
        raise _bad("remap rule", word, value)
    node, has_node, match = left.partition(":")
    if has_node and not match.startswith("//"):
        found.remaps.append(RemapRule(node, match, replacement))
    else:
        found.remaps.append(RemapRule(None, left, replacement))


def _read_parameter(found: Arguments, word: str, value: str) -> None:
    left, is_rule, text = value.partition(":=")
    if not is_rule or not left:
        raise _bad("parameter override rule", word, value)
    node, has_node, name = left.rpartition(":")
    setting = _value(text)
    if isinstance(setting, list) and len({type(item) for item in setting}) > 1:
        raise _bad("parameter override rule", word, value)
    found.parameters.append((node if has_node else "/**", name, setting))


def _value(text: str) -> Any:
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        return text
    return value if isinstance(value, bool | int | float | str | list) else text


def _read_file(found: Arguments, word: str, value: str) -> None:
    try:
        document = yaml.compose(Path(value).read_text(), Loader=yaml.SafeLoader)
    except (OSError, yaml.YAMLError) as error:
        raise RCLError(
            f"failed to initialize rcl: Couldn't parse params file: '{word} {value}'. Error: {error}"
        ) from None
    for node, name, setting in _parameters_in(document, ""):
        found.parameters.append((node, name, setting))


def _pairs(node: Any) -> Iterator[tuple[str, Any]]:
    """Yield the keys and values of a YAML mapping, in which a key may occur twice."""
    if isinstance(node, yaml.MappingNode):
        yield from ((str(key.value), value) for key, value in node.value)


def _parameters_in(node: Any, path: str) -> Iterator[tuple[str, str, Any]]:
    for key, inner in _pairs(node):
        if key == "ros__parameters":
            yield from ((path, name, value) for name, value in _flat(inner, ""))
        else:
            yield from _parameters_in(inner, f"{path}/{key.strip('/')}")


def _flat(node: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in _pairs(node):
        if isinstance(value, yaml.MappingNode):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", yaml.safe_load(yaml.serialize(value))


def _read_level(found: Arguments, word: str, value: str) -> None:
    logger, is_rule, level = value.rpartition(":=")
    if level.upper() not in SEVERITIES:
        raise _bad("log level", word, value)
    found.levels[logger if is_rule else ""] = SEVERITIES[level.upper()]


def _ignore(found: Arguments, word: str, value: str) -> None:
    """Ignore arguments of enclaves and logging back ends, which change nothing here."""


_OPTIONS: dict[str, tuple[str, Callable[[Arguments, str, str], None]]] = {
    **dict.fromkeys(("-r", "--remap"), ("No remap rule found.", _read_remap)),
    **dict.fromkeys(("-p", "--param"), ("No parameter override rule found.", _read_parameter)),
    "--params-file": ("No file path provided.", _read_file),
    "--log-level": ("No log level found.", _read_level),
    **dict.fromkeys(
        ("-e", "--enclave", "--log-config-file", "--log-file-name"), ("No value found.", _ignore)
    ),
}


def parse_strictly(words: list[str]) -> Arguments:
    """Read a command line. Raises UnknownROSArgsError if it has unknown ROS arguments."""
    found = parse(words)
    if found.unknown:
        raise UnknownROSArgsError(repr(found.unknown))
    return found


def rclpy_remove_ros_args(words: list[str] | None) -> list[str]:
    """Return the command line without its ROS arguments."""
    return parse_strictly(list(words or [])).others
