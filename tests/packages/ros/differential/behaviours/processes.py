"""Nodes in processes of their own, which begin, end and are ended."""

from __future__ import annotations

import multiprocessing
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from std_msgs.msg import Int32
from test_msgs.srv import BasicTypes

from .declared import behaviour
from .graph import Graph, ready

PROGRAMS = Path(__file__).with_name("programs")
#: how the adder ends when a signal tells it to: which of these depends on where the signal meets it
ENDED = (0, 11, 12)


def start(program: str, *arguments: str, **options: Any) -> subprocess.Popen[str]:
    """Start a node as a process."""
    return subprocess.Popen([sys.executable, str(PROGRAMS / program), *arguments], text=True, **options)


def end(process: subprocess.Popen[str], number: signal.Signals) -> int:
    """Send a signal until the process has ended: a node that is about to wait may miss it.

    Gives how many signals that took.
    """
    sent = 0
    while process.poll() is None:
        process.send_signal(number)
        sent += 1
        try:
            process.wait(1.0)
        except subprocess.TimeoutExpired:
            continue
    return sent


def ended_as_expected(process: subprocess.Popen[str], number: signal.Signals) -> bool:
    """Whether the adder ended by its own return after a signal.

    On a slow machine a second signal meets a node that has shut down and given its handlers back: then the
    signal itself ends the process.
    """
    sent = end(process, number)
    return process.returncode in ENDED or (sent > 1 and process.returncode == -number)


@contextmanager
def adder(*arguments: str, name: str = "add") -> Iterator[tuple[Graph, Any, subprocess.Popen[str]]]:
    """A process that adds, and a client that has found it."""
    process = start("adder.py", *arguments, stderr=subprocess.PIPE)
    try:
        with Graph("asker") as graph:
            (asker,) = graph
            client = asker.create_client(BasicTypes, name)
            ready(graph, client)
            yield graph, client, process
    finally:
        process.kill()
        process.communicate()


def ask(graph: Graph, client: Any, number: int) -> list[int]:
    """What the adder answers."""
    answer = graph.result(client.call_async(BasicTypes.Request(int32_value=number)))
    return [answer.int32_value, answer.int64_value]


@behaviour()
def a_process_publishes() -> Any:
    with Graph("listener") as graph:
        (listener,) = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        process = start("talker.py", "4", stdout=subprocess.PIPE)
        graph.until(lambda: len(heard) == 4)
        said, _ = process.communicate(timeout=10)
        return heard, process.returncode, said


@behaviour()
def a_process_has_its_own_arguments() -> Any:
    arguments = ("--ros-args", "-p", "offset:=5", "-r", "__ns:=/arm", "-r", "add:=sum")
    with adder(*arguments, name="/arm/sum") as (graph, client, _):
        (asker,) = graph
        answer = ask(graph, client, 2)
        # a service is found through its endpoints, a node by what its participant tells later
        graph.until(lambda: "/arm/adder" in asker.get_fully_qualified_node_names())
        return answer, sorted(asker.get_fully_qualified_node_names())


@behaviour()
def a_process_keeps_what_it_knows() -> Any:
    with adder() as (graph, client, _):
        return [ask(graph, client, number) for number in (1, 2, 3)]


@behaviour()
def a_process_is_interrupted() -> Any:
    with adder() as (graph, client, process):
        ask(graph, client, 1)
        return ended_as_expected(process, signal.SIGINT)


@behaviour()
def a_process_is_terminated() -> Any:
    with adder() as (graph, client, process):
        ask(graph, client, 1)
        return ended_as_expected(process, signal.SIGTERM)


@behaviour()
def a_process_is_killed_and_started_again() -> Any:
    with adder() as (graph, client, process):
        before = ask(graph, client, 1), ask(graph, client, 1)
        end(process, signal.SIGKILL)
        unanswered = client.call_async(BasicTypes.Request(int32_value=1))
        graph.spin()
        again = start("adder.py")
        try:
            asker = graph.node("asker_of_the_new_one")
            other = asker.create_client(BasicTypes, "add")
            found = graph.until(
                lambda: asker.get_node_names().count("adder") >= 1 and other.service_is_ready()
            )
            time.sleep(1.0)
            answers = []
            graph.until(lambda: _answered(graph, other, answers))
            return before, process.returncode, unanswered.done(), found, answers[0][0]
        finally:
            again.kill()
            again.wait()


def _answered(graph: Graph, client: Any, answers: list[list[int]]) -> bool:
    """Ask again if a request went to the process that is gone."""
    future = client.call_async(BasicTypes.Request(int32_value=1))
    if graph.until(future.done, 1.0):
        answers.append([future.result().int32_value])
    return bool(answers)


@behaviour()
def a_process_fails() -> Any:
    with adder() as (graph, client, process):
        future = client.call_async(BasicTypes.Request(int32_value=-1))
        _, errors = process.communicate(timeout=10)
        graph.spin()
        return process.returncode, "ValueError: no" in errors, future.done()


@behaviour()
def a_process_ends_and_leaves_the_graph() -> Any:
    with adder() as (graph, client, process):
        (asker,) = graph
        there = graph.until(lambda: "adder" in asker.get_node_names())
        end(process, signal.SIGINT)
        gone = graph.until(lambda: "adder" not in asker.get_node_names())
        return there, gone, graph.until(lambda: not client.service_is_ready())


def _say(number: int) -> None:
    with rclpy.init(args=[]):
        node = rclpy.create_node("sayer")
        publisher = node.create_publisher(Int32, "numbers", 10)
        end_of_waiting = time.monotonic() + 10
        while not publisher.get_subscription_count() and time.monotonic() < end_of_waiting:
            time.sleep(0.01)
        publisher.publish(Int32(data=number))
        publisher.wait_for_all_acked()


@behaviour()
def a_node_in_a_process_of_multiprocessing() -> Any:
    with Graph("listener") as graph:
        (listener,) = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        process = multiprocessing.get_context("spawn").Process(target=_say, args=(7,))
        process.start()
        graph.until(lambda: heard)
        process.join(10)
        return heard, process.exitcode
