"""Loggers, their levels, and the topic that tells what is logged."""

from __future__ import annotations

import time
from typing import Any

import rclpy.logging
from rcl_interfaces.msg import Log, LoggerLevel
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.logging import LoggingSeverity, get_logger

from .declared import behaviour
from .graph import Graph, raised, ready

LOGGING = "docs.ros.org, Concepts, About logging and logger configuration"


@behaviour(
    expected=["INFO", [False, True, True], "DEBUG", [True, True, True]],
    source=LOGGING + ": the default level is INFO; messages below the level are not logged",
)
def levels_of_a_logger() -> Any:
    logger = get_logger("arm")

    def says() -> list[bool]:
        return [logger.debug("debug"), logger.info("info"), logger.error("error")]

    seen: list[Any] = [logger.get_effective_level().name, says()]
    logger.set_level(LoggingSeverity.DEBUG)
    return [*seen, logger.get_effective_level().name, says()]


@behaviour(
    expected=["ERROR", "ERROR", "FATAL", "INFO", "UNSET"],
    source=LOGGING + ": a logger without a level has that of its parent",
)
def loggers_inherit_levels() -> Any:
    get_logger("arm").set_level(LoggingSeverity.ERROR)
    child = get_logger("arm").get_child("gripper")
    names = [get_logger("arm").get_effective_level().name, child.get_effective_level().name]
    child.set_level(LoggingSeverity.FATAL)
    names.append(get_logger("arm.gripper").get_effective_level().name)
    names.append(get_logger("other").get_effective_level().name)
    return [*names, rclpy.logging.get_logger_level("other").name]


@behaviour(
    expected=["ns.node", "ns.node.child", "node"],
    source=LOGGING + ": a node's logger has its name, with its namespace",
)
def names_of_loggers() -> Any:
    with Graph() as graph:
        node = graph.node("node", namespace="/ns")
        return [
            node.get_logger().name,
            node.get_logger().get_child("child").name,
            graph.node("node").get_logger().name,
        ]


@behaviour(
    expected=[[True, False, False], [False, True, True], [True, False, True]],
    source="rclpy.impl.rcutils_logger.RcutilsLogger.log: once, skip_first, throttle_duration_sec",
)
def messages_are_filtered() -> Any:
    logger = get_logger("arm")

    def throttled(pauses: tuple[float, ...]) -> list[bool]:
        found = []
        for pause in pauses:
            time.sleep(pause)
            found.append(logger.info("message", throttle_duration_sec=1.0))
        return found

    return [
        [logger.info("message", once=True) for _ in range(3)],
        [logger.info("message", skip_first=True) for _ in range(3)],
        throttled((0.0, 0.1, 1.2)),
    ]


@behaviour(
    expected=["ValueError", "TypeError"],
    source="rclpy.impl.rcutils_logger.RcutilsLogger.log: its severity cannot be changed",
)
def a_call_keeps_its_severity() -> Any:
    logger = get_logger("arm")

    def log(severity: LoggingSeverity) -> None:
        logger.log("message", severity)

    def both() -> None:
        for severity in (LoggingSeverity.INFO, LoggingSeverity.WARN):
            log(severity)

    return raised(both), raised(logger.info, "message", unknown=1)


@behaviour(
    expected=[[20, "node", "one"], [30, "node.child", "two"], [40, "node", "three"]],
    source=LOGGING + ": /rosout; rcl_interfaces/Log",
)
def messages_are_published() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        told: list[Any] = []
        watcher.create_subscription(
            Log, "/rosout", lambda log: told.append((log.level, log.name, log.msg)), 10
        )
        graph.until(lambda: watcher.count_publishers("/rosout") == 2)
        graph.spin()
        node.get_logger().info("one")
        node.get_logger().get_child("child").warn("two")
        node.get_logger().debug("not said")
        node.get_logger().error("three")
        graph.until(lambda: len(told) == 3)
        return told


@behaviour()
def where_a_message_was_logged() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        told: list[Any] = []
        watcher.create_subscription(Log, "/rosout", told.append, 10)
        graph.until(lambda: watcher.count_publishers("/rosout") == 2)
        graph.spin()
        node.get_logger().info("one")
        graph.until(lambda: told)
        (log,) = told
        return log.function, log.file.rpartition("/")[2], log.line > 0, log.stamp.sec > 0


@behaviour()
def a_node_without_rosout() -> Any:
    with Graph("watcher") as graph:
        (watcher,) = graph
        quiet = graph.node("quiet", enable_rosout=False)
        told: list[str] = []
        watcher.create_subscription(Log, "/rosout", lambda log: told.append(log.msg), 10)
        graph.spin()
        logged = quiet.get_logger().info("one")
        graph.spin()
        return logged, told, watcher.count_publishers("/rosout")


@behaviour()
def what_was_logged_before_is_kept() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        node.get_logger().info("early")
        told: list[str] = []
        watcher.create_subscription(Log, "/rosout", lambda log: told.append(log.msg), 10)
        graph.spin(0.5)
        late: list[str] = []
        latched = rclpy.qos.qos_profile_rosout_default
        watcher.create_subscription(Log, "/rosout", lambda log: late.append(log.msg), latched)
        graph.spin(0.5)
        return told, late


@behaviour(
    expected=["DEBUG", "WARN"],
    source="docs.ros.org, Passing ROS arguments: --log-level, for all or for one logger",
)
def levels_from_arguments() -> Any:
    args = ["--ros-args", "--log-level", "warn", "--log-level", "arm:=debug"]
    with Graph("node", args=args):
        return [get_logger(name).get_effective_level().name for name in ("arm", "other")]


@behaviour()
def levels_by_services() -> Any:
    with Graph("asker") as graph:
        (asker,) = graph
        node = graph.node("node", enable_logger_service=True)
        getter = asker.create_client(GetLoggerLevels, "node/get_logger_levels")
        setter = asker.create_client(SetLoggerLevels, "node/set_logger_levels")
        ready(graph, getter)
        ready(graph, setter)

        def level() -> int:
            answer = graph.result(getter.call_async(GetLoggerLevels.Request(names=["node"])))
            return int(answer.levels[0].level)

        before = level()
        levels = [LoggerLevel(name="node", level=10), LoggerLevel(name="node", level=77)]
        results = graph.result(setter.call_async(SetLoggerLevels.Request(levels=levels))).results
        return (
            before,
            [result.successful for result in results],
            level(),
            node.get_logger().get_effective_level().name,
        )


@behaviour()
def names_of_severities() -> Any:
    names = ("UNSET", "DEBUG", "INFO", "WARN", "ERROR", "FATAL")
    return [
        {name: LoggingSeverity[name].value for name in names},
        rclpy.logging.get_logging_severity_from_string("WARN"),
        raised(rclpy.logging.get_logging_severity_from_string, "loud"),
        raised(get_logger, ""),
        raised(get_logger("arm").set_level, 77),
    ]
