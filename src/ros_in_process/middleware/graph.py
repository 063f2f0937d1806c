"""The graph of ROS: contexts, nodes, and the endpoints of topics and services."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from itertools import count
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER, SimulatedProcess, SimulatedThread
from ros_in_process.middleware import arguments, names
from ros_in_process.middleware.messages import type_name
from ros_in_process.middleware.qos import rmw_qos_profile_t
from ros_in_process.middleware.records import (
    MODULE,
    RCL_DEFAULT_DOMAIN_ID,
    InvalidHandle,
    NodeNameNonExistentError,
    RCLError,
)

_numbers = count(1)


class Destroyable:
    """A handle that is destroyed once it is no longer in use.

    Attributes:
        destroyed: how many handles have been destroyed so far.
        uses: how many use it now.
    """

    destroyed = 0

    def __init__(self) -> None:
        self.number = next(_numbers)
        self.uses = 0
        self.is_destroyed = False

    @property
    def pointer(self) -> int:
        return self.number

    def __enter__(self) -> None:
        if self.is_destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        self.uses += 1

    def __exit__(self, *_: object) -> None:
        self.uses -= 1
        if self.is_destroyed and not self.uses:
            self._release()

    def destroy_when_not_in_use(self) -> None:
        if self.is_destroyed:
            return
        self.is_destroyed = True
        Destroyable.destroyed += 1
        if not self.uses:
            self._release()

    def _release(self) -> None:
        """Remove it from the graph."""


class Waitable(Destroyable):
    """Something that a wait set can wait for.

    Each kind has `is_ready`. Wait sets look at all of their members again and again, so it is an attribute,
    and a property only where it depends on time.
    """

    def __init__(self) -> None:
        super().__init__()
        self.watchers: list[SimulatedThread] = []

    def changed(self) -> None:
        """Wake the threads that wait for this to become ready."""
        SCHEDULER.progress()
        for task in self.watchers:
            SCHEDULER.wake(task)


class Participant(Destroyable):
    """A participant of the network: one initialisation of ROS in a process, with its arguments."""

    def __init__(self, args: list[str], domain_id: int) -> None:
        super().__init__()
        if domain_id == RCL_DEFAULT_DOMAIN_ID:
            domain_id = int(os.environ.get("ROS_DOMAIN_ID") or 0)
        self.domain = domain_id
        for word in args:
            word.encode()  # as the real one: what is no text raises
        try:
            self.arguments = arguments.parse_strictly(list(args))
        except RCLError as error:
            raise RCLError(
                str(error).replace("Failed to parse ROS arguments", "failed to initialize rcl")
            ) from None
        self.is_up = True
        self.process: SimulatedProcess | None = SCHEDULER.current.process
        if self.process is not None:
            self.process.contexts.append(self)

    def get_domain_id(self) -> int:
        return self.domain

    def ok(self) -> bool:
        return self.is_up

    def shutdown(self) -> None:
        if not self.is_up:
            raise RuntimeError("failed to shutdown: context is not initialized or already shut down")
        self.close()

    def close(self) -> None:
        """Shut it down, for whatever reason."""
        self.is_up = False
        SCHEDULER.progress()


class Node(Destroyable):
    """A node: its names, and its endpoints."""

    def __init__(
        self, name: str, namespace: str, context: Participant, cli_args: list[str] | None,
        use_global_arguments: bool,
        enable_rosout: bool, rosout_qos: Any,
    ) -> None:  # fmt: skip
        super().__init__()
        if not context.is_up:
            raise RCLError(
                "error creating node: the given context is not valid, either rcl_init() was not called"
            )
        self.context = context
        own = arguments.parse_strictly(list(cli_args or []))
        self._sources = [own, *([context.arguments] if use_global_arguments else [])]
        namespace = namespace if namespace.startswith("/") else "/" + namespace
        for problem in (
            names.rclpy_get_validation_error_for_node_name(name),
            names.rclpy_get_validation_error_for_namespace(namespace),
        ):
            if problem is not None:
                raise ValueError(f"{problem[0]}: {name!r} in {namespace!r}")
        self.namespace = self._first(lambda source: source.remapped("__ns", name)) or namespace
        self.name = self._first(lambda source: source.remapped("__node", name)) or name
        self.full_name = f"{self.namespace.rstrip('/')}/{self.name}"
        self.seen_at = WORLD.discovery()
        self.enable_rosout, self.rosout_qos = enable_rosout, rosout_qos
        WORLD.nodes.append(self)
        for listener in WORLD.on_node:
            listener(self)

    def _first(self, ask: Callable[[arguments.Arguments], str | None]) -> str | None:
        return next((answer for answer in map(ask, self._sources) if answer is not None), None)

    def _release(self) -> None:
        WORLD.nodes.remove(self)
        for end in [end for end in WORLD.ends if end.node is self and end.is_internal]:
            end.destroy_when_not_in_use()

    def resolve(self, name: str, scheme: str = "rostopic", only_expand: bool = False) -> str:
        """Return the full name of a topic or service in this node."""
        full = names.expanded(name, self.name, self.namespace)
        if only_expand:
            return full
        return self._first(lambda source: source.resolved(full, self.name, self.namespace, scheme)) or full

    def get_fully_qualified_name(self) -> str:
        return self.full_name

    def logger_name(self) -> str:
        return self.full_name.strip("/").replace("/", ".")

    def get_node_name(self) -> str:
        return self.name

    def get_namespace(self) -> str:
        return self.namespace

    def get_parameters(self, parameter_class: Callable[..., Any]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for source in reversed(self._sources):
            found.update(source.parameters_of(self.full_name))
        return {name: parameter_class(name, value=value) for name, value in found.items()}

    def get_count_publishers(self, topic: str) -> int:
        return sum(end.name == topic for end in WORLD.seen(self, "publisher"))

    def get_count_subscribers(self, topic: str) -> int:
        return sum(end.name == topic for end in WORLD.seen(self, "subscription"))

    def get_count_clients(self, service: str) -> int:
        return sum(end.name == service for end in WORLD.seen(self, "client"))

    def get_count_services(self, service: str) -> int:
        return sum(end.name == service for end in WORLD.seen(self, "service"))

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(node.name, node.namespace) for node in WORLD.seen_nodes(self)]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        return [(node.name, node.namespace, "/") for node in WORLD.seen_nodes(self)]

    def get_action_names_and_types(self) -> list[tuple[str, list[str]]]:
        return _actions(WORLD.seen(self, "publisher") + WORLD.seen(self, "subscription"))

    def get_action_server_names_and_types_by_node(
        self, name: str, namespace: str
    ) -> list[tuple[str, list[str]]]:
        return _actions(WORLD.of_node(self, "publisher", name, namespace, "action server"))

    def get_action_client_names_and_types_by_node(
        self, name: str, namespace: str
    ) -> list[tuple[str, list[str]]]:
        return _actions(WORLD.of_node(self, "subscription", name, namespace, "action client"))


class Endpoint(Waitable):
    """An endpoint of a topic or service."""

    role = ""

    def __init__(self, node: Node, kind: Any, name: str, scheme: str, profile: rmw_qos_profile_t) -> None:
        super().__init__()
        self.node = node
        self.kind = kind
        self.type_name = type_name(kind)
        self.name = node.resolve(name, scheme)
        self.profile = profile
        self.is_internal = False
        self.seen_at = WORLD.discovery()

    def _others(self, role: str) -> Iterator[Any]:
        """Yield the endpoints of a role that match this one by domain, name and type."""
        wanted = (role, self.name, self.type_name, self.node.context.domain)
        for end in WORLD.ends:
            if (end.role, end.name, end.type_name, end.node.context.domain) == wanted:
                yield end

    def when_both_are_seen(self, other: Endpoint, meet: Callable[[], None]) -> None:
        """Call `meet` when two endpoints discover each other: in one context at once, else after a delay."""

        def meet_if_there() -> None:
            if not self.is_destroyed and not other.is_destroyed:
                meet()

        at = max(self.seen_at, other.seen_at)
        if self.node.context is other.node.context or at <= SCHEDULER.now:
            meet_if_there()
        else:
            SCHEDULER.call_at(at, meet_if_there)

    def get_logger_name(self) -> str:
        return self.node.logger_name()

    @property
    def gid(self) -> list[int]:
        return [*self.number.to_bytes(8, "big"), *self.node.context.number.to_bytes(8, "big")]


NamesAndTypes = list[tuple[str, list[str]]]


def grouped(pairs: Iterable[tuple[str, str]]) -> NamesAndTypes:
    found: dict[str, set[str]] = {}
    for name, kind in pairs:
        found.setdefault(name, set()).add(kind)
    return [(name, sorted(kinds)) for name, kinds in sorted(found.items())]


def _actions(ends: Iterable[Endpoint]) -> NamesAndTypes:
    suffix, of_type = "/_action/feedback", "_FeedbackMessage"
    return grouped(
        (end.name.removesuffix(suffix), end.type_name.removesuffix(of_type))
        for end in ends
        if end.name.endswith(suffix)
    )


class World:
    """All existing nodes and endpoints, in the order of their creation."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.ends: list[Endpoint] = []
        self.on_node: list[Callable[[Node], None]] = []

    def discovery(self) -> int:
        """Return when other contexts see what is created now."""
        return SCHEDULER.now + SCHEDULER.schedule.discovery()

    def seen(self, by: Node, role: str) -> list[Endpoint]:
        """Return the endpoints of a role that a node knows."""
        return [end for end in self.ends if end.role == role and _is_seen(by, end.node.context, end.seen_at)]

    def of_node(self, by: Node, role: str, name: str, namespace: str, what: str) -> list[Endpoint]:
        """Return the endpoints of a role that one node has, as seen by another."""
        if not any((node.name, node.namespace) == (name, namespace) for node in self.seen_nodes(by)):
            if what.startswith("action"):
                raise RCLError(f"Failed to get {what} names and type: error not set")
            raise NodeNameNonExistentError(
                f"cannot get {what} names and types for nonexistent node: error not set"
            )
        return [
            end for end in self.seen(by, role) if (end.node.name, end.node.namespace) == (name, namespace)
        ]

    def seen_nodes(self, by: Node) -> list[Node]:
        return [node for node in self.nodes if _is_seen(by, node.context, node.seen_at)]


def _is_seen(by: Node, context: Participant, seen_at: int) -> bool:
    return context.domain == by.context.domain and (context is by.context or seen_at <= SCHEDULER.now)


#: the one network of this process
WORLD = World()

Participant.__name__ = "Context"
for _kind in (Destroyable, Participant, Node):
    _kind.__module__ = MODULE
