"""Logs of nodes: on the standard error, and on `/rosout`."""

from __future__ import annotations

import os
from typing import Any

from ros_in_process.machine.scheduler import SCHEDULER, SECOND
from ros_in_process.middleware.arguments import SEVERITIES
from ros_in_process.middleware.graph import WORLD, Node, Participant
from ros_in_process.middleware.topics import Publisher

_NAMES = {number: name for name, number in SEVERITIES.items()}
_DEFAULT_LEVEL = 20
_REGISTERED = (
    "Publisher already registered for node name: '{node}'. If this is due to multiple nodes with the "
    "same name then all logs for the logger named '{name}' will go out over the existing publisher. "
    "As soon as any node with that name is destructed it will unregister the publisher, preventing "
    "any further logs for that name from being published on the rosout topic."
)
_levels: dict[str, int] = {}
_publishers: dict[str, Publisher] = {}
#: whether lines go to the standard error
has_console = [True]
_sublogger_users: dict[str, int] = {}


def log(severity: int, name: str, text: str, function: str = "", file: str = "", line: int = 0) -> None:
    """Write a line, and publish it if the logger belongs to a node."""
    now = SCHEDULER.system_time
    label = _NAMES.get(int(severity), "UNSET")
    row = f"[{label}] [{now // SECOND}.{now % SECOND:09d}] [{name}]: {text}\n"
    if has_console[0]:
        _write(row)
    publisher = _publishers.get(name)
    if publisher is not None and not publisher.is_destroyed:
        message = publisher.kind(
            level=int(severity), name=name, msg=text, file=file, function=function, line=line
        )
        message.stamp.sec, message.stamp.nanosec = divmod(now, SECOND)
        publisher.publish(message)


def _write(row: str) -> None:
    process = SCHEDULER.current.process
    if process is not None and "stderr" in process.streams:
        process.streams["stderr"].write(row)
    else:
        os.write(2, row.encode(errors="replace"))


def _start_rosout(node: Node) -> None:
    if not node.enable_rosout or not node.context.arguments.has_rosout:
        return
    from rcl_interfaces.msg import Log  # noqa: PLC0415  (only where there is ROS)

    name = node.logger_name()
    if name in _publishers and not _publishers[name].is_destroyed:
        log(30, "rcl.logging_rosout", _REGISTERED.format(node=node.name, name=name))
        return
    publisher = Publisher(node, Log, "/rosout", node.rosout_qos)
    publisher.is_internal = True
    _publishers[name] = publisher


def install() -> None:
    """Publish what nodes log."""
    WORLD.on_node.append(_start_rosout)


def rclpy_logging_rcutils_log(
    severity: Any, name: str, text: str, function: str, file: str, line: int
) -> None:
    """Log a line."""
    log(int(severity), name, text, function, file, line)


def rclpy_logging_set_logger_level(name: str, level: Any, detailed_error: bool = False) -> None:
    """Set the lowest severity that a logger prints."""
    if int(level) not in _NAMES:
        detail = f": Unable to set log level {int(level)}" if detailed_error else ""
        raise RuntimeError(f"Failed to set level for logger{f' {name!r}' if detailed_error else ''}{detail}")
    _levels[name] = int(level)


def rclpy_logging_get_logger_level(name: str) -> int:
    """Return the level of a logger itself; 0 if it has none."""
    return _levels.get(name, _DEFAULT_LEVEL if not name else 0)


def rclpy_logging_get_logger_effective_level(name: str) -> int:
    """Return the level of a logger, or of its nearest ancestor that has one."""
    while name:
        if _levels.get(name):
            return _levels[name]
        name = name.rpartition(".")[0]
    return _levels.get("", _DEFAULT_LEVEL)


def rclpy_logging_logger_is_enabled_for(name: str, severity: Any) -> bool:
    """Return whether a logger prints messages of this severity."""
    return int(severity) >= rclpy_logging_get_logger_effective_level(name)


def rclpy_logging_severity_level_from_string(text: str) -> int:
    """Return the number of a severity."""
    if text.upper() not in SEVERITIES:
        raise RuntimeError("Failed to get severity name")
    return SEVERITIES[text.upper()]


def rclpy_logging_rosout_add_sublogger(logger: str, sublogger: str) -> bool:
    """Publish what a child of a node's logger logs; return False if the logger is not a node's."""
    if logger not in _publishers:
        return False
    full = f"{logger}.{sublogger}"
    _publishers[full] = _publishers[logger]
    _sublogger_users[full] = _sublogger_users.get(full, 0) + 1
    return True


def rclpy_logging_rosout_remove_sublogger(logger: str, sublogger: str) -> None:
    """Stop publishing the messages of a child logger that is no longer in use."""
    full = f"{logger}.{sublogger}"
    _sublogger_users[full] = _sublogger_users.get(full, 1) - 1
    if _sublogger_users[full] <= 0:
        _publishers.pop(full, None)


def rclpy_logging_configure(context: Participant) -> None:
    """Set the log levels given on a command line."""
    _levels.update(context.arguments.levels)
    has_console[0] = context.arguments.has_console


def rclpy_logging_fini() -> None:
    """Forget the publishers on `/rosout`."""
    _publishers.clear()


def rclpy_logging_initialize() -> None:
    """Do nothing: there is no logging to set up."""


def rclpy_logging_shutdown() -> None:
    """Forget all levels."""
    _levels.clear()


def rclpy_logging_get_logging_directory() -> str:
    """Return where real ROS would write log files."""
    home = os.environ.get("ROS_HOME") or os.path.join(os.path.expanduser("~"), ".ros")
    return os.environ.get("ROS_LOG_DIR") or os.path.join(home, "log")


def rclpy_logging_get_separator_string() -> str:
    """Return the separator between a logger's name and its child's."""
    return "."
