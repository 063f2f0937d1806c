"""Through which expressions something is written."""

from __future__ import annotations

from textwrap import dedent

import pytest

from mutabot.campaign.baseline.writes import written_through

WRITTEN = [
    "data.qpos[0] = 1",
    "data.qpos[0] += 1",
    "data.qpos[0], other = 1, 2",
    "data.qpos[:] = other",
    "data.qpos[0].x = 1",
    "del data.qpos[0]",
    "data.qpos.fill(0)",
    "data.qpos.append(1)",
    "np.copyto(data.qpos, other)",
    "np.add(other, 1, out=data.qpos)",
    "data.qpos.reshape(3)[0] = 1",
    "np.asarray(data.qpos)[0] = 1",
    "view = data.qpos\nview[0] = 1",
    "view = data.qpos\nview += 1",
    "view = data.qpos\nother = view\nother.fill(0)",
    "view = data.qpos[0:3]\nview[0] = 1",
    "view, more = data.qpos, 1\nview[0] = 1",
    "for part in data.qpos:\n    part[0] = 1",
    "def f():\n    view = data.qpos\n    view[0] = 1",
    "def f():\n    return data.qpos\ndef g():\n    f()[0] = 1",
    "class C:\n    def f(self):\n        self.view = data.qpos\n    def g(self):\n        self.view[0] = 1",
    "if (view := data.qpos) is not None:\n    view[0] = 1",
    "(data.qpos if a else b)[0] = 1",
]
NOT_WRITTEN = [
    "x = data.qpos[0]",
    "other[data.qpos] = 1",
    "other[0] = data.qpos[0]",
    "data.qpos = other",
    "view = data.qpos\nother = view[0]",
    "view = data.qpos.copy()\nview[0] = 1",
    "view = list(data.qpos)\nview[0] = 1",
    "def f():\n    view = data.qpos\ndef g():\n    view = other\n    view[0] = 1",
    "go(data.qpos)",
]


def texts(source: str) -> set[str]:
    """The texts at the places that are found."""
    lines = source.splitlines()
    return {
        lines[first - 1][start:end] for first, start, last, end in written_through(source) if first == last
    }


@pytest.mark.parametrize("source", WRITTEN)
def test_the_view_is_written_through(source: str) -> None:
    assert "data.qpos" in texts(dedent(source))


@pytest.mark.parametrize("source", NOT_WRITTEN)
def test_the_view_is_not_written_through(source: str) -> None:
    assert "data.qpos" not in texts(dedent(source))


def test_calls_are_found_as_attributes_are() -> None:
    source = "robot.state()[0] = 1\nview = robot.force(1)\nview[2] -= 1\n"
    assert {"robot.state()", "robot.force(1)"} <= texts(source)
