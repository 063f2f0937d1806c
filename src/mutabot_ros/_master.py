"""Starts a ROS 1 master for the nodes of one worker.

Workers that shared a master would meet in its names. One alone takes 0.1 s and 30 MB, so each worker has its
own: on a free port, of this machine only, with its logs in the worker's home. It ends with the
worker, also if that is killed.
"""

from __future__ import annotations

import importlib.util
import os
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

from mutabot.api.reports import MutabotError
from mutabot.api.values import Operation

from ._mentions import mentions

#: environment variables by which nodes find it
URI, ADDRESS, LOGS, HOME = "ROS_MASTER_URI", "ROS_IP", "ROS_LOG_DIR", "ROS_HOME"
#: how long it may take to come up, s; on a busy machine 0.1 s are more
_PATIENCE = 20.0
_PAUSE = 0.005
_TRIES = 5
_LOCAL = "127.0.0.1"
#: below those that Linux gives to connections
_PORTS = range(12000, 32000)
_PROGRAM = """
import ctypes, os, signal, sys
ctypes.CDLL(None).prctl(1, signal.SIGKILL, 0, 0, 0)  # end with the parent, which is there still
if os.getppid() == int(sys.argv[1]):
    import rosmaster
    rosmaster.rosmaster_main(["rosmaster", "--core", "-p", sys.argv[2]])
"""


class MasterError(MutabotError):
    """Raised if no master could be started."""


@dataclass(frozen=True, slots=True)
class Master:
    """A running master.

    Attributes:
        uri: where nodes find it.
        process: its process.
    """

    uri: str
    process: subprocess.Popen[bytes]

    def stop(self) -> None:
        """Stop the master."""
        self.process.kill()
        self.process.wait()


def is_wanted(root: str, operations: Sequence[Operation] | None) -> bool:
    """Return whether ROS 1 is installed and the program uses it, as far as its operations and files show."""
    if operations is not None and not any(map(_is_of_nodes, operations)):
        return False
    if not _is_installed("rospy") or not _is_installed("rosmaster"):
        return False
    is_other_there = operations is None or _is_installed("rclpy")
    return not is_other_there or mentions(root, "rospy")


def _is_of_nodes(operation: Operation) -> bool:
    module = operation.target.partition(":")[0].partition(".")[0]
    return operation.named is not None or module in ("rospy", "actionlib")


def _is_installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


def start(home: str) -> Master:
    """Start a master for this process and all that it starts. Raises MasterError."""
    folder = os.path.join(home, "ros")
    os.makedirs(os.path.join(folder, "log"), exist_ok=True)
    os.environ.update({ADDRESS: _LOCAL, LOGS: os.path.join(folder, "log"), HOME: folder})
    os.environ.pop("ROS_HOSTNAME", None)  # it would go before the address
    log = ""
    for number in range(_TRIES):
        port = _free_port(number)
        os.environ[URI] = f"http://{_LOCAL}:{port}"
        log = os.path.join(folder, "master.txt")
        master = Master(os.environ[URI], _process(port, log))
        if _comes_up(master.process, port):
            return master
        master.stop()
        with open(log, encoding="utf-8", errors="replace") as file:
            log = file.read()[-500:]
    raise MasterError(f"no rosmaster came up on {_LOCAL} in {_TRIES} tries; the last one said: {log.strip()}")


def _free_port(number: int) -> int:
    """Return a free port, a different one for each number.

    It is none of those that the system gives to who asks for any: until the master has it, a connection of
    another node could take it, even one that asks whether the master is there.
    """
    start = os.getpid() * _TRIES + number
    for port in (_PORTS[(start + step) % len(_PORTS)] for step in range(len(_PORTS))):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the master does
            if _can_have(probe, port):
                return port
    raise MasterError(f"no port from {_PORTS[0]} to {_PORTS[-1]} is free")


def _can_have(probe: socket.socket, port: int) -> bool:
    try:
        probe.bind((_LOCAL, port))
    except OSError:
        return False
    return True


def _process(port: int, log: str) -> subprocess.Popen[bytes]:
    with open(log, "wb") as file:
        return subprocess.Popen(
            [sys.executable, "-c", _PROGRAM, str(os.getpid()), str(port)],
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            process_group=0,
        )


def _comes_up(process: subprocess.Popen[bytes], port: int) -> bool:
    from ._master_check import pid_of_master  # noqa: PLC0415  # see there

    end = time.monotonic() + _PATIENCE
    while process.poll() is None and time.monotonic() < end:
        if pid_of_master(f"http://{_LOCAL}:{port}") == process.pid:
            return True
        time.sleep(_PAUSE)
    return False
