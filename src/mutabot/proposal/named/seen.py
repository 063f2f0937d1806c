"""What was seen of names: which forms, by whom, with which parts of messages."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mutabot.model.operation import Form

#: different values that are kept of each part
_MOST_VALUES = 8
#: what anonymous nodes of ROS 1 have behind their names: another number in each run
_ANONYMOUS = re.compile(r"_\d+_\d{10,}(?=/|$)")
#: what the middleware itself does with names
_OWN = frozenset(
    {"/use_sim_time", "use_sim_time", "start_type_description_service", "/rosout_disable_topics_generation"}
)
_OWN_BEGINNINGS = (
    "/actionlib_client_",
    "/run_id",
    "/tcp_keepalive",
    "/enable_statistics",
    "/statistics_",
    "qos_overrides.",
)


@dataclass(frozen=True)
class Part:
    """A part of a message, or a plain value.

    Attributes:
        path: where it lies, as vocabularies write it; empty for a value that is no message.
        within: the types that hold it, each with the name of its field, the outermost first.
        type: its own type, as the definition says.
        values: the first different values.
        length: least number of elements of a sequence; None for anything else.
        always: whether it was there in every message.
    """

    path: str
    within: tuple[tuple[str, str], ...]
    type: str
    values: tuple[Any, ...] = ()
    length: int | None = None
    always: bool = True


@dataclass(frozen=True)
class Use:
    """What was done under a name.

    Attributes:
        form: what.
        name: the resolved name; where it would be another one in each run, with ``*``.
        of_tests: whether the tests did it.
        is_called_back: whether it came to a callback, rather than to who waited for it.
        sites: file, line, number of times.
        type: ``package/Name`` of the message, service or action; empty if that is not known.
        written, read: parts of what was sent, and of what came.
    """

    form: Form
    name: str
    of_tests: bool
    is_called_back: bool
    sites: tuple[tuple[str, int, int], ...]
    type: str = ""
    written: tuple[Part, ...] = ()
    read: tuple[Part, ...] = ()

    @property
    def count(self) -> int:
        """How often it was done."""
        return sum(count for _, _, count in self.sites)


def uses(raw: Iterable[Mapping[str, Any]]) -> list[Use]:
    """What all processes saw, one use for each form, name and side."""
    found: dict[tuple[str, str, bool, bool], list[Mapping[str, Any]]] = {}
    for one in raw:
        name = _ANONYMOUS.sub("_*", one["name"])
        if name not in _OWN and not name.startswith(_OWN_BEGINNINGS):
            key = (one["form"], name, one["of_tests"], one["is_called_back"])
            found.setdefault(key, []).append(one)
    return [_use(several) for several in found.values()]


def _use(several: Sequence[Mapping[str, Any]]) -> Use:
    first = several[0]
    sites: dict[tuple[str, int], int] = {}
    for one in several:
        for file, line, count in one["sites"]:
            sites[file, line] = sites.get((file, line), 0) + count
    seen = tuple((file, line, count) for (file, line), count in sites.items())
    types = [one[side]["type"] for one in several for side in ("written", "read") if one[side]["type"]]
    return Use(
        form=Form(first["form"]),
        name=_ANONYMOUS.sub("_*", first["name"]),
        of_tests=first["of_tests"],
        is_called_back=first["is_called_back"],
        sites=seen,
        type=next((found for found in map(_whole, types) if found), ""),
        written=_parts([one["written"] for one in several]),
        read=_parts([one["read"] for one in several]),
    )


def _whole(kind: str) -> str:
    """The type of a service or action, of that of its parts; empty for what is no message."""
    package, slash, name = kind.partition("/")
    if not slash:
        return ""
    if "_" in name:  # ROS 2: SetBool_Request
        return f"{package}/{name.partition('_')[0]}"
    return kind


def _parts(several: Sequence[Mapping[str, Any]]) -> tuple[Part, ...]:
    times = sum(one["times"] for one in several)
    together: dict[str, list[Mapping[str, Any]]] = {}
    for one in several:
        for part in one["parts"]:
            together.setdefault(part["path"], []).append(part)
    return tuple(_part(parts, times) for parts in together.values())


def _part(parts: Sequence[Mapping[str, Any]], times: int) -> Part:
    first = parts[0]
    values: list[Any] = []
    for value in (value for part in parts for value in part["values"] if is_finite(value)):
        if all(value != other or type(value) is not type(other) for other in values):
            values.append(value)
    lengths = [part["length"] for part in parts if part["length"] is not None]
    return Part(
        first["path"],
        tuple((holder, name) for holder, name in first["within"]),
        first["type"],
        tuple(values[:_MOST_VALUES]),
        min(lengths, default=None),
        always=sum(part["count"] for part in parts) >= times,
    )


def is_finite(value: Any) -> bool:
    """Whether no number in a value is infinite or none at all."""
    numbers = value if isinstance(value, list) else [value]
    return all(math.isfinite(one) for one in numbers if isinstance(one, float))
