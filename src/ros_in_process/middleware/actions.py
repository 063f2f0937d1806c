"""Actions: their services and topics, and the states of their goals."""

from __future__ import annotations

from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER, SECOND
from ros_in_process.middleware.clocks import RosClock, Timer
from ros_in_process.middleware.graph import Destroyable, Node, Waitable
from ros_in_process.middleware.messages import converted
from ros_in_process.middleware.records import MODULE, GoalEvent, RCLError
from ros_in_process.middleware.services import Client, Service
from ros_in_process.middleware.topics import Publisher, Subscription
from ros_in_process.middleware.waiting import WaitSet

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
_ACTIVE = {ACCEPTED, EXECUTING, CANCELING}
_NEXT = {
    (ACCEPTED, GoalEvent.EXECUTE): EXECUTING,
    (ACCEPTED, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.SUCCEED): SUCCEEDED,
    (EXECUTING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.SUCCEED): SUCCEEDED,
    (CANCELING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.CANCELED): CANCELED,
}
#: what a cancel request is answered with
_NONE, _UNKNOWN, _TERMINATED = 0, 2, 3


class _ActionEndpoint(Destroyable):
    """The common part of clients and servers: services and topics with names below the action's."""

    kind_name = ""

    def __init__(self, node: Node, name: str) -> None:
        super().__init__()
        self.node = node
        try:
            node.resolve(name)
        except RCLError as error:
            reason = str(error).partition(": ")[2]
            text = f"Failed to create action {self.kind_name} due to invalid topic name '{name}' : {reason}"
            raise ValueError(text) from None
        self._base = f"{name}/_action"
        self._parts: list[Waitable] = []
        self._indices: list[int] = []

    def _release(self) -> None:
        for part in self._parts:
            part.destroy_when_not_in_use()

    def _is_ready(self, wait_set: WaitSet, kinds: tuple[str, ...]) -> tuple[bool, ...]:
        return tuple(wait_set.is_ready(kind, index) for kind, index in zip(kinds, self._indices, strict=True))


class ActionClient(_ActionEndpoint):
    """The client of an action, which sends goals."""

    kind_name = "client"

    def __init__(
        self, node: Node, kind: Any, name: str, goal: Any, result: Any, cancel: Any, feedback: Any,
        status: Any,
    ) -> None:  # fmt: skip
        super().__init__(node, name)
        impl = kind.Impl
        self._goal = Client(node, impl.SendGoalService, f"{self._base}/send_goal", goal)
        self._cancel = Client(node, impl.CancelGoalService, f"{self._base}/cancel_goal", cancel)
        self._result = Client(node, impl.GetResultService, f"{self._base}/get_result", result)
        self._feedback = Subscription(node, impl.FeedbackMessage, f"{self._base}/feedback", feedback)
        self._status = Subscription(node, impl.GoalStatusMessage, f"{self._base}/status", status)
        self._parts = [self._goal, self._cancel, self._result, self._feedback, self._status]

    def get_num_entities(self) -> tuple[int, int, int, int, int]:
        return 2, 0, 0, 3, 0

    def add_to_waitset(self, wait_set: WaitSet) -> None:
        self._indices = [
            wait_set.add_subscription(self._feedback),
            wait_set.add_subscription(self._status),
            wait_set.add_client(self._goal),
            wait_set.add_client(self._cancel),
            wait_set.add_client(self._result),
        ]

    def is_ready(self, wait_set: WaitSet) -> tuple[bool, ...]:
        """Return whether feedback, a status, a goal response, a cancel response or a result has arrived."""
        return self._is_ready(wait_set, ("subscription", "subscription", "client", "client", "client"))

    def is_action_server_available(self) -> bool:
        servers_speak = self._feedback.matched and self._status.matched
        return bool(servers_speak and self._goal.matched and self._cancel.matched and self._result.matched)

    def send_goal_request(self, request: Any) -> int:
        return self._goal.send_request(request)

    def send_cancel_request(self, request: Any) -> int:
        return self._cancel.send_request(request)

    def send_result_request(self, request: Any) -> int:
        return self._result.send_request(request)

    def take_goal_response(self, kind: Any) -> tuple[Any, Any]:
        return _numbered(self._goal, kind)

    def take_cancel_response(self, kind: Any) -> tuple[Any, Any]:
        return _numbered(self._cancel, kind)

    def take_result_response(self, kind: Any) -> tuple[Any, Any]:
        return _numbered(self._result, kind)

    def take_feedback(self, kind: Any) -> Any:
        taken = self._feedback.take_message(kind, False)
        return None if taken is None else taken[0]

    def take_status(self, kind: Any) -> Any:
        taken = self._status.take_message(kind, False)
        return None if taken is None else taken[0]

    def configure_introspection(self, clock: RosClock, profile: Any, state: Any) -> None:
        for part in (self._goal, self._cancel, self._result):
            part.configure_introspection(clock, profile, state)


def _numbered(client: Client, kind: Any) -> tuple[Any, Any]:
    info, response = client.take_response(kind)
    return (None, None) if info is None else (info.request_id.sequence_number, response)


class ActionServer(_ActionEndpoint):
    """The server of an action, which carries out goals."""

    kind_name = "server"

    def __init__(  # noqa: PLR0917  (as rclpy calls it)
        self, node: Node, clock: RosClock, kind: Any, name: str,
        goal: Any, result: Any, cancel: Any, feedback: Any, status: Any, result_timeout: float,
    ) -> None:  # fmt: skip
        super().__init__(node, name)
        impl = kind.Impl
        self._kind = impl
        self.clock = clock
        self._keeps_results_for = round(result_timeout * SECOND)
        self._goal = Service(node, impl.SendGoalService, f"{self._base}/send_goal", goal)
        self._cancel = Service(node, impl.CancelGoalService, f"{self._base}/cancel_goal", cancel)
        self._result = Service(node, impl.GetResultService, f"{self._base}/get_result", result)
        self._feedback = Publisher(node, impl.FeedbackMessage, f"{self._base}/feedback", feedback)
        self._status = Publisher(node, impl.GoalStatusMessage, f"{self._base}/status", status)
        self._expiry = Timer(clock, node.context, 10**18, autostart=False)
        self._parts = [self._goal, self._cancel, self._result, self._feedback, self._status, self._expiry]
        self.goals: dict[bytes, ActionGoalHandle] = {}

    def get_num_entities(self) -> tuple[int, int, int, int, int]:
        return 0, 0, 1, 0, 3

    def add_to_waitset(self, wait_set: WaitSet) -> None:
        self._indices = [
            wait_set.add_service(self._goal),
            wait_set.add_service(self._cancel),
            wait_set.add_service(self._result),
            wait_set.add_timer(self._expiry),
        ]

    def is_ready(self, wait_set: WaitSet) -> tuple[bool, ...]:
        """Return whether goals, cancel requests, result requests or expired results are waiting."""
        return self._is_ready(wait_set, ("service", "service", "service", "timer"))

    def take_goal_request(self, kind: Any) -> tuple[Any, Any]:
        return _identified(self._goal, kind)

    def take_cancel_request(self, kind: Any) -> tuple[Any, Any]:
        return _identified(self._cancel, kind)

    def take_result_request(self, kind: Any) -> tuple[Any, Any]:
        return _identified(self._result, kind)

    def send_goal_response(self, identity: Any, response: Any) -> None:
        self._goal.service_send_response(response, identity)

    def send_cancel_response(self, identity: Any, response: Any) -> None:
        self._cancel.service_send_response(response, identity)

    def send_result_response(self, identity: Any, response: Any) -> None:
        self._result.service_send_response(response, identity)

    def publish_feedback(self, message: Any) -> None:
        self._feedback.publish(message)

    def publish_status(self) -> None:
        message = self._kind.GoalStatusMessage()
        for goal in self.goals.values():
            message.status_list.append(_status(goal))
        self._status.publish(message)

    def goal_exists(self, info: Any) -> bool:
        return bytes(info.goal_id.uuid) in self.goals

    def process_cancel_request(self, request: Any, kind: Any) -> Any:
        """Return the goals that a cancel request refers to, and whether they can be cancelled."""
        response = kind()
        uuid = bytes(request.goal_info.goal_id.uuid)
        before = _nanoseconds(request.goal_info.stamp)
        if any(uuid):
            goal = self.goals.get(uuid)
            if goal is None:
                response.return_code = _UNKNOWN
            elif not goal.is_active():
                response.return_code = _TERMINATED
        for goal in self.goals.values():
            meant = goal.uuid == uuid or (before and _nanoseconds(goal.info.stamp) <= before)
            if goal.is_cancelable and (meant or not (any(uuid) or before)):
                response.goals_canceling.append(converted(goal.info, type(goal.info)))
        if response.goals_canceling:
            response.return_code = _NONE
        return response

    def notify_goal_done(self) -> None:
        """Note that a goal has ended: its result is kept for a while."""
        for goal in self.goals.values():
            if not goal.is_active() and goal.expires_at is None and self._keeps_results_for >= 0:
                goal.expires_at = self.clock.now() + self._keeps_results_for
        self._set_expiry()

    def _set_expiry(self) -> None:
        ends = [goal.expires_at for goal in self.goals.values() if goal.expires_at is not None]
        self._expiry.cancel_timer()
        if ends:
            self._expiry.reset_timer()
            self._expiry.next_call = min(ends)

    def expire_goals(self, most: int) -> tuple[Any, ...]:
        """Forget the goals whose results have been kept long enough."""
        now = self.clock.now()
        over = [
            goal for goal in self.goals.values() if goal.expires_at is not None and goal.expires_at <= now
        ][:most]
        for goal in over:
            del self.goals[goal.uuid]
        self._set_expiry()
        return tuple(converted(goal.info, type(goal.info)) for goal in over)

    def configure_introspection(self, clock: RosClock, profile: Any, state: Any) -> None:
        for part in (self._goal, self._cancel, self._result):
            part.configure_introspection(clock, profile, state)


def _identified(service: Service, kind: Any) -> tuple[Any, Any]:
    request, info = service.service_take_request(kind)
    return (None, None) if info is None else (info.request_id, request)


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * SECOND + int(stamp.nanosec)


def _status(goal: ActionGoalHandle) -> Any:
    from action_msgs.msg import GoalStatus  # noqa: PLC0415  (only where there is ROS)

    return GoalStatus(goal_info=converted(goal.info, type(goal.info)), status=goal.get_status())


class ActionGoalHandle(Destroyable):
    """A server's goal, and its state."""

    def __init__(self, server: ActionServer, info: Any) -> None:
        super().__init__()
        self.info = converted(info, type(info))
        self.uuid = bytes(self.info.goal_id.uuid)
        if self.uuid in server.goals:
            raise RCLError("Failed to accept new goal: goal ID already exists")
        self.info.stamp.sec, self.info.stamp.nanosec = divmod(server.clock.now(), SECOND)
        self.expires_at: int | None = None
        self._state = ACCEPTED
        server.goals[self.uuid] = self
        SCHEDULER.progress()

    def get_status(self) -> int:
        return self._state

    def is_active(self) -> bool:
        return self._state in _ACTIVE

    @property
    def is_cancelable(self) -> bool:
        return (self._state, GoalEvent.CANCEL_GOAL) in _NEXT

    def update_goal_state(self, event: Any) -> None:
        state = _NEXT.get((self._state, event))
        if state is None:
            raise RCLError(
                f"Failed to update goal state: goal_handle attempted invalid transition from state "
                f"{self._state} with event {event.name}"
            )
        self._state = state


for _kind in (ActionClient, ActionServer, ActionGoalHandle):
    _kind.__module__ = MODULE
