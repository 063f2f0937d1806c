"""Axes, and what a quantity of several axes is spread over."""

from __future__ import annotations

import re
from dataclasses import replace

from mutabot.model import Path
from mutabot.model.values.path import Step

#: every axis a quantity may have
AXES = ("x", "y", "z", *(f"j{number}" for number in range(1, 13)))

_AXIS = re.compile(r"[xyz]|j(?:1[0-2]|[1-9])")
_JOINTS = re.compile(r"j(\d{1,2})(?:\.\.|-)j(\d{1,2})")


def split_axes(text: str) -> tuple[str, ...] | None:
    """The axes in ``x``, ``xyz``, ``j1j2j3`` or ``j1..j7``; None if it is anything else."""
    joints = _JOINTS.fullmatch(text)
    if joints is not None:
        axes = tuple(f"j{number}" for number in range(int(joints[1]), int(joints[2]) + 1))
    else:
        axes = tuple(_AXIS.findall(text))
        if "".join(axes) != text:
            return None
    return axes if axes and set(axes) <= set(AXES) else None


def slice_of(path: Path) -> Step | None:
    """The slice a path ends with, or None."""
    return path.steps[-1] if path.steps and path.steps[-1].bounds is not None else None


def spread(path: Path, axes: tuple[str, ...]) -> list[Path]:
    """One path per axis, for a path that ends with a slice.

    Raises ValueError if the slice does not have as many elements as there are axes.
    """
    step = path.steps[-1]
    assert step.bounds is not None
    return [
        replace(path, steps=(*path.steps[:-1], Step(item=index)))
        for index in _indices(step.bounds, len(axes), f"{step}", axes)
    ]


def _indices(
    bounds: tuple[int | None, int | None, int | None], count: int, text: str, axes: tuple[str, ...]
) -> range:
    start, stop, stride = bounds[0] or 0, bounds[1], bounds[2] or 1
    if stride < 1:
        raise ValueError(f"the slice {text} must go forwards to be spread over several axes")
    if stop is None and start < 0:
        stop = 0  # counted from the end, this is where the sequence ends
    if stop is None:
        return range(start, start + count * stride, stride)
    if start >= 0 > stop or (start < 0 < stop):
        raise ValueError(
            f"the slice {text} must start and stop at the same end of the sequence to be spread over axes"
        )
    found = max(0, -((start - stop) // stride))
    if found != count:
        raise ValueError(f"the slice {text} has {found} elements for {count} axes ({', '.join(axes)})")
    return range(start, stop, stride)
