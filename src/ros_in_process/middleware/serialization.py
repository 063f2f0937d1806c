"""Serialization of messages as ROS sends them on the network (XCDR1, little endian)."""

from __future__ import annotations

import struct
from array import array
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from rosidl_parser import definition as idl

from ros_in_process.middleware.messages import TYPE_CODES, class_of, converted, fields_of
from ros_in_process.middleware.records import RMWError

_HEADER = b"\x00\x01\x00\x00"
_FORMATS = {**TYPE_CODES, "boolean": "?", "char": "B", "octet": "B"}


class _CdrWriter:
    def __init__(self) -> None:
        self.data = bytearray()

    def number(self, code: str, value: Any) -> None:
        size = struct.calcsize(code)
        self.data += bytes(-len(self.data) % size) + struct.pack("<" + code, value)

    def numbers(self, code: str, values: Any) -> None:
        raw = array(code, values).tobytes()
        if raw:
            self.data += bytes(-len(self.data) % struct.calcsize(code)) + raw


class _CdrReader:
    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def number(self, code: str) -> Any:
        size = struct.calcsize(code)
        self.at += -self.at % size
        (value,) = struct.unpack_from("<" + code, self.data, self.at)
        self.at += size
        return value

    def take(self, size: int) -> bytes:
        if self.at + size > len(self.data):
            raise struct.error("too few bytes")
        self.at += size
        return self.data[self.at - size : self.at]

    def numbers(self, code: str, count: int) -> array[Any]:
        size = struct.calcsize(code)
        if count:
            self.at += -self.at % size
        values = array(code)
        values.frombytes(self.take(size * count))
        return values


Write = Callable[[_CdrWriter, Any], None]
ReadFunction = Callable[[_CdrReader], Any]


@cache
def _codec(kind: type) -> list[tuple[str, Write, ReadFunction]]:
    return [(slot, _writing(of), _reading(of)) for slot, of in fields_of(kind)]


def _write_message(kind: type) -> Write:
    def write(writer: _CdrWriter, message: Any) -> None:
        fields = _codec(kind)
        for slot, write_field, _ in fields:
            write_field(writer, getattr(message, slot))
        if not fields:  # C has no empty structure
            writer.number("B", 0)

    return write


def _read_message(kind: Any) -> ReadFunction:
    def read(reader: _CdrReader) -> Any:
        message = kind.__new__(kind)
        message._check_fields = False
        fields = _codec(kind)
        for slot, _, read_field in fields:
            setattr(message, slot, read_field(reader))
        if not fields:
            reader.number("B")
        return message

    return read


def _writing(of: Any) -> Write:
    if isinstance(of, idl.BasicType):
        code = _FORMATS[of.typename]
        if of.typename == "octet":
            return lambda writer, value: writer.number("B", value[0])
        return lambda writer, value: writer.number(code, value)
    if isinstance(of, idl.AbstractString):
        return _write_string
    if isinstance(of, idl.AbstractWString):
        return _write_wide
    if isinstance(of, idl.NamespacedType):
        return _write_message(class_of(of))
    inner = of.value_type
    is_fixed = isinstance(of, idl.Array)
    if isinstance(inner, idl.BasicType) and inner.typename in TYPE_CODES:
        code = TYPE_CODES[inner.typename]

        def write_items(writer: _CdrWriter, values: Any) -> None:
            writer.numbers(code, values)

    else:
        write_one = _writing(inner)

        def write_items(writer: _CdrWriter, values: Any) -> None:
            for value in values:
                write_one(writer, value)

    def write(writer: _CdrWriter, values: Any) -> None:
        if not is_fixed:
            writer.number("I", len(values))
        write_items(writer, values)

    return write


def _reading(of: Any) -> ReadFunction:
    if isinstance(of, idl.BasicType):
        if of.typename == "octet":
            return lambda reader: bytes([reader.number("B")])
        code = _FORMATS[of.typename]
        return lambda reader: reader.number(code)
    if isinstance(of, idl.AbstractString):
        return lambda reader: reader.take(reader.number("I"))[:-1].decode()
    if isinstance(of, idl.AbstractWString):
        return lambda reader: reader.take(4 * reader.number("I")).decode("utf-32-le")
    if isinstance(of, idl.NamespacedType):
        return _read_message(class_of(of))
    inner = of.value_type
    size = of.size if isinstance(of, idl.Array) else None
    if isinstance(inner, idl.BasicType) and inner.typename in TYPE_CODES:
        code = TYPE_CODES[inner.typename]
        if size is None:
            return lambda reader: reader.numbers(code, reader.number("I"))
        return lambda reader: np.array(reader.numbers(code, size))
    read_one = _reading(inner)
    return lambda reader: [read_one(reader) for _ in range(reader.number("I") if size is None else size)]


def _write_string(writer: _CdrWriter, value: str) -> None:
    raw = value.encode()
    writer.number("I", len(raw) + 1)
    writer.data += raw + b"\x00"


def _write_wide(writer: _CdrWriter, value: str) -> None:
    raw = value.encode("utf-32-le")
    writer.number("I", len(raw) // 4)
    writer.data += raw


def rclpy_serialize(message: Any, kind: type) -> bytes:
    """Return a message as bytes."""
    writer = _CdrWriter()
    _write_message(kind)(writer, converted(message, kind))
    return _HEADER + bytes(writer.data)


def rclpy_deserialize(data: bytes, kind: type) -> Any:
    """Read a message from bytes. Raises RMWError if they are invalid."""
    try:
        return _read_message(kind)(_CdrReader(data[4:]))
    except (struct.error, UnicodeDecodeError):
        raise RMWError(f"failed to deserialize ROS message: no {kind.__name__}") from None
