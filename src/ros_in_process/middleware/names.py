"""Names of nodes, namespaces, topics and services: validation and expansion.

The rules and their wording are those that rclpy's callers see with real ROS.
"""

from __future__ import annotations

import string

from ros_in_process.middleware.records import RCLError

NameProblem = tuple[str, int] | None

_WORD = frozenset(string.ascii_letters + string.digits + "_")
_MAX_NODE, _MAX_NAMESPACE, _MAX_TOPIC = 255, 245, 247


def rclpy_get_validation_error_for_node_name(name: str) -> NameProblem:
    """Return what is wrong with a node's name, and where; None if it is valid."""
    if not name:
        return "node name must not be empty", 0
    for index, char in enumerate(name):
        if char not in _WORD:
            return "node name must not contain characters other than alphanumerics or '_'", index
    if name[0].isdigit():
        return "node name must not start with a number", 0
    if len(name) > _MAX_NODE:
        return f"node name length should not exceed '{_MAX_NODE}'", _MAX_NODE - 1
    return None


def rclpy_get_validation_error_for_full_topic_name(name: str) -> NameProblem:
    """Return what is wrong with a fully expanded name, and where; None if it is valid."""
    problem = _path_problem(name, "topic name")
    if problem is None and len(name) > _MAX_TOPIC:
        return f"topic name length should not exceed '{_MAX_TOPIC}'", _MAX_TOPIC - 1
    return problem


def rclpy_get_validation_error_for_namespace(name: str) -> NameProblem:
    """Return what is wrong with a namespace, and where; None if it is valid."""
    if name == "/":
        return None
    problem = _path_problem(name, "namespace")
    if problem is None and len(name) > _MAX_NAMESPACE:
        return "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'", _MAX_NAMESPACE - 1
    return problem


def _path_problem(name: str, what: str) -> NameProblem:
    if not name:
        return f"{what} must not be empty", 0
    if name[0] != "/":
        return f"{what} must be absolute, it must lead with a '/'", 0
    if name[-1] == "/":
        only = ", unless only a '/'" if what == "namespace" else ""
        return f"{what} must not end with a '/'{only}", len(name) - 1
    for index, char in enumerate(name):
        if char not in _WORD and char != "/":
            return f"{what} must not contain characters other than alphanumerics, '_', or '/'", index
    for index in range(1, len(name)):
        if name[index - 1] == "/" and name[index] == "/":
            return f"{what} must not contain repeated '/'", index
        if name[index - 1] == "/" and name[index].isdigit():
            return f"{what} must not have a token that starts with a number", index
    return None


def rclpy_get_validation_error_for_topic_name(name: str) -> NameProblem:
    """Return what is wrong with a name that may be relative, private, or contain substitutions; else None."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0].isdigit():
        return "topic name token must not start with a number", 0
    if name[-1] == "/":
        return "topic name must not end with a forward slash", len(name) - 1
    return _characters_problem(name) or _tokens_problem(name)


def _characters_problem(name: str) -> NameProblem:
    opened = None
    unmatched = "topic name must not have unmatched (unbalanced) curly braces '{}'"
    for index, char in enumerate(name):
        if char == "{":
            if opened is not None:
                return unmatched, index
            opened = index
        elif char == "}":
            if opened is None:
                return unmatched, index
            opened = None
        elif char == "~" and index:
            return "topic name must not have tilde '~' unless it is the first character", index
        elif opened is not None and char not in _WORD:
            return "substitution name must not contain characters other than alphanumerics or '_'", index
        elif opened is not None and char.isdigit() and index == opened + 1:
            return "substitution name must not start with a number", index
        elif char not in _WORD and char not in "/~":
            allowed = "alphanumerics, '_', '~', '{', or '}'"
            return f"topic name must not contain characters other than {allowed}", index
    return None if opened is None else (unmatched, opened)


def _tokens_problem(name: str) -> NameProblem:
    for index in range(1, len(name) - 1):
        if name[index] == "/" and name[index + 1].isdigit():
            return "topic name token must not start with a number", index + 1
        if index == 1 and name[0] == "~" and name[1] != "/":
            return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    return None


def rclpy_expand_topic_name(name: str, node: str, namespace: str) -> str:
    """Return the absolute form of a name in a node."""
    for what, value, problem in (
        ("topic name", name, rclpy_get_validation_error_for_topic_name(name)),
        ("node name", node, rclpy_get_validation_error_for_node_name(node)),
        ("node namespace", namespace, rclpy_get_validation_error_for_namespace(namespace)),
    ):
        if problem is not None:
            raise ValueError(f"{what} '{value}' is invalid: {problem[0]}")
    base = namespace.rstrip("/")
    if name.startswith("~"):
        name = f"{base}/{node}{name[1:]}"
    name = _substituted(name, {"node": node, "ns": namespace, "namespace": namespace})
    return name if name.startswith("/") else f"{base}/{name}"


def _substituted(name: str, values: dict[str, str]) -> str:
    start = name.find("{")
    while start >= 0:
        end = name.index("}", start)
        key = name[start + 1 : end]
        if key not in values:
            raise ValueError(f"topic name '{name}' is invalid: unknown substitution: {{{key}}}")
        name = name[:start] + values[key] + name[end + 1 :]
        start = name.find("{")
    return name


def expanded(name: str, node: str, namespace: str) -> str:
    """Return the absolute form of a name, valid on the network. Raises RCLError if it is invalid."""
    try:
        full = rclpy_expand_topic_name(name, node, namespace)
    except ValueError as error:
        raise RCLError(f"failed to resolve name: {str(error).partition('is invalid: ')[2]}") from None
    problem = rclpy_get_validation_error_for_full_topic_name(full)
    if problem is not None:
        raise RCLError(f"failed to resolve name: {problem[0]}")
    return full
