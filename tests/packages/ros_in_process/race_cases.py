"""A test that passes only if a subscription is found before a message: a race that the first order hides."""

from __future__ import annotations

import threading
import time

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String


def test_the_greeting_is_heard() -> None:
    contexts = [Context(), Context()]
    for context in contexts:
        rclpy.init(context=context)
    speaker, listener = (rclpy.create_node("node", context=context) for context in contexts)
    heard: list[str] = []
    listener.create_subscription(String, "greeting", lambda message: heard.append(message.data), 10)
    executor = SingleThreadedExecutor(context=contexts[1])
    executor.add_node(listener)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    publisher = speaker.create_publisher(String, "greeting", 10)
    time.sleep(0.1)  # "by now it must have found us"
    publisher.publish(String(data="hello"))
    time.sleep(1.0)
    executor.shutdown()
    for context in contexts:
        rclpy.shutdown(context=context)
    assert heard == ["hello"]
