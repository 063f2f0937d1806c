"""Keeps Dask from unpickling what workers send: descriptions replace the objects.

Dask's client unpickles results, exceptions, the types of results, and warnings of workers. Its option
``deserializers`` does not close this: messages on the stream from the scheduler, parts that a message marks
as pickled, and the type of data that Dask serializes itself are unpickled whatever it says. So the functions
themselves are replaced, in this whole process, once it connects to a cluster. They raise nothing: an error in
them would make the client deaf to all other answers.
"""

from __future__ import annotations

import importlib
import io
import pickle
from types import SimpleNamespace
from typing import Any

from mutabot.api.reports import UsageError

#: how the type of bytes is pickled, which is all that an answer needs
_BYTES = {pickle.dumps(bytes, protocol) for protocol in range(pickle.HIGHEST_PROTOCOL + 1)}
#: characters of what an exception says that are kept
_LENGTH = 1000


class Placeholder(Exception):  # noqa: N818  # it is a value
    """A placeholder for an object that was not unpickled, or for one of its parts.

    Attributes:
        kind: the name of its class.
        text: its texts, as far as they are plain.
    """

    kind = text = ""

    def __init__(self, *given: Any, **_: Any) -> None:
        super().__init__()
        flat = [part for value in given for part in (value if type(value) is tuple else (value,))]
        self.text = ": ".join(value[:_LENGTH] for value in flat if type(value) is str)[:_LENGTH]
        # an exception comes with what makes it, which comes first
        kinds = (value.__name__ for value in given if isinstance(value, type))
        self.kind = next(kinds, type(self).__name__)

    def __setstate__(self, state: Any) -> None:
        """Ignore the state."""

    def __str__(self) -> str:
        return self.text or "an object that is not read"


class _SafeUnpickler(pickle.Unpickler):
    """An unpickler that imports and calls nothing: placeholders replace classes and functions."""

    def find_class(self, module: str, name: str) -> Any:
        return type(str(name)[:100], (Placeholder,), {})


def install() -> None:
    """Replace Dask's unpickling functions. Raises UsageError if this version of Dask has none of these."""
    for module, name, replacement in (
        ("distributed.protocol.pickle", "loads", _loaded),
        ("distributed.protocol.core", "merge_and_deserialize", _deserialized),
        ("distributed.core", "clean_exception", _exception),
        ("distributed.client", "clean_exception", _exception),
        ("distributed.client", "loads", _loaded),
        ("distributed.client", "pickle", SimpleNamespace(loads=_loaded)),
    ):
        found = importlib.import_module(module)
        if not hasattr(found, name):
            raise UsageError(
                f"this version of distributed has no {module}.{name}, so workers could run programs on this "
                "machine: install another version of mutabot or distributed"
            )
        setattr(found, name, replacement)


def describe(error: object) -> str:
    """Return a description of an exception in one line; of other objects, what they are."""
    lines = str(error).strip().splitlines() if isinstance(error, Exception) else []
    kind = error.kind if isinstance(error, Placeholder) and error.kind else type(error).__name__
    return f"{kind}: {lines[0]}" if lines else kind


def _loaded(data: Any, **given: Any) -> Any:
    """Replace ``pickle.loads``: return plain values, the type of bytes, and placeholders."""
    try:
        if bytes(data) in _BYTES:
            return bytes
        return _SafeUnpickler(io.BytesIO(data), buffers=given.get("buffers") or ()).load()
    except Exception as error:
        return Placeholder(f"no readable data ({type(error).__name__})")


def _deserialized(header: Any, frames: Any, deserializers: Any = None) -> Any:
    """Replace the deserialization of a value in a message: return bytes as they are, else a description."""
    try:
        data = b"".join(map(bytes, frames))
        match header.get("serializer"):
            case "dask" if bytes(header["type-serialized"]) in _BYTES:
                return data
            case "pickle":
                return _loaded(data)
            case "error":
                return Placeholder(data[:_LENGTH].decode("utf-8", "replace"))
    except Exception as error:
        return Placeholder(f"no readable data ({type(error).__name__})")
    return Placeholder("an object that is not read")


def _exception(exception: Any = None, traceback: Any = None, **_: Any) -> tuple[type[Any], Any, None]:
    """Replace the deserialization of exceptions; tracebacks are dropped."""
    found = _loaded(exception) if isinstance(exception, bytes | bytearray) else exception
    if not isinstance(found, BaseException):
        found = Placeholder(found if type(found) is str else "an object that is not read")
    return type(found), found, None
