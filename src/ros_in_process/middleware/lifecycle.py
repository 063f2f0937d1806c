"""The state machine of lifecycle nodes, with its services and the topic of transitions."""

from __future__ import annotations

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.graph import Destroyable, Node
from ros_in_process.middleware.logs import log
from ros_in_process.middleware.records import MODULE, RCLError
from ros_in_process.middleware.services import Service
from ros_in_process.middleware.topics import Publisher

STATES = {
    0: "unknown", 1: "unconfigured", 2: "inactive", 3: "active", 4: "finalized", 10: "configuring",
    11: "cleaningup",
    12: "shuttingdown", 13: "activating", 14: "deactivating", 15: "errorprocessing",
}  # fmt: skip
#: number, label, from which state, to which
TRANSITIONS = [
    (1, "configure", 1, 10),
    (10, "transition_success", 10, 2), (11, "transition_failure", 10, 1), (12, "transition_error", 10, 15),
    (2, "cleanup", 2, 11),
    (20, "transition_success", 11, 1), (21, "transition_failure", 11, 2), (22, "transition_error", 11, 15),
    (3, "activate", 2, 13),
    (30, "transition_success", 13, 3), (31, "transition_failure", 13, 2), (32, "transition_error", 13, 15),
    (4, "deactivate", 3, 14),
    (40, "transition_success", 14, 2), (41, "transition_failure", 14, 3), (42, "transition_error", 14, 15),
    (5, "shutdown", 1, 12), (6, "shutdown", 2, 12), (7, "shutdown", 3, 12),
    (50, "transition_success", 12, 4), (51, "transition_failure", 12, 4), (52, "transition_error", 12, 15),
    (60, "transition_success", 15, 1), (61, "transition_failure", 15, 4), (62, "transition_error", 15, 4),
]  # fmt: skip

TransitionData = tuple[int, str, int, str, int, str]


def _described(number: int, label: str, start: int, goal: int) -> TransitionData:
    return number, label, start, STATES[start], goal, STATES[goal]


class LifecycleStateMachine(Destroyable):
    """The state of a lifecycle node."""

    initialized = True

    def __init__(self, node: Node, communicates: bool) -> None:
        from lifecycle_msgs import srv  # noqa: PLC0415  (only where there is ROS)
        from lifecycle_msgs.msg import TransitionEvent  # noqa: PLC0415

        super().__init__()
        if not isinstance(communicates, bool):
            raise TypeError(
                "__init__(): incompatible constructor arguments: whether it communicates is no bool"
            )
        self._state = 1
        self._services: dict[str, Service] = {}
        self._events: Publisher | None = None
        if communicates:
            for name, kind in (
                ("change_state", srv.ChangeState),
                ("get_state", srv.GetState),
                ("get_available_states", srv.GetAvailableStates),
                ("get_available_transitions", srv.GetAvailableTransitions),
                ("get_transition_graph", srv.GetAvailableTransitions),
            ):
                self._services[name] = Service(node, kind, f"~/{name}")
            self._events = Publisher(node, TransitionEvent, "~/transition_event")
            self._events.is_internal = True

    def _release(self) -> None:
        for service in self._services.values():
            service.destroy_when_not_in_use()
        if self._events is not None:
            self._events.destroy_when_not_in_use()

    @property
    def service_change_state(self) -> Service | None:
        return self._services.get("change_state")

    @property
    def service_get_state(self) -> Service | None:
        return self._services.get("get_state")

    @property
    def service_get_available_states(self) -> Service | None:
        return self._services.get("get_available_states")

    @property
    def service_get_available_transitions(self) -> Service | None:
        return self._services.get("get_available_transitions")

    @property
    def service_get_transition_graph(self) -> Service | None:
        return self._services.get("get_transition_graph")

    @property
    def current_state(self) -> tuple[int, str]:
        return self._state, STATES[self._state]

    @property
    def available_states(self) -> list[tuple[int, str]]:
        return list(STATES.items())

    @property
    def transition_graph(self) -> list[TransitionData]:
        return [_described(*transition) for transition in TRANSITIONS]

    @property
    def available_transitions(self) -> list[TransitionData]:
        return [_described(*transition) for transition in TRANSITIONS if transition[2] == self._state]

    def _find(self, wanted: int | str) -> tuple[int, str, int, int] | None:
        for transition in TRANSITIONS:
            if transition[2] == self._state and wanted in transition[:2]:
                return transition
        log(
            30,
            "rcl_lifecycle",
            f"No transition matching {wanted} found for current state {STATES[self._state]}",
        )
        return None

    def get_transition_by_label(self, label: str) -> int:
        found = self._find(label)
        if found is None:
            raise RCLError("Failed to get transition from label: error not set")
        return found[0]

    def _trigger(self, wanted: int | str, publishes: bool) -> None:
        found = self._find(wanted)
        if found is None:
            raise RCLError(
                "Failed to trigger lifecycle state machine transition: Transition is not registered."
            )
        number, _, start, goal = found
        self._state = goal
        if publishes and self._events is not None:
            event = self._events.kind(timestamp=SCHEDULER.system_time)
            event.transition.id = number  # its label stays empty, as with real ROS
            event.start_state.id, event.start_state.label = start, STATES[start]
            event.goal_state.id, event.goal_state.label = goal, STATES[goal]
            self._events.publish(event)

    def trigger_transition_by_id(self, number: int, publish: bool) -> None:
        self._trigger(number, publish)

    def trigger_transition_by_label(self, label: str, publish: bool) -> None:
        self._trigger(label, publish)


LifecycleStateMachine.__module__ = MODULE
