import pytest
from gait.walk import to_cm, walk
from robot import Leg


def test_walks():
    assert walk(Leg(), 2) in (50, -50)


def test_takes_whole_centimetres():
    assert to_cm(0.5) == 50


def test_types_are_checked():
    with pytest.raises(TypeError, match="no int"):
        to_cm(200.0)
