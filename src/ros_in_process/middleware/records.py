"""The middleware's errors, enumerations and records: names and values as the real extension exports them."""

from __future__ import annotations

import builtins
from types import SimpleNamespace
from typing import Any, ClassVar

RCL_DEFAULT_DOMAIN_ID = 2**64 - 1
RMW_DURATION_INFINITE = 2**63 - 1
RMW_QOS_DEADLINE_BEST_AVAILABLE = RMW_DURATION_INFINITE - 1
RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE = RMW_DURATION_INFINITE - 1

MODULE = "rclpy._rclpy_pybind11"


def _error(name: str, *bases: type[Exception]) -> type[Exception]:
    return type(name, bases, {"__module__": MODULE})


InvalidHandle = _error("InvalidHandle", RuntimeError)
RCLError = _error("RCLError", RuntimeError)
NodeNameNonExistentError = _error("NodeNameNonExistentError", RCLError)
NotImplementedError = _error("NotImplementedError", builtins.NotImplementedError)
RCLInvalidROSArgsError = _error("RCLInvalidROSArgsError", RCLError)
RCUtilsError = _error("RCUtilsError", RuntimeError)
RMWError = _error("RMWError", RuntimeError)
TimerCancelledError = _error("TimerCancelledError", RCLError)
UnknownROSArgsError = _error("UnknownROSArgsError", RuntimeError)
UnsupportedEventTypeError = _error("UnsupportedEventTypeError", RCLError)


class Constant:
    """A member of an enumeration of the real extension: equal to its number, but without an order.

    No `enum.Enum`: pytest would name tests with it as parameter otherwise than over real ROS.
    """

    __members__: ClassVar[dict[str, Constant]] = {}
    name: str
    value: int

    def __new__(cls, value: int) -> Any:
        for member in cls.__members__.values():
            if member.value == int(value):
                return member
        raise ValueError(f"{value!r} is not a valid {cls.__name__}")

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Constant):
            return self is other
        return isinstance(other, int) and self.value == other

    def __hash__(self) -> int:
        return hash(self.value)

    def __int__(self) -> int:
        return self.value

    __index__ = __int__

    def __reduce__(self) -> tuple[Any, ...]:
        return getattr, (type(self), self.name)

    def __str__(self) -> str:
        return f"{type(self).__name__}.{self.name}"

    def __repr__(self) -> str:
        return f"<{type(self).__name__}.{self.name}: {self.value}>"


def _enumeration(name: str, base: type[Constant] = Constant, **members: int) -> Any:
    kind: Any = type(name, (base,), {"__module__": MODULE, "__members__": {}})
    for key, value in members.items():
        member = object.__new__(kind)
        member.name, member.value = key, value
        kind.__members__[key] = member
        setattr(kind, key, member)
    return kind


ClockChange = _enumeration(
    "ClockChange", ROS_TIME_NO_CHANGE=1, ROS_TIME_ACTIVATED=2, ROS_TIME_DEACTIVATED=3, SYSTEM_TIME_NO_CHANGE=4
)
ClockType = _enumeration("ClockType", UNINITIALIZED=0, ROS_TIME=1, SYSTEM_TIME=2, STEADY_TIME=3)
GoalEvent = _enumeration("GoalEvent", EXECUTE=0, CANCEL_GOAL=1, SUCCEED=2, ABORT=3, CANCELED=4)
QoSCompatibility = _enumeration("QoSCompatibility", OK=0, WARNING=1, ERROR=2)
RCUTILS_LOG_SEVERITY = _enumeration(
    "RCUTILS_LOG_SEVERITY",
    RCUTILS_LOG_SEVERITY_UNSET=0, RCUTILS_LOG_SEVERITY_DEBUG=10, RCUTILS_LOG_SEVERITY_INFO=20,
    RCUTILS_LOG_SEVERITY_WARN=30, RCUTILS_LOG_SEVERITY_ERROR=40, RCUTILS_LOG_SEVERITY_FATAL=50,
)  # fmt: skip
SignalHandlerOptions = _enumeration("SignalHandlerOptions", NO=0, SIGINT=1, SIGTERM=2, ALL=3)
rcl_publisher_event_type_t = _enumeration(
    "rcl_publisher_event_type_t",
    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED=0, RCL_PUBLISHER_LIVELINESS_LOST=1,
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS=2, RCL_PUBLISHER_INCOMPATIBLE_TYPE=3, RCL_PUBLISHER_MATCHED=4,
)  # fmt: skip
rcl_subscription_event_type_t = _enumeration(
    "rcl_subscription_event_type_t",
    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED=0, RCL_SUBSCRIPTION_LIVELINESS_CHANGED=1,
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS=2, RCL_SUBSCRIPTION_MESSAGE_LOST=3,
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE=4, RCL_SUBSCRIPTION_MATCHED=5,
)  # fmt: skip
rmw_qos_policy_kind_t = _enumeration(
    "rmw_qos_policy_kind_t",
    RMW_QOS_POLICY_INVALID=1, RMW_QOS_POLICY_DURABILITY=2, RMW_QOS_POLICY_DEADLINE=4,
    RMW_QOS_POLICY_LIVELINESS=8,
    RMW_QOS_POLICY_RELIABILITY=16, RMW_QOS_POLICY_HISTORY=32, RMW_QOS_POLICY_LIFESPAN=64,
    RMW_QOS_POLICY_DEPTH=128,
    RMW_QOS_POLICY_LIVELINESS_LEASE_DURATION=256, RMW_QOS_POLICY_AVOID_ROS_NAMESPACE_CONVENTIONS=512,
)  # fmt: skip
service_introspection = SimpleNamespace(
    ServiceIntrospectionState=_enumeration("ServiceIntrospectionState", OFF=0, METADATA=1, CONTENTS=2)
)


class _Return(Constant):
    def to_label(self) -> str:
        return "transition_" + self.name.lower()


TransitionCallbackReturnType = _enumeration(
    "TransitionCallbackReturnType", _Return, SUCCESS=97, FAILURE=98, ERROR=99
)


class Record:
    """A record of named numbers."""

    fields: ClassVar[tuple[str, ...]] = ()

    def __init__(self, *values: Any) -> None:
        if values and len(values) != len(self.fields):
            raise TypeError(f"{type(self).__name__}() takes {len(self.fields)} values, not {len(values)}")
        for field, value in zip(self.fields, values or [0] * len(self.fields), strict=True):
            setattr(self, field, value)

    def __repr__(self) -> str:
        values = ", ".join(f"{field}={getattr(self, field)!r}" for field in self.fields)
        return f"{type(self).__name__}({values})"


def _record(name: str, *fields: str) -> Any:
    return type(name, (Record,), {"fields": fields, "__module__": MODULE})


class rcl_duration_t(Record):  # noqa: N801
    """A duration."""

    fields = ("nanoseconds",)
    nanoseconds: int

    def __init__(self, nanoseconds: int) -> None:
        if not -(2**63) <= int(nanoseconds) < 2**63:
            raise TypeError(
                "__init__(): incompatible constructor arguments: more nanoseconds than 64 bits hold"
            )
        self.nanoseconds = int(nanoseconds)


class rcl_time_point_t(Record):  # noqa: N801
    """A point in time of one clock type."""

    fields = ("nanoseconds", "clock_type")
    nanoseconds: int

    def __init__(self, nanoseconds: int, clock_type: Any) -> None:
        self.nanoseconds = int(nanoseconds)
        self.clock_type = clock_type if isinstance(clock_type, ClockType) else ClockType(int(clock_type))


rmw_request_id_t = _record("rmw_request_id_t", "sequence_number", "writer")
rmw_service_info_t = _record("rmw_service_info_t", "source_timestamp", "received_timestamp", "request_id")
_total = ("total_count", "total_count_change")
_current = ("current_count", "current_count_change")
rmw_matched_status_t = _record("rmw_matched_status_t", *_total, *_current)
rmw_incompatible_type_status_t = _record("rmw_incompatible_type_status_t", *_total)
rmw_liveliness_changed_status_t = _record(
    "rmw_liveliness_changed_status_t",
    "alive_count",
    "not_alive_count",
    "alive_count_change",
    "not_alive_count_change",
)
rmw_liveliness_lost_status_t = _record("rmw_liveliness_lost_status_t", *_total)
rmw_message_lost_status_t = _record("rmw_message_lost_status_t", *_total)
rmw_offered_deadline_missed_status_t = _record("rmw_offered_deadline_missed_status_t", *_total)
rmw_requested_deadline_missed_status_t = _record("rmw_requested_deadline_missed_status_t", *_total)
rmw_requested_qos_incompatible_event_status_t = _record(
    "rmw_requested_qos_incompatible_event_status_t", *_total, "last_policy_kind"
)
