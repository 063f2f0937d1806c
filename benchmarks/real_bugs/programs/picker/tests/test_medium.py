"""The task is done."""

from robot import Arm, Camera, Gripper

from program import BIN, Picker


def made(part):
    arm = Arm()
    return Picker(arm, Gripper(arm, part), Camera(arm, part))


def test_the_part_is_picked():
    assert made([0.25, 0.5]).run()


def test_the_arm_goes_to_the_bin_and_home():
    picker = made([0.25, 0.5])
    picker.run()
    assert ("move", *BIN) in picker.arm.log
    assert picker.arm.position == [0.0, 0.0]


def test_a_part_that_slips_is_a_failure():
    picker = made([0.25, 0.5])
    picker.gripper.part = [0.75, 0.5]
    assert not picker.run()
    assert picker.failed
