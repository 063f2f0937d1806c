"""The program ends."""

from robot import Arm, Camera, Gripper

from program import Picker


def test_it_ends():
    arm = Arm()
    assert Picker(arm, Gripper(arm, [0.25, 0.5]), Camera(arm, [0.25, 0.5])).run() in (True, False)


def test_nothing_is_found_where_nothing_is():
    arm = Arm()
    assert not Picker(arm, Gripper(arm), Camera(arm, None)).run()
