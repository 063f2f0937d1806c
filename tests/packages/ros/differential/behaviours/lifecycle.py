"""Lifecycle nodes."""

from __future__ import annotations

from typing import Any

from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from std_msgs.msg import Int32

from .declared import behaviour
from .graph import Graph, connect, raised, ready

DESIGN = "design.ros2.org/articles/node_lifecycle.html"
SUCCESS, FAILURE, ERROR = (
    TransitionCallbackReturn.SUCCESS,
    TransitionCallbackReturn.FAILURE,
    TransitionCallbackReturn.ERROR,
)


class Machine(LifecycleNode):
    """A node that remembers which callbacks were called, and answers as it was told."""

    def __init__(self, name: str, answers: dict[str, Any] | None = None, **options: Any) -> None:
        self.answers = answers or {}
        self.called: list[str] = []
        super().__init__(name, **options)

    def _answer(self, name: str, state: LifecycleState) -> TransitionCallbackReturn:
        self.called.append(f"{name} from {state.label}")
        answer = self.answers.get(name, SUCCESS)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._answer("configure", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        super().on_activate(state)
        return self._answer("activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        super().on_deactivate(state)
        return self._answer("deactivate", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._answer("cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._answer("shutdown", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._answer("error", state)

    @property
    def state(self) -> str:
        """The label of the state."""
        return str(self._state_machine.current_state[1])


@behaviour(
    expected=[
        ["unconfigured", "inactive", "active", "inactive", "unconfigured", "finalized"],
        [
            "configure from unconfigured",
            "activate from inactive",
            "deactivate from active",
            "cleanup from inactive",
            "shutdown from unconfigured",
        ],
    ],
    source=DESIGN + ": primary states and transitions",
)
def a_whole_life() -> Any:
    with Graph() as graph:
        node = graph.node("machine", Machine)
        states = [node.state]
        for trigger in (
            node.trigger_configure,
            node.trigger_activate,
            node.trigger_deactivate,
            node.trigger_cleanup,
            node.trigger_shutdown,
        ):
            trigger()
            states.append(node.state)
        return states, node.called


@behaviour(
    expected=[["FAILURE", "unconfigured"], ["FAILURE", "inactive"]],
    source=DESIGN + ": on failure the node stays in the state before",
)
def a_transition_fails() -> Any:
    with Graph() as graph:
        first_node = graph.node("one", Machine, answers={"configure": FAILURE})
        second_node = graph.node("two", Machine, answers={"activate": FAILURE})
        first = first_node.trigger_configure().name, first_node.state
        second_node.trigger_configure()
        return first, (second_node.trigger_activate().name, second_node.state)


@behaviour(
    expected=[
        ["ERROR", "unconfigured", "error from unconfigured"],
        ["ERROR", "finalized", "error from inactive"],
    ],
    source=DESIGN + ": ErrorProcessing goes to Unconfigured on success, to Finalized on failure",
)
def a_transition_raises() -> Any:
    with Graph() as graph:
        first_node = graph.node("one", Machine, answers={"configure": ValueError("no")})
        second_node = graph.node("two", Machine, answers={"activate": ERROR, "error": FAILURE})
        first = first_node.trigger_configure().name, first_node.state, first_node.called[-1]
        second_node.trigger_configure()
        return first, (second_node.trigger_activate().name, second_node.state, second_node.called[-1])


@behaviour()
def a_transition_that_is_not_possible() -> Any:
    with Graph() as graph:
        node = graph.node("machine", Machine)
        answers = [node.trigger_activate().name, node.trigger_cleanup().name, node.state]
        node.trigger_configure()
        answers += [node.trigger_configure().name, node.state]
        node.trigger_shutdown()
        return answers, raised(node.trigger_shutdown), node.called


@behaviour(expected=[2], source="rclpy.lifecycle.publisher: publish a message if the publisher is enabled")
def a_publisher_publishes_while_it_is_active() -> Any:
    with Graph("listener") as graph:
        (listener,) = graph
        node = graph.node("machine", Machine)
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        publisher = node.create_lifecycle_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=1))
        node.trigger_configure()
        node.trigger_activate()
        publisher.publish(Int32(data=2))
        node.trigger_deactivate()
        publisher.publish(Int32(data=3))
        graph.spin()
        return heard


@behaviour()
def what_a_node_made_works_in_every_state() -> Any:
    with Graph() as graph:
        node = graph.node("machine", Machine)
        heard: list[int] = []
        ticks: list[int] = []
        node.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        node.create_timer(0.05, lambda: ticks.append(1))
        publisher = node.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=1))
        return graph.until(lambda: heard and ticks), node.state


@behaviour(
    expected=[["unconfigured", 1], True, ["inactive", 2], False, ["inactive", 2]],
    source=DESIGN + ": services of a managed node; lifecycle_msgs/State",
)
def states_are_changed_by_services() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        graph.node("machine", Machine)
        change = asker.create_client(ChangeState, "machine/change_state")
        get = asker.create_client(GetState, "machine/get_state")
        ready(graph, change)
        ready(graph, get)

        def state() -> tuple[str, int]:
            found = graph.result(get.call_async(GetState.Request())).current_state
            return found.label, found.id

        def ask(number: int) -> bool:
            request = ChangeState.Request(transition=Transition(id=number))
            return bool(graph.result(change.call_async(request)).success)

        seen: list[Any] = [state()]
        seen += [ask(Transition.TRANSITION_CONFIGURE), state()]
        seen += [ask(Transition.TRANSITION_CLEANUP + 90), state()]
        return seen


@behaviour()
def states_are_changed_by_labels() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        node = graph.node("machine", Machine)
        change = asker.create_client(ChangeState, "machine/change_state")
        ready(graph, change)
        answers = []
        for label in ("configure", "activate", "nonsense", "shutdown"):
            request = ChangeState.Request(transition=Transition(label=label))
            answers.append((graph.result(change.call_async(request)).success, node.state))
        return answers


@behaviour(
    expected=[
        [["activate", "active"], ["cleanup", "unconfigured"], ["shutdown", "finalized"]],
        ["active", "finalized", "inactive", "unconfigured"],
    ],
    source=DESIGN + ": the transitions out of Inactive; the primary states",
)
def states_and_transitions_are_listed() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        node = graph.node("machine", Machine)
        node.trigger_configure()
        states = asker.create_client(GetAvailableStates, "machine/get_available_states")
        transitions = asker.create_client(GetAvailableTransitions, "machine/get_available_transitions")
        ready(graph, states)
        ready(graph, transitions)
        found = graph.result(transitions.call_async(GetAvailableTransitions.Request())).available_transitions
        known = graph.result(states.call_async(GetAvailableStates.Request())).available_states
        goals = {"activate": "active", "cleanup": "unconfigured", "shutdown": "finalized"}
        primary = (State.PRIMARY_STATE_UNCONFIGURED, State.PRIMARY_STATE_FINALIZED)
        return [
            sorted(
                (description.transition.label, goals.get(description.transition.label, "?"))
                for description in found
            ),
            sorted(state.label for state in known if primary[0] <= state.id <= primary[1]),
        ]


@behaviour()
def the_whole_graph_of_transitions() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        graph.node("machine", Machine)
        client = asker.create_client(GetAvailableTransitions, "machine/get_transition_graph")
        ready(graph, client)
        found = graph.result(client.call_async(GetAvailableTransitions.Request())).available_transitions
        return sorted(
            (
                description.start_state.label,
                description.transition.label,
                description.transition.id,
                description.goal_state.label,
            )
            for description in found
        )


@behaviour()
def transitions_are_told() -> Any:
    with Graph("watcher") as graph:
        (watcher,) = graph
        node = graph.node("machine", Machine, answers={"activate": FAILURE})
        told: list[Any] = []
        watcher.create_subscription(
            TransitionEvent,
            "machine/transition_event",
            lambda event: told.append(
                (event.transition.label, event.start_state.label, event.goal_state.label)
            ),
            10,
        )
        graph.until(lambda: watcher.count_publishers("machine/transition_event"))
        graph.spin()
        node.trigger_configure()
        node.trigger_activate()
        graph.until(lambda: len(told) == 4, 2.0)
        return told


@behaviour()
def a_node_of_one_s_own_destroys_its_publisher() -> Any:
    with Graph() as graph:
        node = graph.node("machine", Machine)
        publisher = node.create_lifecycle_publisher(Int32, "numbers", 10)
        node.trigger_configure()
        node.trigger_activate()
        enabled = publisher.is_activated
        destroyed = node.destroy_lifecycle_publisher(publisher)
        return enabled, destroyed, raised(publisher.publish, Int32()), node.trigger_deactivate().name


@behaviour()
def the_services_of_a_lifecycle_node() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        graph.node("machine", Machine, start_parameter_services=False)
        graph.node("silent", Machine, enable_communication_interface=False, start_parameter_services=False)
        return [
            sorted(name for name, _ in asker.get_service_names_and_types_by_node(name, "/"))
            for name in ("machine", "silent")
        ]
