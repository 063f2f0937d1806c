"""Quality of service: profiles, the resolution of defaults, and which offers satisfy which requests."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ros_in_process.middleware.records import (
    MODULE,
    RMW_DURATION_INFINITE,
    RMW_QOS_DEADLINE_BEST_AVAILABLE,
    QoSCompatibility,
    rmw_qos_policy_kind_t,
)

SYSTEM_DEFAULT, UNKNOWN = 0, 3
KEEP_LAST, KEEP_ALL = 1, 2
RELIABLE, BEST_EFFORT, RELIABILITY_BEST_AVAILABLE = 1, 2, 4
TRANSIENT_LOCAL, VOLATILE, DURABILITY_BEST_AVAILABLE = 1, 2, 4
AUTOMATIC, MANUAL_BY_TOPIC, LIVELINESS_BEST_AVAILABLE = 1, 3, 5

_BEST = RMW_QOS_DEADLINE_BEST_AVAILABLE
#: history, depth, reliability, durability, lifespan, deadline, liveliness, lease
_PREDEFINED = {
    "qos_profile_unknown": (3, 0, 3, 3, 0, 0, 4, 0),
    "qos_profile_default": (1, 10, 1, 2, 0, 0, 0, 0),
    "qos_profile_system_default": (0, 0, 0, 0, 0, 0, 0, 0),
    "qos_profile_sensor_data": (1, 5, 2, 2, 0, 0, 0, 0),
    "qos_profile_services_default": (1, 10, 1, 2, 0, 0, 0, 0),
    "qos_profile_parameters": (1, 1000, 1, 2, 0, 0, 0, 0),
    "qos_profile_parameter_events": (1, 1000, 1, 2, 0, 0, 0, 0),
    "qos_profile_best_available": (1, 10, 4, 4, 0, _BEST, 5, _BEST),
    "qos_profile_rosout_default": (1, 1000, 1, 1, 10_000_000_000, 0, 0, 0),
}
ACTION_STATUS = "rcl_action_qos_profile_status_default"
_STATUS = (1, 1, 1, 1, 0, 0, 0, 0)


def _nanoseconds(duration: Any) -> int:
    """Return a duration in nanoseconds, infinite for 0, which means none."""
    nanoseconds = int(duration if isinstance(duration, int) else duration.nanoseconds)
    return nanoseconds or RMW_DURATION_INFINITE


def _duration(nanoseconds: int) -> Any:
    from rclpy.duration import Duration  # noqa: PLC0415  (rclpy imports this package's modules first)

    return Duration(nanoseconds=nanoseconds)


class rmw_qos_profile_t:  # noqa: N801  (the name that rclpy uses)
    """A profile as rclpy passes it."""

    def __init__(  # noqa: PLR0917  (as rclpy calls it)
        self, history: int, depth: int, reliability: int, durability: int, lifespan: Any, deadline: Any,
        liveliness: int, lease: Any, avoid_ros_namespace_conventions: bool,
    ) -> None:  # fmt: skip
        self.history, self.depth = int(history), int(depth)
        self.reliability, self.durability, self.liveliness = (
            int(reliability),
            int(durability),
            int(liveliness),
        )
        self.lifespan, self.deadline, self.lease = (
            _nanoseconds(time) for time in (lifespan, deadline, lease)
        )
        self.avoid_ros_namespace_conventions = bool(avoid_ros_namespace_conventions)

    @classmethod
    def predefined(cls, name: str) -> rmw_qos_profile_t:
        if name not in _PREDEFINED:
            raise ValueError(f"Requested unknown rmw_qos_profile: {name}")
        return cls(*_PREDEFINED[name], False)

    def to_dict(self) -> dict[str, Any]:
        """Return the arguments of rclpy's own QoSProfile."""
        times = [
            0 if time == RMW_DURATION_INFINITE else time
            for time in (self.lifespan, self.deadline, self.lease)
        ]
        return self._as_dict(self.depth, self.history, self.liveliness, times)

    def as_discovered(self) -> dict[str, Any]:
        """Return the profile as others discover it: without depth and history, with defaults resolved."""
        return self._as_dict(
            0, UNKNOWN, self.liveliness or AUTOMATIC, [self.lifespan, self.deadline, self.lease]
        )

    def _as_dict(self, depth: int, history: int, liveliness: int, times: list[int]) -> dict[str, Any]:
        lifespan, deadline, lease = map(_duration, times)
        return {
            "depth": depth,
            "history": history,
            "reliability": self.reliability,
            "durability": self.durability,
            "lifespan": lifespan,
            "deadline": deadline,
            "liveliness": liveliness,
            "liveliness_lease_duration": lease,
            "avoid_ros_namespace_conventions": self.avoid_ros_namespace_conventions,
        }

    def resolved(self, is_writer: bool, others: list[rmw_qos_profile_t]) -> rmw_qos_profile_t:
        """Return the profile with system defaults and best-available policies resolved as by Fast DDS."""
        profile = rmw_qos_profile_t.__new__(rmw_qos_profile_t)
        profile.__dict__.update(self.__dict__)
        profile.reliability = self.reliability or (RELIABLE if is_writer else BEST_EFFORT)
        profile.durability = self.durability or VOLATILE
        if self.reliability == RELIABILITY_BEST_AVAILABLE:
            weak = any(other.reliability == BEST_EFFORT for other in others) and not is_writer
            profile.reliability = BEST_EFFORT if weak else RELIABLE
        if self.durability == DURABILITY_BEST_AVAILABLE:
            weak = any(other.durability == VOLATILE for other in others) and not is_writer
            profile.durability = VOLATILE if weak else TRANSIENT_LOCAL
        if self.liveliness in {SYSTEM_DEFAULT, LIVELINESS_BEST_AVAILABLE}:
            manual = any(other.liveliness == MANUAL_BY_TOPIC for other in others) and is_writer
            profile.liveliness = MANUAL_BY_TOPIC if manual and self.liveliness else AUTOMATIC
        profile.deadline = self._best(self.deadline, [other.deadline for other in others])
        profile.lease = self._best(self.lease, [other.lease for other in others])
        return profile

    @staticmethod
    def _best(time: int, others: list[int]) -> int:
        if time != _BEST:
            return time
        return max(others, default=RMW_DURATION_INFINITE)

    @property
    def kept(self) -> int | None:
        """How many messages the history keeps; None for all."""
        return None if self.history == KEEP_ALL else max(self.depth, 1)


rmw_qos_profile_t.__module__ = MODULE


def rclpy_action_get_rmw_qos_profile(name: str) -> dict[str, Any]:
    """Return the profile of an action's status topic."""
    if name != ACTION_STATUS:
        raise RuntimeError(f"Requested unknown rmw_qos_profile: {name}")
    return rmw_qos_profile_t(*_STATUS, False).to_dict()


def mismatch(offered: rmw_qos_profile_t, requested: rmw_qos_profile_t) -> Any:
    """Return the last policy whose offer does not satisfy the request, both resolved; None if all do."""
    kinds = rmw_qos_policy_kind_t
    found = None
    if requested.durability == TRANSIENT_LOCAL and offered.durability == VOLATILE:
        found = kinds.RMW_QOS_POLICY_DURABILITY
    if offered.deadline > requested.deadline:
        found = kinds.RMW_QOS_POLICY_DEADLINE
    if requested.liveliness > offered.liveliness or offered.lease > requested.lease:
        found = kinds.RMW_QOS_POLICY_LIVELINESS
    if requested.reliability == RELIABLE and offered.reliability == BEST_EFFORT:
        found = kinds.RMW_QOS_POLICY_RELIABILITY
    return found


class QoSCheckCompatibleResult:
    """Whether two profiles are compatible, and if not, why."""

    def __init__(self, compatibility: Any = QoSCompatibility.OK, reason: str = "") -> None:
        self.compatibility, self.reason = compatibility, reason


QoSCheckCompatibleResult.__module__ = MODULE


def rclpy_qos_check_compatible(
    offered: rmw_qos_profile_t, requested: rmw_qos_profile_t
) -> QoSCheckCompatibleResult:
    """Return whether an offer satisfies a request, as far as the profiles alone show."""
    errors, warnings = list(_errors(offered, requested)), list(_warnings(offered, requested))
    if errors:
        return QoSCheckCompatibleResult(QoSCompatibility.ERROR, "".join(f"ERROR: {text};" for text in errors))
    if warnings:
        return QoSCheckCompatibleResult(
            QoSCompatibility.WARNING, "".join(f"WARNING: {text};" for text in warnings)
        )
    return QoSCheckCompatibleResult()


def _errors(offered: rmw_qos_profile_t, requested: rmw_qos_profile_t) -> Iterator[str]:
    if offered.reliability == BEST_EFFORT and requested.reliability == RELIABLE:
        yield "Best effort publisher and reliable subscription"
    if offered.durability == VOLATILE and requested.durability == TRANSIENT_LOCAL:
        yield "Volatile publisher and transient local subscription"
    if requested.deadline < RMW_DURATION_INFINITE:
        if offered.deadline == RMW_DURATION_INFINITE:
            yield "Subscription has a deadline, but publisher does not"
        elif requested.deadline < offered.deadline:
            yield "Subscription deadline is less than publisher deadline"
    if offered.liveliness == AUTOMATIC and requested.liveliness == MANUAL_BY_TOPIC:
        yield "Publisher's liveliness is automatic and subscription's is manual by topic"
    if requested.lease < RMW_DURATION_INFINITE:
        if offered.lease == RMW_DURATION_INFINITE:
            yield "Subscription has a liveliness lease duration, but publisher does not"
        elif requested.lease < offered.lease:
            yield "Subscription liveliness lease duration is less than publisher"


def _warnings(offered: rmw_qos_profile_t, requested: rmw_qos_profile_t) -> Iterator[str]:
    open_values = {SYSTEM_DEFAULT, UNKNOWN}
    named: tuple[tuple[str, int, int, int, int, Callable[[int], str]], ...] = (
        ("Reliable", RELIABLE, BEST_EFFORT, offered.reliability, requested.reliability, _open),
        ("Transient local", TRANSIENT_LOCAL, VOLATILE, offered.durability, requested.durability, _open),
    )
    weak_names = {"Reliable": "Best effort", "Transient local": "Volatile"}
    for name, strong, weak, offer, request, text in named:
        if offer in open_values and request in open_values:
            kind = "reliability" if name == "Reliable" else "durability"
            yield f"Publisher {kind} is {text(offer)} and subscription {kind} is {text(request)}"
        elif offer in open_values and request == strong:
            yield f"{name} subscription, but publisher is {text(offer)}"
        elif offer == weak and request in open_values:
            yield f"{weak_names[name]} publisher and subscription is {text(request)}"
    offer, request = offered.liveliness, requested.liveliness
    if offer in {0, 4} and request in {0, 4}:
        yield f"Publisher liveliness is {_open(offer)} and subscription liveliness is {_open(request)}"


def _open(value: int) -> str:
    return "unknown" if value else "system_default"
