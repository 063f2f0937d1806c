"""Makes rclpy's executors do less work around each wait.

For each callback an executor gathers all that its nodes have, keeps it in use, fills a wait set and asks it
about each member. Over a real middleware that is little beside the wait itself; here it was half of what a
test cost. `wait_for_ready_callbacks` does the same in the same order as the generator of rclpy whose text is
known; where rclpy has another text, its own stays in place.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware.graph import Destroyable, Node
from ros_in_process.middleware.records import InvalidHandle
from ros_in_process.middleware.waiting import WaitSet

#: the digest of rclpy's text that this stands for, of rclpy 9.1.2
KNOWN = "752e9ecbb147dcfa2db666b8312a72cc026c82c4245a35283ca0b7ba230c1a98"
_MODULE = "rclpy.executors"


def speed_up_executors(_: Node) -> None:
    """Make all executors wait faster, if their source is known. Called for each new node."""
    executor = getattr(sys.modules.get(_MODULE), "Executor", None)
    if executor is None or hasattr(executor, "_simulation_seen"):
        return
    executor._simulation_seen = True
    text = inspect.getsource(executor._wait_for_ready_callbacks)
    if hashlib.sha256(text.encode()).hexdigest() == KNOWN:
        executor._wait_for_ready_callbacks = wait_for_ready_callbacks


def wait_for_ready_callbacks(
    self: Any,
    timeout_sec: Any = None,
    nodes: list[Any] | None = None,
    condition: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[Any, Any, Any]]:
    """Yield a task for each ready callback, with its entity and node.

    Raises what rclpy raises where time is up, the executor or its context is shut down, or the condition
    holds.
    """
    rclpy: Any = sys.modules[_MODULE]
    seconds = timeout_sec.timeout if isinstance(timeout_sec, rclpy.TimeoutObject) else timeout_sec
    timeout = rclpy.timeout_sec_to_nsec(seconds)
    end = SCHEDULER.now + timeout if timeout >= 0 else None
    has_yielded = False
    while not has_yielded and not self._is_shutdown and not condition():
        of_nodes = self.get_nodes() if nodes is None else nodes
        for task in _begun_tasks(self, of_nodes) if self._tasks else ():
            has_yielded = True
            yield task
        with ExitStack() as in_use:
            gathered = _GatheredEntities.by(self, of_nodes)
            wait_set = gathered.put_in_use(self._context, in_use)
            knows_all = gathered.is_plain and not has_yielded and not self._tasks
            wait_set.wait_until(end, polls=timeout == 0, known=self._guard.handle if knows_all else None)
            if self._is_shutdown:
                raise rclpy.ShutdownException
            if not self._context.ok():
                raise rclpy.ExternalShutdownException
            ready = wait_set.ready_numbers()
            for guard in gathered.guards:
                if guard.handle.number in ready:
                    guard._executor_triggered = True
            for waitable, node in gathered.ready_waitables(of_nodes, wait_set):
                has_yielded = True
                yield self._make_handler(waitable, node, self._take_waitable), waitable, node
        for node in of_nodes:
            for entity, take in _ready(self, node, ready):
                has_yielded = True
                yield self._make_handler(entity, node, take), entity, node
        if timeout == 0 or wait_set.is_over:
            raise rclpy.TimeoutException
    if self._is_shutdown:
        raise rclpy.ShutdownException
    if condition():
        raise rclpy.ConditionReachedException


def _begun_tasks(executor: Any, nodes: list[Any]) -> Iterator[tuple[Any, Any, Any]]:
    """Yield tasks that have begun and can continue; forget those that are done."""
    for task, entity, node in list(executor._tasks):
        if not task.executing() and not task.done() and (node is None or node in nodes):
            yield task, entity, node
    executor._tasks = [
        executor_task
        for executor_task in executor._tasks
        if not executor_task[0].done() and not executor_task[0].cancelled()
    ]


def _ready(executor: Any, node: Any, numbers: set[int]) -> Iterator[tuple[Any, Any]]:
    """Yield a node's ready entities, by the numbers of ready handles, and the functions to take from them."""
    if numbers:
        for timer in node.timers:
            # one that was cancelled meanwhile is not
            if timer.handle.number in numbers and timer.handle.is_timer_ready() and _may_begin(timer):
                yield timer, executor._take_timer
        for subscription in node.subscriptions:
            if subscription.handle.number in numbers and _may_begin(subscription):
                yield subscription, executor._take_subscription
    for guard in node.guards:
        if guard._executor_triggered and _may_begin(guard):
            yield guard, executor._take_guard_condition
    if numbers:
        for client in node.clients:
            if client.handle.number in numbers and _may_begin(client):
                yield client, executor._take_client
        for service in node.services:
            if service.handle.number in numbers and _may_begin(service):
                yield service, executor._take_service


def _may_begin(entity: Any) -> bool:
    return entity.callback_group is not None and entity.callback_group.can_execute(entity)


class _GatheredEntities:
    """The entities of an executor's nodes that may be executed now.

    Attributes:
        guards, waitables: of these, rclpy's own objects.
        is_plain: whether the executor has one thread, and waitables of rclpy alone. Its own guard condition,
            which it triggers after each callback, then means nothing new. Waitables of others may count
            on being looked at once more.
    """

    def __init__(self, executor: Any, nodes: list[Any], entities: list[Any]) -> None:
        rclpy: Any = sys.modules[_MODULE]
        is_ours = type(executor).can_execute is rclpy.Executor.can_execute
        may = _may_be_executed if is_ours else executor.can_execute
        subscriptions = [
            subscription.handle for node in nodes for subscription in node.subscriptions if may(subscription)
        ]
        timers = [timer.handle for node in nodes for timer in node.timers if may(timer)]
        clients = [client.handle for node in nodes for client in node.clients if may(client)]
        services = [service.handle for node in nodes for service in node.services if may(service)]
        self._of_nodes = [guard for node in nodes for guard in node.guards if may(guard)]
        self.waitables = [candidate for node in nodes for candidate in node.waitables if may(candidate)]
        self.guards = [*self._of_nodes, *(guard for guard in (executor._guard, executor._sigint_gc) if guard)]
        self._events: list[Any] = []
        self._others: list[Any] = []
        handler = sys.modules["rclpy.event_handler"].EventHandler
        for waitable in self.waitables:
            is_event = type(waitable) is handler and not waitable._EventHandler__event.is_destroyed
            (self._events if is_event else self._others).append(waitable)
        self.is_plain = type(executor) is rclpy.SingleThreadedExecutor and all(
            type(other).__module__.startswith("rclpy.") for other in self._others
        )
        guards = [guard.handle for guard in self.guards]
        self._members = [
            [handle for handle in handles if not handle.is_destroyed]
            for handles in (subscriptions, guards, timers, clients, services)
        ]
        self._members.append([event._EventHandler__event for event in self._events])
        self._handles = [handle for of_kind in self._members for handle in of_kind]
        # what it stands for, if that is everything and in groups whose rule is known
        self._nodes, self._entities, self._destroyed = nodes, entities, Destroyable.destroyed
        self._groups = [entity.callback_group for entity in entities]
        self._own_guards = (executor._guard, executor._sigint_gc)
        is_whole = len(self._handles) + len(self._others) == len(entities) + len(self.guards) - len(
            self._of_nodes
        )
        groups: Any = sys.modules["rclpy.callback_groups"]
        known = (groups.MutuallyExclusiveCallbackGroup, groups.ReentrantCallbackGroup)
        self._may_be_kept = is_ours and is_whole and all(type(group) in known for group in self._groups)

    @classmethod
    def by(cls, executor: Any, nodes: list[Any]) -> _GatheredEntities:
        """Gather the entities, or return the last result if nothing has changed."""
        entities: list[Any] = []
        for node in nodes:
            entities += node.subscriptions
            entities += node.timers
            entities += node.clients
            entities += node.services
            entities += node.guards
            entities += node.waitables
        found: _GatheredEntities | None = executor.__dict__.get("_simulation_gathered")
        if found is None or not found._still_holds(executor, nodes, entities):
            found = executor._simulation_gathered = cls(executor, nodes, entities)
        for guard in found._of_nodes:
            if guard._executor_triggered:  # it was triggered before, and is not handled yet
                guard.trigger()
        return found

    def _still_holds(self, executor: Any, nodes: list[Any], entities: list[Any]) -> bool:
        """Return whether gathering now would give the same result."""
        return (
            self._may_be_kept
            and self._destroyed == Destroyable.destroyed
            and self._nodes == nodes
            and self._entities == entities
            and self._own_guards == (executor._guard, executor._sigint_gc)
            and all(
                not entity._executor_event
                and entity.callback_group is group
                and getattr(group, "_active_entity", None) is None
                for entity, group in zip(entities, self._groups, strict=True)
            )
        )

    def put_in_use(self, context: Any, in_use: ExitStack) -> WaitSet:
        """Return a wait set of all entities, none of which is destroyed before the end of ``in_use``."""
        if context.handle is None:
            raise RuntimeError("Cannot enter context if context is None")
        for index, event in enumerate(self._events):
            event._event_index = index
        for handle in self._handles:
            handle.uses += 1
        in_use.callback(_let_go, self._handles)
        in_use.enter_context(context.handle)
        wait_set = WaitSet.of(self._members, context.handle)
        if self._others:
            self._add_others(wait_set, in_use)
        return wait_set

    def _add_others(self, wait_set: WaitSet, in_use: ExitStack) -> None:
        """Let waitables that are not event handlers add themselves."""
        for other in self._others:
            try:
                in_use.enter_context(other)
                wait_set.make_room(other.get_num_entities())
            except InvalidHandle:
                pass
        for other in self._others:
            other.add_to_wait_set(wait_set)

    def ready_waitables(self, nodes: list[Any], wait_set: WaitSet) -> Iterator[tuple[Any, Any]]:
        """Yield the waitables that are ready after the wait, and their nodes."""
        may_have = self._others or wait_set.has_ready("event")
        if not may_have and not any(event._ready_to_take_data for event in self._events):
            return
        for node in nodes:
            for waitable in node.waitables:
                if (
                    waitable in self.waitables
                    and waitable.is_ready(wait_set)
                    and waitable.callback_group.can_execute(waitable)
                ):
                    yield waitable, node


def _may_be_executed(entity: Any) -> bool:
    """Return whether an entity can be executed, as `Executor.can_execute` does, but without a lock."""
    if entity._executor_event:
        return False
    group: Any = entity.callback_group
    if type(group) is sys.modules["rclpy.callback_groups"].MutuallyExclusiveCallbackGroup:
        return bool(group._active_entity is None)
    return group is not None and bool(group.can_execute(entity))


def _let_go(handles: list[Destroyable]) -> None:
    for handle in handles:
        if handle.is_destroyed:
            handle.__exit__()
        else:
            handle.uses -= 1
