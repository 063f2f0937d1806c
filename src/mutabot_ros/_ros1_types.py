"""The types of ROS 1: a class for each message, and for each part of a service or action."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path as File
from types import ModuleType
from typing import Any, ClassVar

from mutabot.api.values import Form

from ._types import Types

_MOMENTS = frozenset({"time", "duration"})
_PARTS_OF_MOMENTS = ("secs", "nsecs")


class Ros1Types(Types):
    """The message types of ROS 1 (see ``Types``); parts are suffixes of class names."""

    written: ClassVar[Mapping[Form, tuple[str, str]]] = {
        Form.PUBLISH: ("msg", ""),
        Form.CALL: ("srv", "Request"),
        Form.GOAL: ("msg", "Goal"),
    }
    read: ClassVar[Mapping[Form, tuple[str, str]]] = {
        Form.RECEIVE: ("msg", ""),
        Form.CALL: ("srv", "Response"),
        Form.FEEDBACK: ("msg", "Feedback"),
        Form.RESULT: ("msg", "Result"),
        Form.TRANSFORM: ("msg", ""),
    }
    array = re.compile(r"(?P<item>.+)\[\d*\]")

    def name_of(self, kind: Any) -> str | None:
        name = getattr(kind, "_type", None)
        return name.removesuffix("Action") if isinstance(name, str) else None

    def part_of(self, module: ModuleType, name: str, part: str) -> Any:
        return getattr(module, name + part, None)

    def names_in(self, module: ModuleType, part: str) -> Iterator[str]:
        return (name.removesuffix(part) for name in vars(module) if name.endswith(part) and name[0].isupper())

    def fields_of(self, message: Any) -> Mapping[str, str]:
        return dict(zip(message.__slots__, message._slot_types, strict=True))

    def fields_of_basic(self, kind: str) -> Mapping[str, str]:
        return dict.fromkeys(_PARTS_OF_MOMENTS, "int32") if kind in _MOMENTS else {}

    def packages(self) -> Iterator[str]:
        for folder in map(File, sys.path):
            for path in folder.iterdir() if folder.is_dir() else ():
                if (path / "msg").is_dir() or (path / "srv").is_dir():
                    yield path.name
