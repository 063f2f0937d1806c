"""Records readings during a test, at ticks of an object that monitors conditions.

Such an object has a method ``always(condition, name)``, which is asked at every tick of simulated time, and
``truth`` with readings that need no argument. Nothing here ever breaks a condition.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

#: prefix of the keys under which recordings are among the readings
SIGN = "~"
#: moments that are kept of each test at most, and ticks between two at first
_MOST, _EVERY = 800, 5
#: what may be great for one tick alone, as the force of an impact
PEAKS = re.compile(r"(?:^|[._])(?:force|speed)(?:\(\))?$")

_recordings: list[_TickRecording] = []


def is_watched(owner: Any) -> bool:
    """Return whether objects of a class, or an object, can be watched."""
    return callable(getattr(owner, "always", None)) and (
        isinstance(owner, type) or hasattr(owner, "truth") or hasattr(owner, "verify")
    )


def watch(name: str, owner: Any, readings: Sequence[tuple[str, Callable[[], Any]]] = ()) -> None:
    """Start to record what can be read of ``owner``, which the test calls ``name``.

    ``readings``: further expressions, each with what evaluates it.
    """
    if not is_watched(owner) or isinstance(owner, type):
        return
    _recordings.clear()
    found = {text: read for text, read in (*_of_truth(name, owner), *readings) if _works(read)}
    recording = _TickRecording(name, found)
    _recordings.append(recording)
    owner.always(recording.see, "what mutabot suggest sees")


def recordings() -> dict[str, str]:
    """Return the recordings of the running test, as JSON by the watched object's name."""
    found = {
        f"{SIGN}{recording.name}": json.dumps([recording.texts, recording.rows])
        for recording in _recordings
        if recording.rows
    }
    _recordings.clear()
    return found


class _TickRecording:
    """A recording of readings at some ticks; the longer the test, the fewer ticks are kept.

    Attributes:
        texts: the expressions of the numbers in ``rows``.
    """

    def __init__(self, name: str, readings: Mapping[str, Callable[[], Any]]) -> None:
        self.name = name
        self.texts: list[str] = []
        self.rows: list[list[float]] = []
        self._readings = readings
        self._sudden = {text: read for text, read in readings.items() if _has_peaks(text, read())}
        self._peaks: dict[str, float] = {}
        self._ticks, self._every = 0, _EVERY

    def see(self) -> bool:
        """Take a reading if one is due; always return True, as a condition that holds."""
        self._ticks += 1
        is_due = self._ticks % self._every == 0
        try:
            self._see_peaks()
            pairs = [*self._pairs()] if is_due else []
        except Exception:  # a reading that fails on the way is none
            return True
        if is_due:
            self.texts = [text for text, _ in pairs]
            self.rows.append([round(self._peaks.get(text, value), 6) for text, value in pairs])
            self._peaks.clear()
            if len(self.rows) > _MOST:
                self.rows = _halved(self.texts, self.rows)
                self._every *= 2
        return True

    def _pairs(self) -> Iterator[tuple[str, float]]:
        for text, read in self._readings.items():
            yield from _numbers(text, read())

    def _see_peaks(self) -> None:
        """Keep the largest values since the last moment that was recorded."""
        for text, read in self._sudden.items():
            for name, value in _numbers(text, read()):
                if PEAKS.search(name):
                    self._peaks[name] = max(value, self._peaks.get(name, value), key=abs)


def _has_peaks(text: str, value: Any) -> bool:
    return any(PEAKS.search(name) for name, _ in _numbers(text, value))


def _halved(texts: Sequence[str], rows: Sequence[list[float]]) -> list[list[float]]:
    """Return every second moment, with the larger peak of both."""
    peaks = [number for number, text in enumerate(texts) if PEAKS.search(text)]
    kept = []
    for before, row in zip(rows[::2], rows[1::2], strict=False):
        larger = {number: max(before[number], row[number], key=abs) for number in peaks}
        kept.append([larger.get(number, value) for number, value in enumerate(row)])
    return kept


def _works(read: Callable[[], Any]) -> bool:
    try:
        return bool(list(_numbers("", read())))
    except Exception:  # what cannot be read is no reading
        return False


def _of_truth(name: str, owner: Any) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield the readings of the object's ``truth`` that need no argument."""
    truth = getattr(owner, "truth", None)
    for attribute in dir(type(truth)) if truth is not None else ():
        read = getattr(truth, attribute, None) if not attribute.startswith("_") else None
        if inspect.ismethod(read) and _needs_nothing(read):
            yield f"{name}.truth.{attribute}()", read


def _needs_nothing(read: Callable[..., Any]) -> bool:
    given = inspect.signature(read).parameters.values()
    return all(parameter.default is not inspect.Parameter.empty for parameter in given)


def _numbers(text: str, value: Any) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a reading: itself, or the fields of a plain object and its force or speed."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield text, float(value)
    elif is_dataclass(value) and not isinstance(value, type):
        properties = [name for name, part in vars(type(value)).items() if isinstance(part, property)]
        names = [attribute.name for attribute in fields(value)]
        for name in [*names, *filter(PEAKS.search, properties)]:
            yield from _numbers(f"{text}.{name}", getattr(value, name))
    elif hasattr(type(value), "_fields"):
        for field in value._fields:
            yield from _numbers(f"{text}.{field}", getattr(value, field))
