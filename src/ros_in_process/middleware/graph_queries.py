"""Graph queries of nodes: names and types of topics and services, and their endpoints."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ros_in_process.middleware.graph import WORLD, Endpoint, NamesAndTypes, Node, grouped
from ros_in_process.middleware.type_descriptions import hash_of

#: kinds of ends, by their numbers in ROS
PUBLISHER, SUBSCRIPTION = 1, 2


def _named(ends: Iterable[Endpoint]) -> NamesAndTypes:
    return grouped((end.name, end.type_name) for end in ends)


def _dds_type(name: str, part: str = "") -> str:
    *folders, last = name.split("/")
    return "::".join([*folders, "dds_", f"{last}{part}_"])


def _dds_names(end: Endpoint) -> list[tuple[str, str]]:
    """Return the network topics of an endpoint."""
    if end.role in {"publisher", "subscription"}:
        return [(f"rt{end.name}", _dds_type(end.type_name))]
    return [
        (f"rq{end.name}Request", _dds_type(end.type_name, "_Request")),
        (f"rr{end.name}Reply", _dds_type(end.type_name, "_Response")),
    ]


def rclpy_get_topic_names_and_types(node: Node, no_demangle: bool) -> NamesAndTypes:
    """Return all topics, by their names in ROS or on the network."""
    if no_demangle:
        ends = [
            end
            for role in ("publisher", "subscription", "client", "service")
            for end in WORLD.seen(node, role)
        ]
        discovery = ("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_")
        return grouped([discovery, *(pair for end in ends for pair in _dds_names(end))])
    return _named(WORLD.seen(node, "publisher") + WORLD.seen(node, "subscription"))


def rclpy_get_service_names_and_types(node: Node) -> NamesAndTypes:
    """Return all services with a server or client."""
    return _named(WORLD.seen(node, "service") + WORLD.seen(node, "client"))


def rclpy_get_publisher_names_and_types_by_node(
    node: Node, no_demangle: bool, name: str, namespace: str
) -> NamesAndTypes:
    """Return the topics that a node publishes."""
    return _topics(WORLD.of_node(node, "publisher", name, namespace, "publisher"), no_demangle)


def rclpy_get_subscriber_names_and_types_by_node(
    node: Node, no_demangle: bool, name: str, namespace: str
) -> NamesAndTypes:
    """Return the topics to which a node subscribes."""
    return _topics(WORLD.of_node(node, "subscription", name, namespace, "subscriber"), no_demangle)


def _topics(ends: list[Endpoint], no_demangle: bool) -> NamesAndTypes:
    return grouped(pair for end in ends for pair in _dds_names(end)) if no_demangle else _named(ends)


def rclpy_get_service_names_and_types_by_node(node: Node, name: str, namespace: str) -> NamesAndTypes:
    """Return the services that a node offers."""
    return _named(WORLD.of_node(node, "service", name, namespace, "service"))


def rclpy_get_client_names_and_types_by_node(node: Node, name: str, namespace: str) -> NamesAndTypes:
    """Return the services that a node uses."""
    return _named(WORLD.of_node(node, "client", name, namespace, "client"))


def rclpy_get_publishers_info_by_topic(node: Node, topic: str, no_mangle: bool) -> list[dict[str, Any]]:
    """Return the publishers of a topic, with their quality of service."""
    return _infos(node, "publisher", PUBLISHER, topic, no_mangle)


def rclpy_get_subscriptions_info_by_topic(node: Node, topic: str, no_mangle: bool) -> list[dict[str, Any]]:
    """Return the subscriptions to a topic, with their quality of service."""
    return _infos(node, "subscription", SUBSCRIPTION, topic, no_mangle)


def _infos(node: Node, role: str, number: int, topic: str, no_mangle: bool) -> list[dict[str, Any]]:
    return [
        {
            "node_name": end.node.name,
            "node_namespace": end.node.namespace,
            "topic_type": _dds_type(end.type_name) if no_mangle else end.type_name,
            "topic_type_hash": hash_of(end.type_name),
            "endpoint_type": number,
            "endpoint_gid": end.gid,
            "qos_profile": end.profile.as_discovered(),
        }
        for end in WORLD.seen(node, role)
        if topic == (f"rt{end.name}" if no_mangle else end.name)
    ]


def rclpy_resolve_name(node: Node, name: str, only_expand: bool, is_service: bool) -> str:
    """Return the full name of a topic or service in a node."""
    return node.resolve(name, "rosservice" if is_service else "rostopic", only_expand)


def rclpy_remap_topic_name(node: Node, name: str) -> str:
    """Return a full name after remapping."""
    return node.resolve(name)
