"""Copies of messages, converted field by field as the C type support converts them.

What a subscription hears is never the publisher's object. A field of a wrong type raises or is cut, as with
real ROS: numbers lose their upper bits, `1` is not `True`, and an `int` in a floating-point field becomes
nonsense.
"""

from __future__ import annotations

import importlib
import operator
import re
import struct
from array import array
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from rosidl_parser import definition as idl

from ros_in_process.errors import note
from ros_in_process.middleware.records import RCLError

Convert = Callable[[Any], Any]

#: bits and sign of the integer types
INTEGERS = {
    "int8": (8, True), "uint8": (8, False), "int16": (16, True), "uint16": (16, False),
    "int32": (32, True), "uint32": (32, False), "int64": (64, True), "uint64": (64, False),
    "char": (8, False), "octet": (8, False),
}  # fmt: skip
#: how sequences of numbers are kept: the type codes of `array`
TYPE_CODES = {
    "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q",
}  # fmt: skip
_NUMPY = {"float": "float32", "double": "float64"}


def fields_of(kind: type) -> list[tuple[str, Any]]:
    """Return the slots of a message class with the types of their fields."""
    slots = [slot for slot in kind.__slots__ if slot != "_check_fields"]  # type: ignore[attr-defined]
    return list(zip(slots, kind.SLOT_TYPES, strict=True))  # type: ignore[attr-defined]


@cache
def _conversions(kind: type) -> list[tuple[str, str, Convert]]:
    return [(slot, slot[1:], _conversion(of, slot[1:])) for slot, of in fields_of(kind)]


def converted(message: Any, kind: Any) -> Any:
    """Return a copy of a message as an object of the class. Raises what the conversion to C raises."""
    copy = kind.__new__(kind)
    copy._check_fields = False
    for slot, name, convert in _conversions(kind):
        setattr(copy, slot, convert(getattr(message, name)))
    return copy


def class_of(of: Any) -> type:
    """Return the message class of a nested type."""
    package = ".".join(of.namespaces)
    module = importlib.import_module(package)
    if not hasattr(module, of.name):  # a part of a service or an action, such as `Fibonacci_Goal`
        snake = re.sub(
            r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", of.name.partition("_")[0]
        ).lower()
        module = importlib.import_module(f"{package}._{snake}")
    return getattr(module, of.name)  # type: ignore[no-any-return]


def _conversion(of: Any, name: str) -> Convert:
    if isinstance(of, idl.BasicType):
        return _basic(of.typename)
    if isinstance(of, idl.AbstractString):
        return _string
    if isinstance(of, idl.AbstractWString):
        return _string
    if isinstance(of, idl.NamespacedType):
        kind = class_of(of)
        return lambda value: converted(value, kind)
    if isinstance(of, idl.Array):
        return _array(of, name)
    return _sequence(of, name)


def _basic(typename: str) -> Convert:
    if typename == "boolean":
        return lambda value: value is True
    if typename in {"float", "double"}:
        return _double if typename == "double" else _single
    if typename == "octet":
        return _octet
    return _integer(*INTEGERS[typename])


def _double(value: Any) -> float:
    if isinstance(value, float):
        return float(value)
    if isinstance(value, int):  # C reads the object's number of digits as if it were the value
        size = -(-abs(value).bit_length() // 30) * (-1 if value < 0 else 1)
        return float(struct.unpack("d", struct.pack("q", size))[0])
    note(f"a floating-point field holds {type(value).__name__}: what others hear is not defined")
    return 0.0


def _single(value: Any) -> float:
    return float(struct.unpack("f", struct.pack("f", _double(value)))[0])


def _octet(value: Any) -> bytes:
    if not isinstance(value, bytes) or not value:
        note(f"a field of bytes holds {type(value).__name__}: what others hear is not defined")
        return b"\x00"
    return value[:1]


def _integer(bits: int, is_signed: bool) -> Convert:
    # numbers of up to 64 bits pass through a C long, then lose their upper bits
    low, high = (-(2**63), 2**63) if is_signed else (0, 2**64)
    lowest, size = (-(2 ** (bits - 1)), 2**bits) if is_signed else (0, 2**bits)

    def convert(value: Any) -> int:
        if type(value) is int and lowest <= value < lowest + size:
            return value
        try:
            number = _within(operator.index(value), low, high, bits)
        except (TypeError, OverflowError) as error:
            raise SystemError("<built-in method publish> returned a result with an exception set") from error
        return int((number - lowest) % size + lowest)

    return convert


def _within(number: int, low: int, high: int, bits: int) -> int:
    if low <= number < high:
        return number
    if number < 0 == low:
        raise OverflowError(
            f"can't convert negative {'int to unsigned' if bits == 64 else 'value to unsigned int'}"
        )
    if bits == 64:
        raise OverflowError("int too big to convert")
    raise OverflowError(f"Python int too large to convert to C {'unsigned long' if low == 0 else 'long'}")


def _string(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError("bad argument type for built-in operation")
    return str(value)


def _items(value: Any, name: str) -> Any:
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"expected a sequence in '{name}'") from None


def _sequence(of: Any, name: str) -> Convert:
    inner = of.value_type
    if isinstance(of, idl.BoundedSequence):
        return _bounded(_sequence(idl.UnboundedSequence(inner), name), of.maximum_size)
    if isinstance(inner, idl.BasicType) and inner.typename in TYPE_CODES:
        code = TYPE_CODES[inner.typename]
        convert = _basic(inner.typename)

        def numbers(value: Any) -> Any:
            if isinstance(value, array) and value.typecode == code:
                return value[:]
            return array(code, [convert(item) for item in _items(value, name)])

        return numbers
    return _listed(_conversion(inner, name), name)


def _bounded(convert: Convert, size: int) -> Convert:
    def bounded(value: Any) -> Any:
        items = convert(value)
        if len(items) > size:
            raise RCLError("Failed to publish: cannot publish data")
        return items

    return bounded


def _listed(convert: Convert, name: str) -> Convert:
    return lambda value: [convert(item) for item in _items(value, name)]


def _array(of: Any, name: str) -> Convert:
    inner, size = of.value_type, of.size
    if not isinstance(inner, idl.BasicType) or inner.typename not in TYPE_CODES:
        return _listed(_conversion(inner, name), name)
    dtype = np.dtype(_NUMPY.get(inner.typename, inner.typename))

    def numbers(value: Any) -> Any:
        copy = np.array(value, dtype=dtype).reshape(-1)
        if copy.size != size:
            note(f"the field '{name}' holds {copy.size} numbers, not {size}: what others hear is not defined")
            copy = np.resize(np.concatenate([copy, np.zeros(size, dtype)]), size)
        return copy

    return numbers


def type_name(kind: type) -> str:
    """Return a class's name on the network, such as `std_msgs/msg/String`."""
    package, folder = kind.__module__.split(".")[:2]
    return f"{package}/{folder}/{kind.__name__}"


class _TypeSupport:
    """Replaces a package's C type support: classes only check that there is one."""

    def __getattr__(self, name: str) -> str:
        return name


def install() -> None:
    """Replace the loading of C type support, since messages are converted here."""
    import rosidl_generator_py  # noqa: PLC0415  (only where there is ROS)

    support = _TypeSupport()
    rosidl_generator_py.import_type_support = lambda package: support
