"""Services and clients."""

from __future__ import annotations

import threading
import time
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import qos_profile_system_default
from rclpy.service_introspection import ServiceIntrospectionState
from service_msgs.msg import ServiceEventInfo
from std_srvs.srv import Empty, SetBool, Trigger
from test_msgs.srv import BasicTypes

from .declared import behaviour
from .graph import Graph, raised, ready

SERVICES = "docs.ros.org, Concepts, Services"


def echo(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    """Answer what was asked."""
    response.success = request.data
    return response


def increase(request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
    """Answer one more than was asked."""
    response.int32_value = request.int32_value + 1
    return response


def asking(number: int) -> BasicTypes.Request:
    """A request with a number."""
    return BasicTypes.Request(int32_value=number)


@behaviour(expected=[True, False], source=SERVICES + ": a client calls, the server answers")
def a_service_answers() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        return [graph.result(client.call_async(SetBool.Request(data=data))).success for data in (True, False)]


@behaviour(expected=[2, 11, 101], source=SERVICES + ": a response to each request")
def several_requests_are_under_way() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(BasicTypes, "increase", increase)
        client = asker.create_client(BasicTypes, "increase")
        ready(graph, client)
        futures = [client.call_async(asking(number)) for number in (1, 10, 100)]
        return [graph.result(future).int32_value for future in futures]


@behaviour(expected=[[2], [11]], source=SERVICES + ": the response goes to the client that asked")
def each_client_hears_its_own_answer() -> Any:
    with Graph("server", "one", "two") as graph:
        server, first_node, second_node = graph
        server.create_service(BasicTypes, "increase", increase)
        clients = [node.create_client(BasicTypes, "increase") for node in (first_node, second_node)]
        for client in clients:
            ready(graph, client)
        futures = [client.call_async(asking(number)) for client, number in zip(clients, (1, 10), strict=True)]
        graph.until(lambda: all(future.done() for future in futures))
        graph.spin(0.1)
        return [[future.result().int32_value] for future in futures]


@behaviour(expected=[1, 2, 3, 4, 5], source="docs.ros.org, About QoS: services are reliable")
def requests_are_answered_in_order() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        asked: list[int] = []

        def answer(request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
            asked.append(request.int32_value)
            return response

        server.create_service(BasicTypes, "increase", answer)
        client = asker.create_client(BasicTypes, "increase")
        ready(graph, client)
        futures = [client.call_async(asking(number)) for number in range(1, 6)]
        graph.until(lambda: all(future.done() for future in futures))
        return asked


@behaviour(
    expected=[False, False, True, True],
    source="rclpy.client.Client.wait_for_service: True if it became ready, False on a timeout",
)
def a_client_knows_whether_its_server_is_there() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        client = asker.create_client(SetBool, "flag")
        seen = [client.service_is_ready(), client.wait_for_service(timeout_sec=0.3)]
        service = server.create_service(SetBool, "flag", echo)
        seen.append(client.wait_for_service(timeout_sec=5.0))
        server.destroy_service(service)
        seen.append(graph.until(lambda: not client.service_is_ready()))
        return seen


@behaviour()
def a_client_looks_for_its_server_in_steps() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        client = asker.create_client(SetBool, "flag")
        steps = []
        for seconds in (0.1, 0.6):
            begin = time.monotonic()
            client.wait_for_service(timeout_sec=seconds)
            steps.append(int((time.monotonic() - begin) / 0.25))
        return steps


@behaviour()
def a_request_without_a_server_is_never_answered() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        client = asker.create_client(SetBool, "flag")
        future = client.call_async(SetBool.Request(data=True))
        graph.spin(0.2)
        server.create_service(SetBool, "flag", echo)
        ready(graph, client)
        graph.spin()
        return future.done(), graph.result(client.call_async(SetBool.Request(data=True))).success


@behaviour()
def an_exception_in_a_service_leaves_the_executor() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph

        def fail(request: Any, response: Any) -> Any:
            raise ValueError("no")

        server.create_service(SetBool, "flag", fail)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        future = client.call_async(SetBool.Request())
        error = raised(graph.spin, 2.0)
        graph.spin()
        return error, future.done()


@behaviour(
    expected=["TypeError", "TypeError"],
    source="rclpy.client.Client.call_async: raises TypeError if it is no Request;"
    " rclpy.service.Service.send_response: likewise",
)
def requests_and_responses_of_another_type() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", lambda request, response: Trigger.Response())
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        wrong = raised(client.call_async, Trigger.Request())
        client.call_async(SetBool.Request())
        return wrong, raised(graph.spin, 2.0)


@behaviour()
def a_service_that_answers_nothing() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", lambda request, response: None)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        client.call_async(SetBool.Request())
        return raised(graph.spin, 2.0)


@behaviour(expected=True, source="rclpy.client.Client.call: make a service request and wait for the result")
def a_synchronous_call() -> Any:
    with Graph("server", "asker", in_thread=True) as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        client.wait_for_service(5.0)
        return client.call(SetBool.Request(data=True), timeout_sec=5.0).success


@behaviour(
    expected="TimeoutError",
    source="rclpy.client.Client.call: raises TimeoutError if the response takes too long",
)
def a_synchronous_call_that_takes_too_long() -> Any:
    with Graph("asker", in_thread=True) as graph:
        (asker,) = graph
        client = asker.create_client(SetBool, "flag")
        return raised(client.call, SetBool.Request(), timeout_sec=0.3)


@behaviour()
def a_synchronous_call_in_a_callback_of_one_thread() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        told: list[str] = []

        def on_time() -> None:
            timer.cancel()
            told.append(raised(client.call, SetBool.Request(data=True), timeout_sec=0.5))

        timer = asker.create_timer(0.01, on_time)
        graph.until(lambda: told)
        return told


@behaviour(
    expected=[True],
    source="docs.ros.org, Using callback groups: a reentrant group, or two groups, let a callback call",
)
def a_synchronous_call_in_a_callback_of_two_groups() -> Any:
    with Graph("server", "asker", make_executor=_three_threads, in_thread=True) as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag", callback_group=MutuallyExclusiveCallbackGroup())
        client.wait_for_service(5.0)
        told: list[bool] = []

        def on_time() -> None:
            timer.cancel()
            told.append(client.call(SetBool.Request(data=True), timeout_sec=5.0).success)

        timer = asker.create_timer(0.01, on_time, callback_group=MutuallyExclusiveCallbackGroup())
        graph.until(lambda: told)
        return told


@behaviour(
    expected=["TimeoutError"],
    source="docs.ros.org, Using callback groups: a synchronous call in the group of its client deadlocks",
)
def a_synchronous_call_in_a_callback_of_one_group() -> Any:
    with Graph("server", "asker", make_executor=_three_threads, in_thread=True) as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        client.wait_for_service(5.0)
        told: list[str] = []

        def on_time() -> None:
            timer.cancel()
            told.append(raised(client.call, SetBool.Request(data=True), timeout_sec=0.5))

        timer = asker.create_timer(0.01, on_time)
        graph.until(lambda: told)
        return told


def _three_threads(**options: Any) -> MultiThreadedExecutor:
    return MultiThreadedExecutor(3, **options)


@behaviour(
    expected=[[True], []],
    source="docs.ros.org, Using callback groups: what is awaited is in another group",
)
def a_coroutine_awaits_an_answer() -> Any:
    found = []
    for group in (ReentrantCallbackGroup(), None):
        with Graph("server", "asker") as graph:
            server, asker = graph
            server.create_service(SetBool, "flag", echo)
            client = asker.create_client(SetBool, "flag", callback_group=group)
            ready(graph, client)
            found.append(_awaited(graph, asker, client))
    return found


def _awaited(graph: Graph, asker: Any, client: Any) -> list[bool]:
    told: list[bool] = []

    async def on_time() -> None:
        timer.cancel()
        answer = await client.call_async(SetBool.Request(data=True))
        told.append(answer.success)

    timer = asker.create_timer(0.01, on_time)
    graph.until(lambda: told, 1.0)
    return told


@behaviour(expected=3, source="rclpy examples: a service whose callback is a coroutine awaits another one")
def a_service_asks_another_service() -> Any:
    with Graph("back", "front", "asker") as graph:
        back, front, asker = graph
        back.create_service(BasicTypes, "inner", increase)
        inner = front.create_client(BasicTypes, "inner", callback_group=ReentrantCallbackGroup())

        async def answer(request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
            found = await inner.call_async(asking(request.int32_value))
            response.int32_value = found.int32_value + 1
            return response

        front.create_service(BasicTypes, "outer", answer)
        outer = asker.create_client(BasicTypes, "outer")
        ready(graph, inner)
        ready(graph, outer)
        return graph.result(outer.call_async(asking(1))).int32_value


@behaviour()
def two_servers_of_one_name() -> Any:
    with Graph("one", "two", "asker") as graph:
        first_node, second_node, asker = graph
        asked: list[str] = []

        def answering(name: str) -> Any:
            def answer(request: Any, response: Any) -> Any:
                asked.append(name)
                return response

            return answer

        first_node.create_service(Empty, "empty", answering("one"))
        second_node.create_service(Empty, "empty", answering("two"))
        client = asker.create_client(Empty, "empty")
        ready(graph, client)
        graph.until(lambda: asker.count_services("empty") == 2)
        graph.spin()
        answer = graph.result(client.call_async(Empty.Request()))
        graph.spin()
        return type(answer).__name__, sorted(asked), client.service_is_ready()


@behaviour()
def a_pending_request_can_be_removed() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        future = client.call_async(SetBool.Request(data=True))
        client.remove_pending_request(future)
        graph.spin()
        return future.done(), future.cancelled()


@behaviour()
def a_cancelled_request_is_not_answered() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        asked: list[bool] = []

        def answer(request: Any, response: Any) -> Any:
            asked.append(request.data)
            return response

        server.create_service(SetBool, "flag", answer)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        future = client.call_async(SetBool.Request(data=True))
        future.cancel()
        graph.spin()
        return future.done(), future.cancelled(), future.result(), asked


@behaviour()
def a_server_that_ends_leaves_its_client_waiting() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        service = server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        ready(graph, client)
        server.destroy_service(service)
        future = client.call_async(SetBool.Request())
        graph.spin()
        return future.done(), raised(service.send_response, SetBool.Response(), None)


@behaviour()
def a_destroyed_client_cannot_call() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        client = asker.create_client(SetBool, "flag")
        asker.destroy_client(client)
        return raised(client.call_async, SetBool.Request()), raised(client.service_is_ready)


@behaviour()
def a_slow_service_and_an_impatient_client() -> Any:
    with Graph("server", "asker", make_executor=_three_threads, in_thread=True) as graph:
        server, asker = graph
        answered = threading.Event()

        def answer(request: Any, response: Any) -> Any:
            time.sleep(0.6)
            answered.set()
            return response

        server.create_service(SetBool, "flag", answer)
        client = asker.create_client(SetBool, "flag")
        client.wait_for_service(5.0)
        error = raised(client.call, SetBool.Request(), timeout_sec=0.2)
        was = answered.is_set()
        return error, was, answered.wait(5.0)


@behaviour(
    expected=["REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED"],
    source="docs.ros.org, Configure service introspection; service_msgs/ServiceEventInfo",
)
def a_service_is_introspected() -> Any:
    kinds = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")
    with Graph("server", "asker", "watcher") as graph:
        server, asker, watcher = graph
        service = server.create_service(SetBool, "flag", echo)
        client = asker.create_client(SetBool, "flag")
        for node, entity in ((server, service), (asker, client)):
            entity.configure_introspection(
                node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.CONTENTS
            )
        told: list[int] = []
        watcher.create_subscription(
            SetBool.Event, "flag/_service_event", lambda event: told.append(event.info.event_type), 10
        )
        graph.until(lambda: watcher.count_publishers("flag/_service_event") == 2)
        ready(graph, client)
        graph.spin()
        graph.result(client.call_async(SetBool.Request(data=True)))
        graph.until(lambda: len(told) == 4)
        names = {getattr(ServiceEventInfo, kind): kind for kind in kinds}
        return [names[kind] for kind in sorted(told)]


@behaviour()
def services_are_counted() -> Any:
    with Graph("server", "asker") as graph:
        server, asker = graph
        server.create_service(SetBool, "flag", echo)
        asker.create_client(SetBool, "flag")
        graph.until(lambda: asker.count_services("flag") and server.count_clients("flag"))
        return asker.count_services("flag"), asker.count_clients("/flag"), asker.count_services("other")
