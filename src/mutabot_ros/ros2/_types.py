"""The types of ROS 2: a class for each message, service and action; the latter two contain their parts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from types import ModuleType
from typing import Any, ClassVar

from mutabot.api.values import Form
from mutabot_ros._types import Types


class Ros2Types(Types):
    """The message types of ROS 2 (see ``Types``); parts are attributes of classes."""

    written: ClassVar[Mapping[Form, tuple[str, str]]] = {
        Form.PUBLISH: ("msg", ""),
        Form.CALL: ("srv", "Request"),
        Form.GOAL: ("action", "Goal"),
    }
    read: ClassVar[Mapping[Form, tuple[str, str]]] = {
        Form.RECEIVE: ("msg", ""),
        Form.CALL: ("srv", "Response"),
        Form.FEEDBACK: ("action", "Feedback"),
        Form.RESULT: ("action", "Result"),
    }
    #: ``sequence<double, 3>``, ``double[9]``
    array = re.compile(r"(?:sequence<)?(?P<item>[^,<>\[]+)(?:(?:,\s*\d+)?>|\[[^\]]*\])")
    as_goal = frozenset({Form.FEEDBACK, Form.RESULT, Form.CANCEL})

    def name_of(self, kind: Any) -> str | None:
        return f"{kind.__module__.partition('.')[0]}/{kind.__name__}" if isinstance(kind, type) else None

    def part_of(self, module: ModuleType, name: str, part: str) -> Any:
        whole = getattr(module, name, None)
        return getattr(whole, part) if whole is not None and part else whole

    def names_in(self, module: ModuleType, part: str) -> Iterator[str]:
        return (name for name in vars(module) if name[0].isupper() and "_" not in name)

    def fields_of(self, message: Any) -> Mapping[str, str]:
        fields: Mapping[str, str] = message.get_fields_and_field_types()
        return fields


#: those of this process
TYPES = Ros2Types()
