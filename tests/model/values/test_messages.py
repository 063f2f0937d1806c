"""Fields of messages as client libraries make them: slots, arrays, checks of types, parts by name."""

from __future__ import annotations

import copy
import subprocess
import sys
from array import array
from collections.abc import Callable
from pathlib import Path as File
from random import Random
from typing import Any

import numpy as np
import pytest

import mutabot
from mutabot.errors import PathError
from mutabot.model import Call, Kind, Operation, Path, Quantity, Reply
from mutabot.model.quantity import same
from mutabot.operators.middleware import rehearse
from mutabot.operators.operator import Subject
from mutabot.operators.registry import operator


def _checked(name: str, fits: Callable[[Any], bool]) -> property:
    def put(self: Any, value: Any) -> None:
        if self._check_fields:
            assert fits(value), f"The {name!r} field must be of another type"
        setattr(self, f"_{name}", value)

    return property(lambda self: getattr(self, f"_{name}"), put)


def _is_float(value: Any) -> bool:
    return isinstance(value, float)


def _is_array(typecode: str) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, array) and value.typecode == typecode


class Ros2:
    """A message as the generator of ROS 2 writes them: private slots, and setters that assert types."""

    class Message:
        __slots__: list[str] = ["_check_fields"]

        def __init__(self, **values: Any) -> None:
            self._check_fields = True
            for name, value in values.items():
                setattr(self, name, value)

    class Quaternion(Message):
        __slots__ = ["_w", "_x", "_y", "_z"]
        x, y, z, w = (_checked(name, _is_float) for name in "xyzw")

    class Pose(Message):
        __slots__ = ["_orientation"]
        orientation = _checked("orientation", lambda value: isinstance(value, Ros2.Quaternion))

    class Point(Message):
        __slots__ = ["_covariance", "_effort", "_positions"]
        positions = _checked("positions", _is_array("d"))
        covariance = _checked("covariance", lambda value: getattr(value, "dtype", None) == np.float64)
        effort = _checked("effort", _is_array("B"))

    class Trajectory(Message):
        __slots__ = ["_points"]
        points = _checked("points", lambda value: all(isinstance(item, Ros2.Point) for item in value))


class Ros1:
    """A message as the generator of ROS 1 writes them: slots, and a state that is a list."""

    class Message:
        __slots__: list[str] = []

        def __init__(self, **values: Any) -> None:
            for name in self.__slots__:
                setattr(self, name, values[name])

        def __getstate__(self) -> list[Any]:
            return [getattr(self, name) for name in self.__slots__]

        def __setstate__(self, state: list[Any]) -> None:
            for name, value in zip(self.__slots__, state, strict=True):
                setattr(self, name, value)

    class Quaternion(Message):
        __slots__ = ["w", "x", "y", "z"]

    class Pose(Message):
        __slots__ = ["orientation"]

    class Point(Message):
        __slots__ = ["covariance", "effort", "positions"]

    class Trajectory(Message):
        __slots__ = ["points"]


def trajectory(ros: Any) -> Any:
    first, last = (
        ros.Point(
            positions=array("d", [base + j for j in range(7)]),
            covariance=np.arange(6.0) + base,
            effort=array("B", [1, 2]),
        )
        for base in (0.0, 10.0)
    )
    return ros.Trajectory(points=[first, last])


def pose(ros: Any) -> Any:
    half = 0.5**0.5
    return ros.Pose(orientation=ros.Quaternion(x=0.0, y=0.0, z=half, w=half))


@pytest.mark.parametrize("ros", [Ros1, Ros2])
def test_a_joint_of_the_last_point_is_replaced_in_a_copy(ros: Any) -> None:
    message = trajectory(ros)
    before = copy.deepcopy(message)
    changed = Path.parse("points[-1].positions[2]", rooted=True)
    path = Path(None, (*Path.parse(".points", rooted=False).steps, *changed.steps))
    copied = path.put(message, -1.5)
    assert list(copied.points[-1].positions) == [10.0, 11.0, -1.5, 13.0, 14.0, 15.0, 16.0]
    assert list(message.points[-1].positions) == list(before.points[-1].positions)
    assert copied.points[0] is message.points[0]
    assert isinstance(copied.points[-1].positions, array)


@pytest.mark.parametrize("ros", [Ros1, Ros2])
@pytest.mark.parametrize("field", ["positions", "covariance"])
def test_a_slice_of_an_array_is_replaced_in_a_copy(ros: Any, field: str) -> None:
    message = trajectory(ros)
    path = Path.parse(f".points[-1].{field}[0:6]", rooted=False)
    assert list(path.get(message)) == [10.0, 11.0, 12.0, 13.0, 14.0, 15.0]
    copied = path.put(message, [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0])
    assert list(path.get(copied)) == [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0]
    assert list(path.get(message)) == [10.0, 11.0, 12.0, 13.0, 14.0, 15.0]
    assert type(getattr(copied.points[-1], field)) is type(getattr(message.points[-1], field))


@pytest.mark.parametrize("ros", [Ros1, Ros2])
@pytest.mark.parametrize("field", ["positions", "covariance"])
def test_a_slice_goes_the_other_way(ros: Any, field: str) -> None:
    path = Path.parse(f"message.points[-1].{field}[0:3]", rooted=True)
    quantity = Quantity("joints", path, Kind.ROTATION, unit="rad")
    message = trajectory(ros)
    subject = Subject(Operation("a:b", (quantity,)), quantity=quantity)
    call = Call(subject.operation, values={"joints": quantity.get(message)})
    passage = rehearse(operator("reverse").middleware(subject, Random(1)), call, {}, operator="reverse")
    copied = quantity.put(message, passage.performed[0].values["joints"])
    assert list(quantity.get(copied)) == [-10.0, -11.0, -12.0]


@pytest.mark.parametrize("ros", [Ros1, Ros2])
def test_a_quaternion_whose_parts_have_names_is_one_orientation(ros: Any) -> None:
    path = Path.parse(".orientation", rooted=False)
    message = pose(ros)
    for order in ("xyzw", "wxyz"):
        quantity = Quantity("orientation", path, Kind.QUATERNION, order=order)
        value = quantity.get(message)
        assert value == [getattr(message.orientation, part) for part in order]
        subject = Subject(Operation("a:b", result=(quantity,)), quantity=quantity)
        middleware = operator("negate").middleware(subject, Random(1))
        passage = rehearse(middleware, Call(subject.operation), {"orientation": value}, operator="negate")
        assert passage.received is not None
        copied = quantity.put(message, passage.received.values["orientation"])
        assert (copied.orientation.z, copied.orientation.w) == pytest.approx((-(0.5**0.5), 0.5**0.5))
        assert message.orientation.z == 0.5**0.5
        assert isinstance(copied.orientation, ros.Quaternion)


def test_an_object_with_less_parts_is_no_orientation() -> None:
    quantity = Quantity("q", Path(), Kind.QUATERNION, order="xyzw")
    assert quantity.get([0, 0, 0, 1]) == [0, 0, 0, 1]
    assert quantity.get(None) is None
    assert quantity.orientation(quantity.get(Ros1.Pose(orientation=None))) is None
    assert Reply({}).values == {}


def test_a_value_that_a_message_refuses_is_reported_with_its_path() -> None:
    message = trajectory(Ros2)
    with pytest.raises(PathError, match=r"cannot replace .*effort"):
        Path.parse(".points[0].effort", rooted=False).put(message, [1.5])
    with pytest.raises(PathError, match=r"cannot replace"):
        Path.parse(".points[0].effort[0]", rooted=False).put(message, -1)


def test_arrays_of_equal_numbers_are_the_same() -> None:
    assert same(array("d", [1, 2]), [1.0, 2.0])
    assert not same(array("d", [1, 2]), [1.0, 2.5])


PROBE = """
import sys
sys.path.append("/usr/lib/python3/dist-packages")
from geometry_msgs.msg import PoseStamped
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from mutabot.model import Kind, Path, Quantity
message = PoseStamped()
message.pose.orientation.w, message.pose.position.x = 1.0, 0.5
path = Path.parse(".pose.orientation", rooted=False)
quantity = Quantity("q", path, Kind.QUATERNION, order="xyzw")
copied = quantity.put(message, [0.0, 0.0, 1.0, 0.0])
copied = Path.parse(".pose.position.x", rooted=False).put(copied, -0.5)
print(quantity.get(message), quantity.get(copied), message.pose.position.x, copied.pose.position.x)
trajectory = JointTrajectory(points=[JointTrajectoryPoint(positions=(0.0, 1.0, 2.0))])
path = Path.parse(".points[-1].positions[0:2]", rooted=False)
print(path.get(path.put(trajectory, (5.0, 6.0))), path.get(trajectory))
"""


def test_real_messages_of_ros_1_are_changed_in_copies() -> None:
    if not File("/usr/lib/python3/dist-packages/trajectory_msgs").is_dir():
        pytest.skip("no messages of ROS 1 (trajectory_msgs) in Debian's dist-packages")
    home = str(File(mutabot.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", PROBE], capture_output=True, text=True, check=True, env={"PYTHONPATH": home}
    )
    assert done.stdout.splitlines() == [
        "[0.0, 0.0, 0.0, 1.0] [0.0, 0.0, 1.0, 0.0] 0.5 -0.5",
        "(5.0, 6.0) (0.0, 1.0)",
    ]
