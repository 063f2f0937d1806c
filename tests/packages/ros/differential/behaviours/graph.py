"""A graph of nodes in one process, and short ways to let it run."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

#: seconds after which a behaviour gives up waiting for what must happen
PATIENCE = 10.0
#: seconds in which everything that is still under way has arrived
SETTLED = 0.3


class Graph:
    """Nodes of one context and their executor, spun by hand or by a thread."""

    def __init__(
        self,
        *names: str,
        args: list[str] | None = None,
        domain_id: int | None = None,
        make_executor: Callable[..., Executor] = SingleThreadedExecutor,
        in_thread: bool = False,
        **options: Any,
    ) -> None:
        self.context = Context()
        rclpy.init(args=args or [], context=self.context, domain_id=domain_id)
        self.executor = make_executor(context=self.context)
        self.nodes: list[Node] = []
        for name in names:
            self.node(name, **options)
        self._thread: threading.Thread | None = None
        if in_thread:
            self._thread = threading.Thread(target=self._spin, daemon=True)
            self._thread.start()

    def __enter__(self) -> Graph:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __iter__(self) -> Any:
        return iter(self.nodes)

    def node(self, name: str, make: Callable[..., Node] = Node, **options: Any) -> Any:
        """Make a node and let the executor spin it."""
        node = make(name, context=self.context, **options)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def until(self, is_so: Callable[[], Any], seconds: float = PATIENCE) -> bool:
        """Spin until something is so; false if it is not in so many seconds."""
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                return False
            self._step()
        return True

    def spin(self, seconds: float = SETTLED) -> None:
        """Spin for so many seconds."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._step()

    def result(self, future: Any, seconds: float = PATIENCE) -> Any:
        """Spin until a future is done and give its result."""
        if not self.until(future.done, seconds):
            raise TimeoutError("the future is not done")
        return future.result()

    def close(self) -> None:
        """End the executor, the nodes and the context."""
        self.executor.shutdown(timeout_sec=1.0)
        if self._thread is not None:
            self._thread.join(5.0)
        for node in self.nodes:
            node.destroy_node()
        self.context.try_shutdown()

    def _step(self) -> None:
        if self._thread is None:
            self.executor.spin_once(timeout_sec=0.01)
        else:
            time.sleep(0.005)

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            self.executor.spin()


def connect(graph: Graph, publisher: Any, subscriptions: int = 1) -> None:
    """Spin until a publisher has found so many subscriptions."""
    if not graph.until(lambda: publisher.get_subscription_count() == subscriptions):
        raise TimeoutError(f"{publisher.get_subscription_count()} subscriptions and not {subscriptions}")


def ready(graph: Graph, client: Any) -> None:
    """Spin until a client has found its server."""
    is_ready = client.server_is_ready if hasattr(client, "server_is_ready") else client.service_is_ready
    if not graph.until(is_ready):
        raise TimeoutError("nobody serves")


def raised(function: Callable[..., Any], *arguments: Any, **options: Any) -> str:
    """The name of the exception that a call raises, or ``""``."""
    try:
        function(*arguments, **options)
    except Exception as error:
        return type(error).__name__
    return ""
