"""However a command goes out, and whatever has changed it: a guard reads it, and none outside passes.

Commands go out by methods, assignments to properties, keyword arguments, text, lists, and messages, requests
and goals of a middleware. They are changed as operators do it, by new values of a call, and as all other
providers do it, by other arguments of the call itself.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random
from textwrap import dedent
from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import PathError
from mutabot.model import Call, Operation
from mutabot.model.quantity import Value, changes
from mutabot.runtime.interception.adapter import Adapter, Invocation
from mutabot.runtime.interception.guarding import CallGuard, CallGuards, GuardedCall, OperationGuard
from mutabot_hardware.command_guard import unreadable
from mutabot_hardware.guard import TableGuard

VOCABULARY = """
    [[operation]]
    call = "robot:Arm.move_to"
    arguments.x = { kind = "translation", axis = "x", unit = "mm", mode = "to" }
    arguments.z = { kind = "translation", axis = "z", unit = "mm", mode = "to" }
    arguments.speed = { kind = "speed", unit = "mm/s" }

    [[operation]]
    call = "robot:Arm.lift"
    arguments.z = { kind = "translation", axis = "z", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:Arm.follow"
    arguments."path[0:3]" = { kind = "translation", axis = "xyz", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:Arm.send"
    message = "text"
    patterns = [
      { text = "go/{x:g}/{z:g}", arguments = { x = { kind = "translation", axis = "x", unit = "cm", mode = "to" }, z = { kind = "translation", axis = "z", unit = "cm", mode = "to" } } },
    ]

    [[operation]]
    call = "robot:Arm.write"
    message = "address"
    patterns = [
      { text = "100", arguments.value = { kind = "translation", axis = "z", unit = "mm", mode = "to" } },
      { text = "101", arguments.value = { kind = "speed", unit = "mm/s" } },
    ]

    [[operation]]
    topic = "/arm/goal"
    direction = "publish"
    fields."pose.position.x" = { kind = "translation", axis = "x", unit = "m", mode = "to" }
    fields."pose.position.z" = { kind = "translation", axis = "z", unit = "m", mode = "to" }

    [[operation]]
    service = "/arm/move"
    request.z = { kind = "translation", axis = "z", unit = "m", mode = "to" }

    [[operation]]
    action = "/arm/follow"
    goal."points[-1][0:2]" = { kind = "translation", axis = "xz", unit = "m", mode = "to" }
    """  # noqa: E501
GUARD = {
    "box": [{"x": [0.2, 0.7], "z": [0.1, 0.9]}],
    "limit": [{"kind": "speed", "max": 0.25, "unit": "m/s"}],
}


class Readable(CallGuard):
    """What hardware mode adds: a text such as ``go/nan/50`` is none that a pattern describes."""

    def why_not(self, call: Call, unread: Mapping[str, str]) -> str | None:
        return unreadable(call, unread)


@dataclass
class Robot:
    """Notes what reaches it, in m and m/s: ``x``, ``z`` and ``speed`` of each command."""

    received: list[dict[str, float]] = field(default_factory=list)

    def move_to(self, x: Any, z: Any, *, speed: Any) -> None:
        self._note(x=x / 1e3, z=z / 1e3, speed=speed / 1e3)

    def lift(self, z: Any) -> None:
        self._note(z=z)

    def follow(self, path: Any) -> None:
        self._note(x=path[0], z=path[2])

    def send(self, text: str) -> None:
        _, x, z = text.split("/")
        self._note(x=float(x) / 100, z=float(z) / 100)

    def write(self, address: int, value: Any) -> None:
        self._note(**{"z" if address == 100 else "speed": value / 1e3})

    def publish(self, message: Any) -> None:
        self._note(x=message.pose.position.x, z=message.pose.position.z)

    def request(self, request: Any) -> None:
        self._note(z=request.z)

    def goal(self, goal: Any) -> None:
        self._note(x=goal.points[-1][0], z=goal.points[-1][1])

    def _note(self, **values: float) -> None:
        self.received.append(values)

    def outside(self) -> list[dict[str, float]]:
        """What lies outside the guard, by more than what units and text round off."""
        return [values for values in self.received if not all(_is_within(*pair) for pair in values.items())]


def _is_within(name: str, value: float) -> bool:
    least, greatest = {"x": (0.2, 0.7), "z": (0.1, 0.9), "speed": (-math.inf, 0.25)}[name]
    return least - 1e-12 <= value <= greatest + 1e-12


#: how each operation is called, with arguments drawn for it
Made = tuple[Callable[[Robot], Callable[..., None]], tuple[Any, ...], dict[str, Any]]


def _ways(number: Callable[[float], float]) -> dict[str, Made]:
    position = SimpleNamespace(x=number(1.0), z=number(1.0))
    return {
        "robot:Arm.move_to": (
            lambda robot: robot.move_to, (number(1e3),), {"z": number(1e3), "speed": number(250.0)}
        ),
        "robot:Arm.lift": (lambda robot: robot.lift, (number(1.0),), {}),
        "robot:Arm.follow": (lambda robot: robot.follow, ([number(1.0), 0.0, number(1.0)],), {}),
        "robot:Arm.send": (lambda robot: robot.send, (f"go/{number(100.0)}/{number(100.0)}",), {}),
        "robot:Arm.write": (lambda robot: robot.write, (100 + (number(1.0) > 0.5), number(1e3)), {}),
        "publish /arm/goal": (
            lambda robot: robot.publish, (SimpleNamespace(pose=SimpleNamespace(position=position)),), {}
        ),
        "call /arm/move": (lambda robot: robot.request, (SimpleNamespace(z=number(1.0)),), {}),
        "goal /arm/follow": (
            lambda robot: robot.goal, (SimpleNamespace(points=[[0.3, 0.3], [number(1.0), number(1.0)]]),), {}
        ),
    }  # fmt: skip


@pytest.fixture
def operations(tmp_path: Path) -> dict[str, Operation]:
    (tmp_path / "robot.toml").write_text(dedent(VOCABULARY), encoding="utf-8")
    found = load_vocabulary(["robot.toml"], tmp_path).operations
    return {operation.target: operation for operation in found}


def _adapter(operation: Operation) -> Adapter:
    def ignored(key: str, error: PathError) -> None:
        pass

    async def wait(seconds: float) -> None:
        pass

    parts: tuple[Any, ...] = ({}, ignored, {}, (), lambda: 0.0, wait)
    guards = CallGuards((TableGuard(GUARD), Readable({})), contextlib.nullcontext, lambda: None, frozenset())
    adapter = Adapter(operation, *parts)
    adapter.guard = OperationGuard(guards, Adapter(operation, *parts))
    return adapter


def _numbers(random: Random, *, wild: bool) -> Callable[[float], float]:
    """Numbers for a quantity of which 1 unit of the guard is ``scale``."""

    def number(scale: float) -> float:
        if not wild:
            return random.uniform(0.25, 0.65) * scale
        strange = (math.nan, math.inf, -math.inf, 0.0, 0.1, 0.9, 0.7, -0.4)
        drawn = random.choice((random.uniform(-2.0, 2.0), random.gauss(0.5, 0.3), random.choice(strange)))
        return drawn * scale

    return number


def _sent(adapter: Adapter, robot: Robot, random: Random, *, by_values: bool) -> bool:
    """Send one command that is changed; returns whether it passed."""
    wild = _numbers(random, wild=True)
    target = adapter.operation.target
    of, args, kwargs = _ways(_numbers(random, wild=False) if by_values else wild)[target]
    call = adapter.to_call(Invocation(of(robot), robot, args, kwargs))
    changed: Mapping[str, Value] | None = None
    if by_values:
        original, meant = call, call.pattern or call.operation
        for quantity in random.sample(meant.arguments, random.randint(1, len(meant.arguments))):
            scale = quantity.from_unit(1.0, "m" if quantity.axis else "m/s")
            call = call.with_value(quantity, wild(scale))
        changed = changes(meant.arguments, original.values, call.values)
    try:
        adapter.perform(call, changed)
    except (GuardedCall, ValueError):  # a text cannot hold every number
        return False
    return True


def _changed(operations: dict[str, Operation], many: int, seed: int) -> Iterator[tuple[str, bool]]:
    random, robot = Random(seed), Robot()
    adapters = [
        _adapter(operation) for target, operation in operations.items() if target in _ways(lambda scale: 0.5)
    ]
    assert len(adapters) == len(_ways(lambda scale: 0.5))
    for number in range(many):
        adapter = adapters[number % len(adapters)]
        yield adapter.operation.target, _sent(adapter, robot, random, by_values=random.random() < 0.5)
        if number % 1000 == 0 or number == many - 1:
            assert robot.outside() == []
            robot.received.clear()


@pytest.mark.parametrize("many", [2_000, pytest.param(100_000, marks=pytest.mark.whole)])
def test_no_mutated_command_outside_passes_whichever_way_it_goes(
    operations: dict[str, Operation], many: int
) -> None:
    passed, kept = dict.fromkeys(operations, 0), dict.fromkeys(operations, 0)
    for target, is_passed in _changed(operations, many, seed=1):
        (passed if is_passed else kept)[target] += 1
    ways = _ways(lambda scale: 0.5)
    assert min(passed[way] for way in ways) > many / 1000
    assert min(kept[way] for way in ways) > many / 1000


def test_without_a_guard_each_way_leads_outside(operations: dict[str, Operation]) -> None:
    random = Random(1)
    for target in _ways(lambda scale: 0.5):
        robot, adapter = Robot(), replace(_adapter(operations[target]), guard=None)
        for _ in range(100):
            _sent(adapter, robot, random, by_values=random.random() < 0.5)
        assert robot.outside()
