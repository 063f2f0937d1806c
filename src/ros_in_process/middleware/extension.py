"""The replacement for `rclpy._rclpy_pybind11`, with all names that the real module exports."""

from __future__ import annotations

import importlib.util
import re
import sys
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any

from ros_in_process.errors import NeedsRealRos
from ros_in_process.middleware import (
    actions,
    arguments,
    clocks,
    events,
    executors,
    graph,
    graph_queries,
    lifecycle,
    logs,
    messages,
    names,
    qos,
    records,
    serialization,
    services,
    signals,
    topics,
    waiting,
)
from ros_in_process.middleware.records import MODULE

_SOURCES: tuple[ModuleType, ...] = (
    actions, arguments, clocks, events, graph, graph_queries, lifecycle, logs, names, qos, records,
    serialization, services, signals, topics, waiting,
)  # fmt: skip
#: what the extension exports, by its name: `rclpy_serialize`, `RCLError` …
_EXPORTED = re.compile(
    r"rclpy_\w+|rcl_\w+|rmw_\w+|RCL_\w+|RMW_\w+|RCUTILS_\w+|\w+_signal_handlers\w*|\w+_sigint_guard_condition"
    r"|service_introspection|[A-Z][A-Za-z]*(Error|Handle)|NotImplementedError"
)
_CLASSES = (
    "ActionClient", "ActionGoalHandle", "ActionServer", "Client", "ClockChange", "ClockEvent", "ClockType",
    "Destroyable", "EventHandle", "GoalEvent", "GuardCondition", "LifecycleStateMachine", "Node",
    "Publisher", "QoSCheckCompatibleResult", "QoSCompatibility", "RCUTILS_LOG_SEVERITY", "Service",
    "SignalHandlerOptions", "Subscription", "Timer", "TransitionCallbackReturnType", "TypeDescriptionService",
    "WaitSet",
)  # fmt: skip
#: how rclpy's Python names the extension
_USES = re.compile(r"\b(?:_rclpy|rclpy_implementation)\.([A-Za-z]\w*)")
#: of the names that its Python mentions, those that exist in comments and type hints alone
_MENTIONED = {"rclpy_init", "rclpy_ok"}


class EventsExecutor:
    """The experimental executor; the real one is written in C++."""

    def __init__(self, context: Any) -> None:
        raise NeedsRealRos("the EventsExecutor is written in C++, below the border of the simulation")


def rclpy_get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware that this one simulates."""
    return "rmw_fastrtps_cpp"


def build() -> ModuleType:
    """Return the module, with all names."""
    module = ModuleType(MODULE, "Simulated.")
    for source in _SOURCES:
        for name, value in vars(source).items():
            if name in _CLASSES or _EXPORTED.fullmatch(name):
                setattr(module, name, value)
    module.Context, module.Clock = graph.Participant, clocks.RosClock  # type: ignore[attr-defined]
    module.EventsExecutor = EventsExecutor  # type: ignore[attr-defined]
    module.rclpy_get_rmw_implementation_identifier = (  # type: ignore[attr-defined]
        rclpy_get_rmw_implementation_identifier
    )
    return module


def names_used() -> set[str]:
    """Return the names of the extension that the installed rclpy's Python code uses."""
    spec = importlib.util.find_spec("rclpy")
    if spec is None or spec.origin is None:
        raise NeedsRealRos("rclpy is not installed, and the simulation runs its Python")
    found: set[str] = set()
    for file in Path(spec.origin).parent.rglob("*.py"):
        found.update(_USES.findall(file.read_text(encoding="utf-8")))
    return found - _MENTIONED


_hashes = count(1)


def _number_in_sets(node: graph.Node) -> None:
    """Order rclpy's objects in sets by age: by address, their order would differ from run to run."""
    for module, name in (("rclpy.node", "Node"), ("rclpy.lifecycle.managed_entity", "ManagedEntity")):
        kind = getattr(sys.modules.get(module), name, None)
        if kind is not None and kind.__hash__ is object.__hash__:
            kind.__hash__ = _hash_by_age


def _hash_by_age(self: Any) -> int:
    return self.__dict__.setdefault("_simulation_age", next(_hashes))  # type: ignore[no-any-return]


def install() -> None:
    """Replace the real module, before rclpy is imported."""
    if MODULE in sys.modules:
        raise NeedsRealRos("rclpy was imported before the simulation was set up")
    module = build()
    missing = sorted(name for name in names_used() if not hasattr(module, name) and not name.startswith("_"))
    if missing:
        raise NeedsRealRos(f"this release of rclpy uses what is not simulated: {', '.join(missing)}")
    sys.modules[MODULE] = module
    messages.install()
    logs.install()
    graph.WORLD.on_node += [_number_in_sets, executors.speed_up_executors]
