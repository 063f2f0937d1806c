"""Intercepts parameters of nodes, with the defaults of their declarations."""

from __future__ import annotations

from importlib import import_module
from typing import Any
from weakref import WeakKeyDictionary

from mutabot.api.values import Form, Names
from mutabot_ros._patches import Patches

from . import _nodes


def hook(patches: Patches, messages: Names) -> None:
    """Hook the functions that read parameters."""
    parameters = _Parameters(messages)
    node: Any = import_module("rclpy.node").Node
    patches.put(node, "declare_parameter", parameters.declare)
    patches.put(node, "declare_parameters", parameters.declare_several)
    patches.put(node, "get_parameter", parameters.get)
    patches.put(node, "get_parameter_or", parameters.get_or)
    patches.put(node, "get_parameters_by_prefix", parameters.get_by_prefix)


class _Parameters:
    def __init__(self, messages: Names) -> None:
        self._messages = messages
        self._defaults: WeakKeyDictionary[Any, dict[str, Any]] = WeakKeyDictionary()

    def declare(
        self, original: Any, node: Any, name: str, value: Any = None, *args: Any, **kwargs: Any
    ) -> Any:
        self._note(node, name, value)
        return self._read(node, name, original(node, name, value, *args, **kwargs))

    def declare_several(
        self, original: Any, node: Any, namespace: str, parameters: Any, *args: Any, **kwargs: Any
    ) -> Any:
        several = list(parameters)
        for declaration in several:
            if len(declaration) > 1:
                self._note(
                    node, f"{namespace}.{declaration[0]}" if namespace else declaration[0], declaration[1]
                )
        return original(node, namespace, several, *args, **kwargs)

    def get(self, original: Any, node: Any, name: str) -> Any:
        return self._read(node, name, original(node, name))

    def get_or(self, original: Any, node: Any, name: str, alternative_value: Any = None) -> Any:
        found = original(node, name, alternative_value)
        if alternative_value is not None:
            return self._read(node, name, found, {"default": alternative_value.value})
        return self._read(node, name, found)

    def get_by_prefix(self, original: Any, node: Any, prefix: str) -> Any:
        whole = f"{prefix}." if prefix else ""
        return {name: self._read(node, whole + name, value) for name, value in original(node, prefix).items()}

    def _note(self, node: Any, name: str, value: Any) -> None:
        """Record the value that a declaration gives; a type is no value."""
        if value is not None and not isinstance(value, import_module("rclpy.parameter").Parameter.Type):
            self._defaults.setdefault(node, {})[name] = value

    def _read(self, node: Any, name: str, parameter: Any, default: dict[str, Any] | None = None) -> Any:
        if _nodes.is_own():
            return parameter
        handler = self._messages.find(Form.PARAMETER, name, _nodes.name_of(node))
        if handler is None:
            return parameter
        known = self._defaults.get(node, {})
        given = default or ({"default": known[name]} if name in known else {})

        def read(default: Any = ...) -> Any:
            return parameter.value

        value = handler(read, None, (), given, _nodes.where(node))
        return parameter if value is parameter.value else type(parameter)(name, value=value)
