"""What messages take, and what becomes of it on the way."""

from __future__ import annotations

import array
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Point, PoseStamped, Twist, Vector3
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Bool, ByteMultiArray, Float32, Float64, Header, Int8, Int32, String, UInt8, UInt64
from test_msgs.msg import Arrays, BasicTypes, BoundedSequences, Constants, Defaults, Strings, WStrings

from .declared import behaviour
from .graph import Graph, connect, raised

#: those in which the type support, which checks nothing in a release, reads what is no value
UNDETERMINED = (
    "a_float_field_takes_an_int",
    "a_float_field_takes_a_text",
    "a_float_field_takes_none",
    "an_array_of_a_wrong_length",
    "a_byte_field_takes_an_int",
)


def _publishing(kind: type, field: str, value: Any, is_determined: bool) -> Any:
    """Publish a message with a value in a field: the exception, or what arrives.

    Where the real type support reads memory that is no value, only whether the value arrives is determined.
    """
    with Graph("node") as graph:
        (node,) = graph
        heard: list[Any] = []
        node.create_subscription(kind, "topic", heard.append, 10)
        publisher = node.create_publisher(kind, "topic", 10)
        connect(graph, publisher)
        message = kind()
        assigned = raised(setattr, message, field, value)
        published = raised(publisher.publish, message)
        if published:
            return assigned, published
        graph.until(lambda: heard)
        arrived = repr(getattr(heard[0], field))
        return assigned, arrived if is_determined else arrived == repr(value)


def _declare(name: str, kind: type, field: str, value: Any) -> None:
    def act() -> Any:
        return _publishing(kind, field, value, name not in UNDETERMINED)

    act.__name__ = name
    behaviour()(act)


for _name, _kind, _field, _value in (
    ("a_float_field_takes_an_int", Float64, "data", 1),
    ("a_float_field_takes_a_text", Float64, "data", "1"),
    ("a_float_field_takes_none", Float64, "data", None),
    ("a_float_field_takes_infinity", Float64, "data", float("inf")),
    ("a_float32_is_rounded", Float32, "data", 0.1),
    ("a_float32_overflows", Float32, "data", 1e300),
    ("an_int_field_takes_a_float", Int32, "data", 1.5),
    ("an_int_field_takes_a_text", Int32, "data", "1"),
    ("an_int_field_takes_a_truth_value", Int32, "data", True),
    ("an_int32_overflows", Int32, "data", 2**40),
    ("an_int8_overflows", Int8, "data", 200),
    ("an_unsigned_field_takes_a_negative", UInt8, "data", -1),
    ("an_unsigned_long_takes_its_maximum", UInt64, "data", 2**64 - 1),
    ("a_truth_field_takes_an_int", Bool, "data", 1),
    ("a_text_field_takes_none", String, "data", None),
    ("a_text_field_takes_bytes", String, "data", b"bytes"),
    ("a_text_is_kept", String, "data", "Größe 🙂\n"),
    ("a_wide_text_is_kept", WStrings, "wstring_value", "Größe"),
    ("a_bounded_text_overflows", Strings, "bounded_string_value", "x" * 100),
    ("an_array_of_a_wrong_length", Arrays, "int32_values", [1, 2]),
    ("an_array_takes_a_list", Arrays, "int32_values", [1, 2, 3]),
    ("an_array_of_wrong_elements", Arrays, "string_values", [1, 2, 3]),
    ("a_bounded_sequence_overflows", BoundedSequences, "int32_values", [1, 2, 3, 4]),
    ("a_bounded_sequence_takes_a_tuple", BoundedSequences, "bool_values", (True, False)),
    ("a_message_field_takes_another_type", PoseStamped, "header", Vector3()),
    ("a_message_field_takes_none", Twist, "linear", None),
    ("a_byte_field_takes_an_int", BasicTypes, "byte_value", 7),
    ("a_byte_field_takes_bytes", BasicTypes, "byte_value", b"\x07"),
    ("a_char_field_takes_an_int", BasicTypes, "char_value", 65),
    ("a_list_of_bytes", ByteMultiArray, "data", [b"\x01", b"\x02"]),
):
    _declare(_name, _kind, _field, _value)


@behaviour(expected="TypeError", source="rclpy.publisher.Publisher.publish: raises TypeError")
def publishing_another_type() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return raised(node.create_publisher(Float64, "topic", 1).publish, String())


@behaviour(
    expected=["", "AssertionError", "AssertionError", "AssertionError"],
    source="std_msgs.msg.Int32: check_fields, and what the fields must be",
)
def a_message_checks_its_fields_if_asked() -> Any:
    checked = Int32(check_fields=True)
    return [
        raised(Int32, data="1"),
        raised(Int32, data="1", check_fields=True),
        raised(setattr, checked, "data", 1.5),
        raised(Int32, unknown=1, check_fields=True),
    ]


@behaviour()
def defaults_and_constants() -> Any:
    message = Defaults()
    fields = {name: repr(getattr(message, name)) for name in sorted(message.get_fields_and_field_types())}
    return fields, Constants.INT32_CONST, Constants.FLOAT64_CONST, Constants.BOOL_CONST


@behaviour()
def messages_are_equal_by_value() -> Any:
    first, second = PoseStamped(), PoseStamped(header=Header(frame_id="map"))
    different = first == second
    first.header.frame_id = "map"
    return different, first == second, first == Point(), repr(Vector3(x=1.0))


@behaviour()
def numbers_in_sequences_are_arrays() -> Any:
    sequences = BoundedSequences(int32_values=[1, 2])
    arrays = Arrays(int32_values=[1, 2, 3])
    kinds = [type(sequences.int32_values).__name__, type(arrays.int32_values).__name__]
    sent = deserialize_message(serialize_message(sequences), BoundedSequences)
    return kinds, sent.int32_values == array.array("i", [1, 2]), type(sent.int32_values).__name__


@behaviour(
    expected=["0001000005000000", "00010000060000006672616d6500"],
    source="OMG DDS-RTPS 2.5, 10.2 and OMG DDS-XTypes 1.3, 7.4: CDR, little endian, a header of four bytes",
)
def serialised_messages() -> Any:
    texts = serialize_message(String(data="frame")).hex()
    return serialize_message(Int32(data=5)).hex(), texts


@behaviour()
def a_nested_message_there_and_back() -> Any:
    pose = PoseStamped(header=Header(frame_id="map"))
    pose.header.stamp.sec = 5
    pose.pose.position = Point(x=1.0, y=-2.0, z=0.5)
    pose.pose.orientation.w = 1.0
    raw = serialize_message(pose)
    return len(raw), deserialize_message(raw, PoseStamped) == pose


@behaviour()
def what_cannot_be_read_or_written() -> Any:
    tries: list[tuple[Callable[..., Any], Any]] = [
        (deserialize_message, (b"", Int32)),
        (deserialize_message, (b"\x00\x01\x00\x00\x05", Int32)),
        (deserialize_message, ("text", Int32)),
        (serialize_message, ("text",)),
        (serialize_message, (Int32,)),
    ]
    return [bool(raised(function, *arguments)) for function, arguments in tries]
