"""Topics: publishers, subscriptions, their matching by quality of service, and its events."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from functools import partial
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER, Alarm
from ros_in_process.middleware import records
from ros_in_process.middleware.content_filters import ContentFilter
from ros_in_process.middleware.events import Status
from ros_in_process.middleware.graph import WORLD, Endpoint, Node, Participant
from ros_in_process.middleware.messages import converted, type_name
from ros_in_process.middleware.qos import (
    AUTOMATIC,
    MANUAL_BY_TOPIC,
    TRANSIENT_LOCAL,
    mismatch,
    rmw_qos_profile_t,
)
from ros_in_process.middleware.records import (
    MODULE,
    RMW_DURATION_INFINITE,
    RCLError,
    rcl_publisher_event_type_t,
    rcl_subscription_event_type_t,
)
from ros_in_process.middleware.serialization import rclpy_deserialize, rclpy_serialize

_ON_PUBLISHER, _ON_SUBSCRIPTION = rcl_publisher_event_type_t, rcl_subscription_event_type_t


@dataclass(frozen=True)
class SentMessage:
    """A message in transit."""

    message: Any
    stamp: int  # the system time at which it was published
    number: int  # among its publisher's
    gid: list[int]  # its publisher's
    expires: int | None  # the system time from which it is no longer delivered


class _Topic(Endpoint):
    """The common part of publishers and subscriptions."""

    def __init__(self, node: Node, kind: Any, topic: str, profile: Any) -> None:
        what = self.role
        try:
            full = node.resolve(topic)
        except RCLError:
            raise ValueError(f"Failed to create {what} due to invalid topic name '{topic}'") from None
        if any(end.name == full and end.type_name != type_name(kind) for end in _topic_ends(node.context)):
            raise RCLError(
                f"Failed to create {what}: create_{what}() called for existing topic name rt{full} "
                f"with incompatible type {kind.__name__}"
            )
        super().__init__(node, kind, topic, "rostopic", profile)
        self.matched: list[Any] = []
        self.statuses: dict[Any, Status] = {}
        self._deadline_alarm: Alarm | None = None
        WORLD.ends.append(self)

    def get_topic_name(self) -> str:
        return self.name

    def _release(self) -> None:
        if self in WORLD.ends:
            WORLD.ends.remove(self)
        self._rearm_deadline(None)
        for other in self.matched:
            other.lose(self)
        self.matched.clear()

    def find(self, end: Any) -> None:
        """Match another endpoint that has been discovered."""
        self.matched.append(end)
        self.statuses[self._match_event].count(total_count=1, current_count=1)

    def lose(self, end: Any) -> None:
        """Forget another endpoint that is gone."""
        if end in self.matched and not self.is_destroyed:
            self.matched.remove(end)
            self.statuses[self._match_event].count(total_count=0, current_count=-1)

    _match_event: Any = None
    _deadline_event: Any = None

    def _rearm_deadline(self, period: int | None) -> None:
        if self._deadline_alarm is not None:
            self._deadline_alarm.cancel()
            self._deadline_alarm = None
        if period is not None and period < RMW_DURATION_INFINITE:
            self._deadline_alarm = SCHEDULER.call_at(SCHEDULER.now + period, self._miss_deadline)

    def _miss_deadline(self) -> None:
        self.statuses[self._deadline_event].count(total_count=1)
        self._rearm_deadline(self.profile.deadline)


def _topic_ends(context: Participant) -> list[Endpoint]:
    roles = {"publisher", "subscription"}
    return [end for end in WORLD.ends if end.role in roles and end.node.context is context]


def _meet(publisher: Publisher, subscription: Subscription) -> None:
    policy = mismatch(publisher.profile, subscription.profile)
    if policy is not None:
        publisher.statuses[_ON_PUBLISHER.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS].count(
            total_count=1, last_policy_kind=policy
        )
        subscription.statuses[_ON_SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS].count(
            total_count=1, last_policy_kind=policy
        )
        return
    publisher.find(subscription)
    subscription.find(publisher)


class Publisher(_Topic):
    """The publisher of a topic."""

    role = "publisher"
    _match_event = _ON_PUBLISHER.RCL_PUBLISHER_MATCHED
    _deadline_event = _ON_PUBLISHER.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED

    def __init__(self, node: Node, kind: Any, topic: str, profile: Any = None) -> None:
        wanted = profile or rmw_qos_profile_t.predefined("qos_profile_default")
        super().__init__(node, kind, topic, wanted)
        self.profile = wanted.resolved(True, [end.profile for end in self._others("subscription")])
        self.statuses = {
            self._deadline_event: Status(records.rmw_offered_deadline_missed_status_t),
            _ON_PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST: Status(records.rmw_liveliness_lost_status_t),
            _ON_PUBLISHER.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: Status(
                records.rmw_requested_qos_incompatible_event_status_t
            ),
            _ON_PUBLISHER.RCL_PUBLISHER_INCOMPATIBLE_TYPE: Status(records.rmw_incompatible_type_status_t),
            self._match_event: Status(records.rmw_matched_status_t),
        }
        self.kept: deque[SentMessage] = deque(maxlen=self.profile.kept)
        self.is_alive = self.profile.liveliness == AUTOMATIC
        self._published = 0
        self._lease_alarm: Alarm | None = None
        for subscription in list(self._others("subscription")):
            self.when_both_are_seen(subscription, partial(_meet, self, subscription))

    def get_subscription_count(self) -> int:
        return len(self.matched)

    def publish(self, message: Any) -> None:
        """Send a message to all subscriptions that match now."""
        if isinstance(message, bytes):
            self.publish_raw(message)
            return
        self._send(converted(message, self.kind))

    def publish_raw(self, data: bytes) -> None:
        """Publish a serialized message; its validity is checked by the subscription."""
        self._send(bytes(data))

    def _send(self, message: Any) -> None:
        SCHEDULER.may_switch()
        self._published += 1
        now = SCHEDULER.system_time
        lifespan = self.profile.lifespan
        sample = SentMessage(
            message,
            now,
            self._published,
            self.gid,
            now + lifespan if lifespan < RMW_DURATION_INFINITE else None,
        )
        if self.profile.durability == TRANSIENT_LOCAL:
            self.kept.append(sample)
        self.assert_liveliness()
        self._rearm_deadline(self.profile.deadline)
        for subscription in list(self.matched):
            subscription.receive(sample, self)

    def find(self, end: Any) -> None:
        super().find(end)
        if self.profile.durability == TRANSIENT_LOCAL and end.profile.durability == TRANSIENT_LOCAL:
            for sample in self.kept:
                end.receive(sample, self)

    def wait_for_all_acked(self, timeout: Any) -> bool:
        return True

    def assert_liveliness(self) -> None:
        """Assert that it is alive; this must be repeated within its lease."""
        if self.profile.liveliness != MANUAL_BY_TOPIC or self.profile.lease == RMW_DURATION_INFINITE:
            return
        if not self.is_alive:
            self.is_alive = True
            for subscription in self.matched:
                subscription.hear_of_life(self)
        if self._lease_alarm is not None:
            self._lease_alarm.cancel()
        self._lease_alarm = SCHEDULER.call_at(SCHEDULER.now + self.profile.lease, self.lose_liveliness)

    def lose_liveliness(self) -> None:
        """Mark the publisher as not alive: it has not asserted its liveliness in time."""
        if self.is_alive and not self.is_destroyed:
            self.is_alive = False
            self.statuses[_ON_PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST].count(total_count=1)
            for subscription in self.matched:
                subscription.hear_of_death(self)

    def _release(self) -> None:
        if self._lease_alarm is not None:
            self._lease_alarm.cancel()
        super()._release()


class Subscription(_Topic):
    """A subscription to a topic."""

    role = "subscription"
    _match_event = _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_MATCHED
    _deadline_event = _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED

    def __init__(
        self, node: Node, kind: Any, topic: str, profile: Any = None, content_filter_options: Any = None
    ) -> None:
        wanted = profile or rmw_qos_profile_t.predefined("qos_profile_default")
        super().__init__(node, kind, topic, wanted)
        self.profile = wanted.resolved(False, [end.profile for end in self._others("publisher")])
        self.statuses = {
            self._deadline_event: Status(records.rmw_requested_deadline_missed_status_t),
            _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: Status(
                records.rmw_liveliness_changed_status_t
            ),
            _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: Status(
                records.rmw_requested_qos_incompatible_event_status_t
            ),
            _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_MESSAGE_LOST: Status(records.rmw_message_lost_status_t),
            _ON_SUBSCRIPTION.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE: Status(
                records.rmw_incompatible_type_status_t
            ),
            self._match_event: Status(records.rmw_matched_status_t),
        }
        self.queue: deque[tuple[SentMessage, int]] = deque(maxlen=self.profile.kept)
        self._filter: ContentFilter | None = None
        if content_filter_options is not None:
            self.set_content_filter(
                content_filter_options.filter_expression, content_filter_options.expression_parameters
            )
        self._last_arrivals: dict[int, int] = {}
        for publisher in list(self._others("publisher")):
            self.when_both_are_seen(publisher, partial(_meet, publisher, self))

    def receive(self, sample: SentMessage, publisher: Publisher) -> None:
        """Put a message into the queue, now or after its transit time."""
        transit = SCHEDULER.schedule.transit()
        at = max(
            SCHEDULER.now + transit, self._last_arrivals.get(publisher.number, 0)
        )  # none overtakes another
        if at <= SCHEDULER.now:
            self._arrive(sample)
        else:
            self._last_arrivals[publisher.number] = at
            SCHEDULER.call_at(at, lambda: self._arrive(sample))

    def _arrive(self, sample: SentMessage) -> None:
        if self.is_destroyed or not (self._filter is None or self._filter.accepts(sample.message)):
            return
        self.queue.append((sample, SCHEDULER.system_time))
        self._rearm_deadline(self.profile.deadline)
        self.changed()

    @property
    def is_ready(self) -> bool:
        while self.queue:
            expires = self.queue[0][0].expires
            if expires is None or expires > SCHEDULER.system_time:
                return True
            self.queue.popleft()
        return False

    def take_message(self, kind: Any, raw: bool) -> tuple[Any, dict[str, Any]] | None:
        """Return the oldest message, as a new object, and its metadata; None if there is none."""
        if not self.is_ready:
            return None
        sample, received = self.queue.popleft()
        message = sample.message
        if isinstance(message, bytes):
            message = message if raw else rclpy_deserialize(message, kind)
        else:
            message = rclpy_serialize(message, self.kind) if raw else converted(message, kind)
        return message, {
            "source_timestamp": sample.stamp,
            "received_timestamp": received,
            "publication_sequence_number": sample.number,
            "reception_sequence_number": None,
            "publisher_gid": {"implementation_identifier": "rmw_fastrtps_cpp", "data": bytes(sample.gid)},
        }

    def get_publisher_count(self) -> int:
        return len(self.matched)

    def find(self, end: Any) -> None:
        super().find(end)
        if end.is_alive and self._learns_of(end):
            self.hear_of_life(end)

    def _learns_of(self, publisher: Publisher) -> bool:
        """Return whether a publisher's liveliness is seen here, which it is not within one context."""
        return publisher.profile.liveliness != AUTOMATIC or publisher.node.context is not self.node.context

    def lose(self, end: Any) -> None:
        if (
            end in self.matched
            and not self.is_destroyed
            and self._follows_liveliness
            and self._learns_of(end)
        ):
            gone = {"alive_count": -1} if end.is_alive else {"not_alive_count": -1}
            self._liveliness.count(**gone)
        super().lose(end)

    @property
    def _follows_liveliness(self) -> bool:
        return self.profile.lease < RMW_DURATION_INFINITE

    @property
    def _liveliness(self) -> Status:
        return self.statuses[_ON_SUBSCRIPTION.RCL_SUBSCRIPTION_LIVELINESS_CHANGED]

    def hear_of_life(self, publisher: Publisher) -> None:
        if self._follows_liveliness:
            again = publisher.statuses[_ON_PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST].values.total_count > 0
            self._liveliness.count(alive_count=1, not_alive_count=-1 if again else 0)

    def hear_of_death(self, publisher: Publisher) -> None:
        if self._follows_liveliness:
            self._liveliness.count(alive_count=-1, not_alive_count=1)

    def is_cft_enabled(self) -> bool:
        return self._filter is not None

    def set_content_filter(self, expression: str, parameters: list[str]) -> None:
        """Receive only messages for which an expression holds; an empty expression removes the filter."""
        self._filter = ContentFilter(expression, parameters) if expression else None

    def get_content_filter(self) -> Any:
        from rclpy.subscription_content_filter_options import ContentFilterOptions  # noqa: PLC0415

        if self._filter is None:
            raise RCLError("failed to get content filter: subscription has none")
        return ContentFilterOptions(self._filter.expression, self._filter.parameters)


def rclpy_assert_liveliness(publisher: Publisher) -> None:
    """Assert that a publisher is alive."""
    publisher.assert_liveliness()


for _kind in (Publisher, Subscription):
    _kind.__module__ = MODULE
