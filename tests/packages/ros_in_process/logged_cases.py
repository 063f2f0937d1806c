"""A graph with threads, a process and an action that prints each event: two runs print the same."""

from __future__ import annotations

import sys
import threading
import time
from typing import Any

import rclpy
from process_cases import start
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci


def say(*words: object) -> None:
    print(f"{time.monotonic():.6f}", threading.current_thread().name, *words, file=sys.stdout, flush=True)


def test_all_that_happens_is_printed() -> None:
    process = start()
    with rclpy.init():
        nodes = [rclpy.create_node(f"node{number}") for number in range(5)]
        executor = MultiThreadedExecutor(4)
        group = ReentrantCallbackGroup()
        for node in nodes:
            executor.add_node(node)
            name = node.get_name()
            chat = node.create_publisher(String, "chat", 10)
            node.create_subscription(String, "chat", lambda message, name=name: say(name, message.data), 10)
            node.create_subscription(Int32, "numbers", lambda message, name=name: say(name, message.data), 10)
            node.create_timer(0.07, lambda chat=chat, name=name: chat.publish(String(data=f"from {name}")))
        nodes[0].create_service(Trigger, "call", lambda request, response: response, callback_group=group)
        client = nodes[1].create_client(Trigger, "call", callback_group=group)
        nodes[1].create_timer(
            0.05, lambda: say("called", client.call(Trigger.Request()).success), callback_group=group
        )

        def execute(goal: Any) -> Fibonacci.Result:
            for _ in range(5):
                time.sleep(0.03)
                goal.publish_feedback(Fibonacci.Feedback())
            goal.succeed()
            return Fibonacci.Result()

        ActionServer(nodes[2], Fibonacci, "count", execute, callback_group=group)
        action = ActionClient(nodes[3], Fibonacci, "count", callback_group=group)
        action.wait_for_server()
        action.send_goal_async(
            Fibonacci.Goal(), feedback_callback=lambda feedback: say(feedback.goal_id.uuid)
        )
        thread = threading.Thread(target=executor.spin)
        thread.start()
        time.sleep(2.0)
        process.terminate()
        say("ended", process.wait())
        executor.shutdown()
        thread.join()
