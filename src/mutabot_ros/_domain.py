"""Assigns each worker's nodes a ROS 2 domain of their own, so that workers do not interfere.

It is on this machine alone, with logs in the worker's home. Fast DDS speaks over the loopback device and
leaves nothing in shared memory. Its nodes say ten times a second that they are there: nodes of tests come and
go, and would else wait for the next of its rounds, up to 3 s.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator, Sequence
from contextlib import suppress

from mutabot.api.values import Operation

DOMAIN, RANGE, LOGS = "ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOG_DIR"
PROFILES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
#: says which middleware is below; Fast DDS is if nothing does
BELOW, FAST = "RMW_IMPLEMENTATION", "rmw_fastrtps_cpp"
#: domains whose ports are free on any system
DOMAINS = range(1, 102)
_PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com"><profiles>
<transport_descriptors><transport_descriptor>
<transport_id>loopback</transport_id><type>UDPv4</type><maxInitialPeersRange>32</maxInitialPeersRange>
<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
</transport_descriptor></transport_descriptors>
<participant profile_name="mutabot" is_default_profile="true"><rtps>
<userTransports><transport_id>loopback</transport_id></userTransports>
<useBuiltinTransports>false</useBuiltinTransports>
<builtin><discovery_config>
<leaseDuration><sec>20</sec></leaseDuration>
<leaseAnnouncement><sec>0</sec><nanosec>100000000</nanosec></leaseAnnouncement>
<initialAnnouncements><count>10</count><period><sec>0</sec><nanosec>20000000</nanosec></period>
</initialAnnouncements></discovery_config>
<initialPeersList><locator><udpv4><address>127.0.0.1</address></udpv4></locator></initialPeersList>
</builtin></rtps></participant>
</profiles></dds>
"""
#: holds the domain of this process as long as it lives; nothing of it is on disk
_held: list[socket.socket] = []


def is_wanted(operations: Sequence[Operation]) -> bool:
    """Return whether operations are those of nodes, which may be ROS 2 nodes."""
    return any(map(_is_of_nodes, operations))


def take(home: str) -> None:
    """Assign a domain to this process and all processes that it starts."""
    domain = _claim(os.environ.get(DOMAIN))
    if domain is not None:
        os.environ[DOMAIN] = str(domain)
    os.environ[LOGS] = os.path.join(home, "ros")
    if any(name in os.environ for name in PROFILES) or os.environ.get(BELOW, FAST) != FAST:
        os.environ[RANGE] = "LOCALHOST"
        return
    # a range of ROS' own would put shared memory in the place of what the profile says
    os.environ[RANGE] = "SYSTEM_DEFAULT"
    os.environ.pop("ROS_LOCALHOST_ONLY", None)
    file = os.path.join(home, "discovery.xml")
    with open(file, "w", encoding="utf-8") as stream:
        stream.write(_PROFILE)
    os.environ.update(dict.fromkeys(PROFILES, file))


def _is_of_nodes(operation: Operation) -> bool:
    return operation.named is not None or operation.target.startswith(("rclpy:", "rclpy."))


def _claim(theirs: str | None) -> int | None:
    """Return a domain that no other worker or running node uses; None if none is left."""
    while _held:  # of a process that this one was forked from
        _held.pop().close()
    taken = {theirs, *_running()}
    for domain in DOMAINS:
        if str(domain) in taken:
            continue
        held = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            held.bind(f"\0mutabot-ros-domain-{domain}")
        except OSError:
            held.close()
            continue
        _held.append(held)
        return domain
    return None


def _running() -> Iterator[str]:
    """Yield the domains with which running processes were started.

    A campaign that was killed may leave nodes in a domain that is no longer held.
    """
    mark = f"{DOMAIN}=".encode()
    for name in os.listdir("/proc") if os.path.isdir("/proc") else ():
        if name.isdigit():
            with suppress(OSError), open(f"/proc/{name}/environ", "rb") as stream:
                for variable in stream.read().split(b"\0"):
                    if variable.startswith(mark):
                        yield variable.removeprefix(mark).decode(errors="replace")
