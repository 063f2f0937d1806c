"""Services: clients and servers, their requests and responses, and service events."""

from __future__ import annotations

from collections import deque
from functools import partial
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.clocks import RosClock
from ros_in_process.middleware.graph import WORLD, Destroyable, Endpoint, Node
from ros_in_process.middleware.messages import converted
from ros_in_process.middleware.qos import mismatch, rmw_qos_profile_t
from ros_in_process.middleware.records import (
    MODULE,
    RCLError,
    rmw_request_id_t,
    rmw_service_info_t,
    service_introspection,
)
from ros_in_process.middleware.topics import Publisher
from ros_in_process.middleware.type_descriptions import answer_about

_OFF = service_introspection.ServiceIntrospectionState.OFF
_CONTENTS = service_introspection.ServiceIntrospectionState.CONTENTS
REQUEST_SENT, REQUEST_RECEIVED, RESPONSE_SENT, RESPONSE_RECEIVED = range(4)


class _ServiceEndpoint(Endpoint):
    """The common part of clients and servers."""

    def __init__(self, node: Node, kind: Any, name: str, profile: Any) -> None:
        wanted = profile or rmw_qos_profile_t.predefined("qos_profile_services_default")
        try:
            super().__init__(node, kind, name, "rosservice", wanted)
        except RCLError as error:
            reason = str(error).partition(": ")[2]
            raise ValueError(
                f"failed to create {self.role} due to invalid topic name '{name}': {reason}"
            ) from None
        self._wanted = wanted
        # an end both hears and speaks: what is left open is taken as for a writer
        self.profile = wanted.resolved(True, [])
        self.queue: deque[tuple[Any, rmw_service_info_t]] = deque(maxlen=self.profile.kept)
        self.is_ready = False
        self.matched: list[Any] = []
        self._events: Publisher | None = None
        self._event_clock: RosClock | None = None
        self._state = _OFF
        self._last_arrival = 0
        WORLD.ends.append(self)

    def _release(self) -> None:
        if self in WORLD.ends:
            WORLD.ends.remove(self)
        for other in self.matched:
            other.matched.remove(self)
        self.matched.clear()
        if self._events is not None:
            self._events.destroy_when_not_in_use()

    def receive(self, message: Any, request: rmw_request_id_t, event: int) -> None:
        """Put a request or response into the queue, now or after its transit time."""
        stamp = SCHEDULER.system_time
        at = max(SCHEDULER.now + SCHEDULER.schedule.transit(), self._last_arrival)

        def arrive() -> None:
            if not self.is_destroyed:
                self.queue.append((message, rmw_service_info_t(stamp, SCHEDULER.system_time, request)))
                self.is_ready = True
                self.changed()

        if at <= SCHEDULER.now:
            arrive()
        else:
            self._last_arrival = at
            SCHEDULER.call_at(at, arrive)

    def _take(self, kind: Any, event: int) -> tuple[Any, Any]:
        if not self.queue:
            return None, None
        message, info = self.queue.popleft()
        self.is_ready = bool(self.queue)
        self._publish_event(event, info.request_id, message)
        return converted(message, kind), info

    def configure_introspection(self, clock: RosClock, profile: rmw_qos_profile_t, state: Any) -> None:
        """Publish an event for each request and response, with or without its contents."""
        self._event_clock, self._state = clock, state
        if state is not _OFF and self._events is None:
            self._events = Publisher(self.node, self.kind.Event, f"{self.name}/_service_event", profile)
            self._events.is_internal = True
        elif state is _OFF and self._events is not None:
            self._events.destroy_when_not_in_use()
            self._events = None

    def _publish_event(self, event: int, request: rmw_request_id_t, message: Any) -> None:
        if self._events is None or self._event_clock is None:
            return
        event_message = self.kind.Event()
        event_message.info.event_type = event
        event_message.info.stamp.sec, event_message.info.stamp.nanosec = divmod(
            self._event_clock.now(), 10**9
        )
        event_message.info.client_gid[:] = request.writer.gid
        event_message.info.sequence_number = request.sequence_number
        if self._state is _CONTENTS:
            (
                event_message.request if event in {REQUEST_SENT, REQUEST_RECEIVED} else event_message.response
            ).append(message)
        self._events.publish(event_message)


def _meet(client: Client, service: Service) -> None:
    if (
        mismatch(client.profile, service.profile) is None
        and mismatch(service.profile, client.profile) is None
    ):
        client.matched.append(service)
        service.matched.append(client)


class Client(_ServiceEndpoint):
    """The client of a service."""

    role = "client"

    def __init__(self, node: Node, kind: Any, name: str, profile: Any = None) -> None:
        super().__init__(node, kind, name, profile)
        self._sent = 0
        self._open: set[int] = set()
        for service in list(self._others("service")):
            self.when_both_are_seen(service, partial(_meet, self, service))

    @property
    def service_name(self) -> str:
        return self.name

    def service_server_is_available(self) -> bool:
        return bool(self.matched)

    def send_request(self, request: Any) -> int:
        """Send a request to all servers that match now; the first response counts."""
        SCHEDULER.may_switch()
        copy = converted(request, self.kind.Request)
        self._sent += 1
        self._open.add(self._sent)
        identity = rmw_request_id_t(self._sent, self)
        self._publish_event(REQUEST_SENT, identity, copy)
        for service in list(self.matched):
            service.receive(copy, identity, REQUEST_RECEIVED)
        return self._sent

    def accept(self, response: Any, identity: rmw_request_id_t) -> None:
        """Accept a response, unless another came first."""
        if identity.sequence_number in self._open:
            self._open.discard(identity.sequence_number)
            self.receive(response, identity, RESPONSE_RECEIVED)

    def take_response(self, kind: Any) -> tuple[Any, Any]:
        response, info = self._take(kind, RESPONSE_RECEIVED)
        return info, response


class Service(_ServiceEndpoint):
    """The server of a service."""

    role = "service"

    def __init__(self, node: Node, kind: Any, name: str, profile: Any = None) -> None:
        super().__init__(node, kind, name, profile)
        for client in list(self._others("client")):
            self.when_both_are_seen(client, partial(_meet, client, self))

    @property
    def qos(self) -> dict[str, Any]:
        return self._wanted.to_dict()

    def service_take_request(self, kind: Any) -> tuple[Any, Any]:
        return self._take(kind, REQUEST_RECEIVED)

    def service_send_response(self, response: Any, identity: rmw_request_id_t) -> None:
        SCHEDULER.may_switch()
        copy = converted(response, self.kind.Response)
        self._publish_event(RESPONSE_SENT, identity, copy)
        if not identity.writer.is_destroyed:
            identity.writer.accept(copy, identity)


class TypeDescriptionService(Destroyable):
    """The service that describes a message type."""

    def __init__(self, node: Node) -> None:
        from type_description_interfaces.srv import GetTypeDescription  # noqa: PLC0415  (only where there is ROS)

        super().__init__()
        self.impl = Service(node, GetTypeDescription, "~/get_type_description")

    def handle_request(self, request: Any, kind: Any, node: Node) -> Any:
        return answer_about(request, kind(), {end.type_name for end in WORLD.ends if end.node is node})

    def _release(self) -> None:
        self.impl.destroy_when_not_in_use()


for _kind in (Client, Service, TypeDescriptionService):
    _kind.__module__ = MODULE
