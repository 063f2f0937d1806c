"""Messages to and from workers: a line of JSON, then a task or its answer as the core writes it.

Workers may be broken, of another version, or hostile: what they send is checked before it is used.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from mutabot.api.processes import Answer, Task

#: bytes of the line of a message
_MOST_BYTES = 1 << 20
#: characters of a message to the user
_SHOWN = 200


class InvalidData(ValueError):  # noqa: N818  # it is a finding
    """Raised for invalid data."""


@dataclass(frozen=True, slots=True)
class SharedData:
    """The data shared by all units of a campaign.

    Attributes:
        digest: of the bundle, which is its name.
        root: the project's folder on the controller's machine.
        inner: the project's folder in the bundle.
        arguments: the project's pytest arguments.
        environment: variables that the controller decides; None for those that are not to be set.
        paths: folders of the bundle that modules come from.
    """

    digest: str
    root: str
    inner: str
    arguments: tuple[str, ...]
    environment: Mapping[str, str | None]
    paths: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WorkUnit:
    """A task with the settings that all tasks of a campaign share.

    ``ticket`` is what the answer must bear: who was not given the unit does not know it.
    """

    ground: SharedData
    task: Task
    ticket: str = ""

    def data(self) -> bytes:
        """Return the unit as bytes."""
        return _message({"ticket": self.ticket, "ground": asdict(self.ground)}, self.task.to_bytes())

    @classmethod
    def of(cls, data: bytes) -> WorkUnit:
        """Read a unit from bytes, which come from the controller."""
        line, _, task = data.partition(b"\n")
        found = json.loads(line)
        ground: dict[str, Any] = found["ground"]
        lists = {name: tuple(value) for name, value in ground.items() if isinstance(value, list)}
        return cls(SharedData(**ground | lists), Task.of_bytes(task), found["ticket"])


@dataclass(frozen=True, slots=True)
class UnitAnswer:
    """The result of a unit.

    Attributes:
        found: what became of its task; None if it has not run.
        fault: why that says nothing about the mutant, if it does not: the fault of the worker or its machine.
        is_unfit: whether that worker is of no use to the campaign any more.
        lost: why nothing can be said of the task, though the worker is not to blame; else None.
        ticket: of the unit.
    """

    found: Answer | None = None
    fault: str | None = None
    is_unfit: bool = False
    lost: str | None = None
    ticket: str = ""

    def data(self, root: str) -> bytes:
        """Return the answer as bytes; ``root`` is the project's folder on the controller."""
        fields = {"ticket": self.ticket, "fault": self.fault, "is_unfit": self.is_unfit, "lost": self.lost}
        return _message(fields, self.found.to_bytes(root) if self.found is not None else b"")

    @classmethod
    def of(cls, data: bytes, unit: WorkUnit) -> UnitAnswer:
        """Read an answer from bytes. Raises InvalidData if it does not answer this unit."""
        line, _, answer = data.partition(b"\n")
        fields = _read(line, {"ticket": (str,), "fault": _TEXT, "is_unfit": (bool,), "lost": _TEXT})
        if fields["ticket"] != unit.ticket:
            raise InvalidData("it is the answer to something else")
        if not answer and fields["fault"] is None and fields["lost"] is None:
            raise InvalidData("it says nothing of its task")
        try:
            return cls(Answer.of(answer, unit.task) if answer else None, **fields)
        except ValueError as error:
            raise InvalidData(str(error)) from None


@dataclass(frozen=True, slots=True)
class Introduction:
    """What a worker reports about itself.

    Attributes:
        versions: what it runs with, see ``Workers.versions``.
        has: whether it has the bundle.
    """

    versions: Mapping[str, str] = field(default_factory=dict)
    has: bool = False

    def data(self) -> bytes:
        """Return the introduction as bytes."""
        return _message(asdict(self))

    @classmethod
    def of(cls, data: bytes) -> Introduction:
        """Read an introduction from bytes. Raises InvalidData if they are invalid."""
        fields = _read(data.rstrip(b"\n"), {"versions": (dict,), "has": (bool,)})
        if any(type(version) is not str for version in fields["versions"].values()):
            raise InvalidData("versions: a text was expected for each")
        return cls(**fields)


_TEXT = (str, type(None))


def _message(fields: Mapping[str, Any], more: bytes = b"") -> bytes:
    return json.dumps(fields, separators=(",", ":")).encode() + b"\n" + more


def _read(line: bytes, kinds: Mapping[str, tuple[type, ...]]) -> dict[str, Any]:
    """Return the fields in a line, with checked types and storable texts. Raises InvalidData."""
    if len(line) > _MOST_BYTES:
        raise InvalidData(f"a line of {len(line)} bytes, more than {_MOST_BYTES}")
    try:
        found = json.loads(line.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise InvalidData(f"not JSON ({type(error).__name__}: {error})"[:_SHOWN]) from None
    if not isinstance(found, dict) or found.keys() != kinds.keys():
        raise InvalidData(f"an object with {', '.join(kinds)} was expected")
    for name, item in found.items():
        if type(item) not in kinds[name]:
            raise InvalidData(f"{name}: {kinds[name][0].__name__} was expected, not {type(item).__name__}")
    return {name: _storable(item) if isinstance(item, str) else item for name, item in found.items()}


def _storable(text: str) -> str:
    """Return the text without unpaired surrogates."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
