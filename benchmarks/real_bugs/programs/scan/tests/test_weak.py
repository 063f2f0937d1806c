"""It sees."""

from robot import Base, Laser, Pose

from program import Scanner


def made(*ranges, **more):
    return Scanner(Laser(*ranges, **more), Pose(), Base())


def test_it_sees_points():
    assert len(made(1.0, 2.0, 3.0).read()) == 3


def test_nothing_is_in_the_way():
    assert made().ahead() is None


def test_it_goes():
    assert made().guard(100) == "go"


def test_it_adds_points():
    scanner = made(1.0, 2.0)
    scanner.add()
    assert scanner.points
