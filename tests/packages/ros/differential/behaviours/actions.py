"""Action servers and clients."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.action import (
    ActionClient,
    ActionServer,
    CancelResponse,
    GoalResponse,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from test_msgs.action import Fibonacci, NestedMessage
from unique_identifier_msgs.msg import UUID

from .declared import behaviour
from .graph import Graph, raised, ready

ACTIONS = "design.ros2.org/articles/actions.html"
STATUS = {
    getattr(GoalStatus, f"STATUS_{name}"): name
    for name in ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
}


class Acting(Graph):
    """A server and a client of an action."""

    def __init__(self, execute: Callable[..., Any], threads: int = 0, **options: Any) -> None:
        if threads:
            super().__init__(
                "server",
                "asker",
                make_executor=lambda **given: MultiThreadedExecutor(threads, **given),
                in_thread=True,
            )
        else:
            super().__init__("server", "asker")
        group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self.nodes[0], Fibonacci, "count", execute, callback_group=group, **options
        )
        self.client = ActionClient(self.nodes[1], Fibonacci, "count")
        ready(self, self.client)
        self.fed: list[list[int]] = []

    def close(self) -> None:
        """End the server and the client before their nodes."""
        self.executor.shutdown(timeout_sec=1.0)
        self.client.destroy()
        self.server.destroy()
        super().close()

    def send(self, order: int = 3, **options: Any) -> Any:
        """Send a goal and give its handle."""
        goal = Fibonacci.Goal(order=order)
        future = self.client.send_goal_async(
            goal,
            feedback_callback=lambda message: self.fed.append(list(message.feedback.sequence)),
            **options,
        )
        return self.result(future)

    def end(self, handle: Any) -> tuple[str, list[int]]:
        """Wait until a goal has ended: how, and its result."""
        response = self.result(handle.get_result_async())
        return STATUS[response.status], list(response.result.sequence)


def count(handle: Any) -> Fibonacci.Result:
    """Count to the goal's order, tell it, and succeed."""
    for number in range(1, handle.request.order + 1):
        handle.publish_feedback(Fibonacci.Feedback(sequence=list(range(number))))
    handle.succeed()
    return Fibonacci.Result(sequence=list(range(handle.request.order)))


def patient(handle: Any) -> Fibonacci.Result:
    """Wait to be cancelled."""
    for _ in range(200):
        if handle.is_cancel_requested:
            handle.canceled()
            return Fibonacci.Result(sequence=[1])
        time.sleep(0.02)
    handle.succeed()
    return Fibonacci.Result()


@behaviour(
    expected=[True, ["SUCCEEDED", [0, 1, 2]], [[0], [0, 1], [0, 1, 2]]],
    source=ACTIONS + ": goal, feedback, result",
)
def a_goal_succeeds() -> Any:
    with Acting(count) as acting:
        handle = acting.send()
        ended = acting.end(handle)
        acting.until(lambda: len(acting.fed) == 3)
        return handle.accepted, ended, acting.fed


@behaviour(expected=[False, "ACCEPTED"], source=ACTIONS + ": a goal is accepted or rejected")
def a_goal_is_rejected() -> Any:
    executed: list[int] = []

    def execute(handle: Any) -> Fibonacci.Result:
        executed.append(handle.request.order)
        handle.succeed()
        return Fibonacci.Result()

    def choose(goal: Fibonacci.Goal) -> GoalResponse:
        return GoalResponse.REJECT if goal.order > 5 else GoalResponse.ACCEPT

    with Acting(execute, goal_callback=choose) as acting:
        rejected, accepted = acting.send(9), acting.send(2)
        acting.end(accepted)
        assert executed == [2]
        return rejected.accepted, "ACCEPTED" if accepted.accepted else "REJECTED"


@behaviour(expected=["ABORTED", [7]], source=ACTIONS + ", goal states: abort")
def a_goal_is_aborted() -> Any:
    def execute(handle: Any) -> Fibonacci.Result:
        handle.abort()
        return Fibonacci.Result(sequence=[7])

    with Acting(execute) as acting:
        return acting.end(acting.send())


@behaviour(
    expected=["ABORTED", []],
    source="rclpy.action.server: if the user did not trigger a terminal state, assume aborted",
)
def a_goal_whose_end_is_not_said_is_aborted() -> Any:
    with Acting(lambda handle: Fibonacci.Result()) as acting:
        return acting.end(acting.send())


@behaviour(
    expected=["ABORTED", []],
    source="rclpy.action.server: create an empty result so that a response can still be sent",
)
def an_exception_in_an_action_aborts_the_goal() -> Any:
    def execute(handle: Any) -> Fibonacci.Result:
        raise ValueError("no")

    with Acting(execute) as acting:
        return acting.end(acting.send())


@behaviour(
    expected=[[0, 1], ["CANCELED", [1]]],
    source=ACTIONS + ", goal states: canceling, canceled; action_msgs/CancelGoal: ERROR_NONE is 0",
)
def a_goal_is_cancelled() -> Any:
    with Acting(patient, threads=4, cancel_callback=lambda handle: CancelResponse.ACCEPT) as acting:
        handle = acting.send()
        answer = acting.result(handle.cancel_goal_async())
        return (answer.return_code, len(answer.goals_canceling)), acting.end(handle)


# action_msgs/CancelGoal would have 1, ERROR_REJECTED; rclpy leaves it at 0 when the callback rejects
@behaviour()
def cancelling_is_rejected_by_default() -> Any:
    def execute(handle: Any) -> Fibonacci.Result:
        time.sleep(0.5)
        handle.succeed()
        return Fibonacci.Result()

    with Acting(execute, threads=4) as acting:
        handle = acting.send()
        answer = acting.result(handle.cancel_goal_async())
        return (answer.return_code, len(answer.goals_canceling)), acting.end(handle)[0]


@behaviour(expected=[3, 0], source="action_msgs/CancelGoal: ERROR_GOAL_TERMINATED is 3")
def a_goal_that_has_ended_is_not_cancelled() -> Any:
    with Acting(count, cancel_callback=lambda handle: CancelResponse.ACCEPT) as acting:
        handle = acting.send()
        acting.end(handle)
        answer = acting.result(handle.cancel_goal_async())
        return answer.return_code, len(answer.goals_canceling)


@behaviour(expected=[2, 0], source="action_msgs/CancelGoal: ERROR_UNKNOWN_GOAL_ID is 2")
def an_unknown_goal_is_not_cancelled() -> Any:
    with Acting(count, cancel_callback=lambda handle: CancelResponse.ACCEPT) as acting:
        client = acting.nodes[1].create_client(CancelGoal, "count/_action/cancel_goal")
        ready(acting, client)
        request = CancelGoal.Request()
        request.goal_info.goal_id = UUID(uuid=[5] * 16)
        answer = acting.result(client.call_async(request))
        return answer.return_code, len(answer.goals_canceling)


@behaviour(
    expected=[0, 2, ["CANCELED", "CANCELED"]],
    source="action_msgs/CancelGoal: if the goal ID is zero and timestamp is zero, cancel all goals",
)
def all_goals_are_cancelled() -> Any:
    with Acting(patient, threads=6, cancel_callback=lambda handle: CancelResponse.ACCEPT) as acting:
        handles = [acting.send(), acting.send()]
        client = acting.nodes[1].create_client(CancelGoal, "count/_action/cancel_goal")
        ready(acting, client)
        answer = acting.result(client.call_async(CancelGoal.Request()))
        ends = [acting.end(handle)[0] for handle in handles]
        return answer.return_code, len(answer.goals_canceling), ends


@behaviour()
def a_goal_goes_through_its_states() -> Any:
    seen: list[Any] = []

    def execute(handle: Any) -> Fibonacci.Result:
        seen.append((STATUS[handle.status], handle.is_active, handle.is_cancel_requested))
        handle.succeed()
        seen.append((STATUS[handle.status], handle.is_active, handle.is_cancel_requested))
        return Fibonacci.Result()

    def accept(handle: Any) -> None:
        seen.append((STATUS[handle.status], handle.is_active, handle.is_cancel_requested))
        handle.execute()

    with Acting(execute, handle_accepted_callback=accept) as acting:
        acting.end(acting.send())
        return seen


@behaviour(
    expected=["ACCEPTED", "EXECUTING", "SUCCEEDED"],
    source=ACTIONS + ": the status topic is published when the state of a goal changes",
)
def the_status_topic_tells_the_states() -> Any:
    told: list[str] = []
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    with Acting(count) as acting:
        watcher = acting.nodes[1]
        watcher.create_subscription(
            GoalStatusArray,
            "count/_action/status",
            lambda message: told.extend(STATUS[status.status] for status in message.status_list),
            latched,
        )
        acting.until(lambda: watcher.count_publishers("count/_action/status"))
        acting.spin()
        acting.end(acting.send())
        acting.until(lambda: "SUCCEEDED" in told)
        return list(dict.fromkeys(told))


@behaviour(
    expected=["RCLError", "RCLError", "RCLError", "SUCCEEDED"],
    source=ACTIONS + ", goal states: a terminal state has no transitions",
)
def a_goal_ends_once() -> Any:
    errors: list[str] = []

    def execute(handle: Any) -> Fibonacci.Result:
        errors.append(raised(handle.canceled))
        handle.succeed()
        errors.append(raised(handle.succeed))
        errors.append(raised(handle.abort))
        return Fibonacci.Result()

    with Acting(execute) as acting:
        ended = acting.end(acting.send())[0]
        return [*errors, ended]


@behaviour()
def a_goal_is_executed_later() -> Any:
    waiting: list[Any] = []
    with Acting(count, handle_accepted_callback=waiting.append) as acting:
        handle = acting.send(2)
        acting.spin()
        before = STATUS[waiting[0].status]
        waiting[0].execute()
        return before, acting.end(handle)


@behaviour()
def a_goal_is_cancelled_before_it_is_executed() -> Any:
    waiting: list[Any] = []
    with Acting(
        patient, handle_accepted_callback=waiting.append, cancel_callback=lambda handle: CancelResponse.ACCEPT
    ) as acting:
        handle = acting.send()
        answer = acting.result(handle.cancel_goal_async())
        before = STATUS[waiting[0].status]
        waiting[0].execute()
        return answer.return_code, before, acting.end(handle)


@behaviour(
    expected=["ABORTED", "SUCCEEDED"], source="rclpy examples, server_single_goal: the newer goal wins"
)
def a_newer_goal_aborts_the_one_before() -> Any:
    current: list[Any] = []

    def accept(handle: Any) -> None:
        if current and current[-1].is_active:
            current[-1].abort()
        current.append(handle)
        handle.execute()

    def execute(handle: Any) -> Fibonacci.Result:
        for _ in range(handle.request.order):
            if not handle.is_active:
                return Fibonacci.Result()
            time.sleep(0.02)
        handle.succeed()
        return Fibonacci.Result()

    with Acting(execute, threads=4, handle_accepted_callback=accept) as acting:
        long, short = acting.send(200), acting.send(2)
        return [acting.end(handle)[0] for handle in (long, short)]


@behaviour()
def two_goals_at_once() -> Any:
    with Acting(count, threads=4) as acting:
        handles = [acting.send(order) for order in (2, 4)]
        return [acting.end(handle) for handle in handles]


@behaviour()
def a_result_is_asked_for_twice() -> Any:
    with Acting(count) as acting:
        handle = acting.send(2)
        return acting.end(handle), acting.end(handle)


@behaviour()
def a_result_is_forgotten_after_its_time() -> Any:
    with Acting(count, result_timeout=1) as acting:
        handle = acting.send(2)
        kept = acting.end(handle)
        acting.spin(2.0)
        return kept, acting.end(handle)


@behaviour()
def a_goal_id_is_used_twice() -> Any:
    with Acting(count) as acting:
        number = UUID(uuid=[7] * 16)
        first = acting.send(goal_uuid=number)
        acting.end(first)
        return first.accepted, bytes(first.goal_id.uuid).hex(), acting.send(goal_uuid=number).accepted


@behaviour(
    expected=[False, False, True],
    source="rclpy.action.client.ActionClient.wait_for_server: True if an action server is available",
)
def an_action_client_knows_whether_its_server_is_there() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        client = ActionClient(asker, Fibonacci, "count")
        seen = [client.server_is_ready(), client.wait_for_server(timeout_sec=0.3)]
        acting = ActionServer(server, Fibonacci, "count", count)
        seen.append(client.wait_for_server(timeout_sec=5.0))
        client.destroy()
        acting.destroy()
        return seen


@behaviour(
    expected=["SUCCEEDED", [0, 1]], source="rclpy.action.client.ActionClient.send_goal: sends and waits"
)
def a_goal_is_sent_and_waited_for() -> Any:
    with Acting(count, threads=3) as acting:
        response = acting.client.send_goal(Fibonacci.Goal(order=2))
        return STATUS[response.status], list(response.result.sequence)


@behaviour(
    expected=["TypeError", "TypeError"],
    source="rclpy.action.client.ActionClient.send_goal_async: raises TypeError for another type",
)
def goals_and_feedback_of_another_type() -> Any:
    errors: list[str] = []

    def execute(handle: Any) -> Fibonacci.Result:
        errors.append(raised(handle.publish_feedback, Fibonacci.Result()))
        handle.succeed()
        return Fibonacci.Result()

    with Acting(execute) as acting:
        acting.end(acting.send())
        return [*errors, raised(acting.client.send_goal_async, NestedMessage.Goal())]


@behaviour()
def an_action_that_is_a_coroutine() -> Any:
    async def execute(handle: Any) -> Fibonacci.Result:
        handle.publish_feedback(Fibonacci.Feedback(sequence=[1]))
        handle.succeed()
        return Fibonacci.Result(sequence=[2])

    with Acting(execute) as acting:
        ended = acting.end(acting.send())
        acting.until(lambda: acting.fed)
        return ended, acting.fed


@behaviour()
def only_the_client_of_a_goal_gets_its_feedback() -> Any:
    with Acting(count) as acting:
        other = ActionClient(acting.nodes[1], Fibonacci, "count")
        ready(acting, other)
        fed: list[int] = []
        goal = Fibonacci.Goal(order=1)
        future = other.send_goal_async(goal, feedback_callback=lambda message: fed.append(1))
        other_handle = acting.result(future)
        acting.end(acting.send(3))
        acting.result(other_handle.get_result_async())
        acting.spin()
        other.destroy()
        return len(acting.fed), len(fed)


@behaviour()
def a_server_that_ends_in_the_midst_of_a_goal() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        waiting: list[Any] = []
        acting = ActionServer(server, Fibonacci, "count", count, handle_accepted_callback=waiting.append)
        client = ActionClient(asker, Fibonacci, "count")
        ready(graph, client)
        handle = graph.result(client.send_goal_async(Fibonacci.Goal(order=1)))
        future = handle.get_result_async()
        graph.spin()
        acting.destroy()
        gone = graph.until(lambda: not client.server_is_ready())
        done = future.done()
        client.destroy()
        return handle.accepted, gone, done


@behaviour(
    expected=[["/count", ["test_msgs/action/Fibonacci"]]],
    source="rclpy.action.graph.get_action_names_and_types: names and types of all actions",
)
def actions_have_names() -> Any:
    with Acting(count) as acting:
        asker = acting.nodes[1]
        by_node = get_action_server_names_and_types_by_node(asker, "server", "/")
        assert by_node == get_action_names_and_types(asker)
        return by_node


@behaviour(
    expected=[
        ["cancel_goal", "get_result", "send_goal"],
        ["feedback", "status"],
    ],
    source=ACTIONS + ": three services and two topics, hidden in _action",
)
def an_action_is_services_and_topics() -> Any:
    with Acting(count) as acting:
        asker = acting.nodes[1]
        services = dict(asker.get_service_names_and_types_by_node("server", "/"))
        topics = dict(asker.get_publisher_names_and_types_by_node("server", "/"))
        return [
            sorted(name.rpartition("/")[2] for name in names if "/_action/" in name)
            for names in (services, topics)
        ]
