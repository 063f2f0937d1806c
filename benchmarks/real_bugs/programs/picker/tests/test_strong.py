"""How the task is done."""

from robot import Arm, Camera, Gripper

from program import Picker


def made(part):
    arm = Arm()
    return Picker(arm, Gripper(arm, part), Camera(arm, part))


def test_what_was_driven_is_known():
    picker = made([0.25, 0.5])
    picker.go(0.25, 0.5)
    assert picker.driven == [(0.25, 0.5)]


def test_a_soft_part_is_gripped_softly():
    picker = made([0.25, 0.5])
    picker.pick([0.25, 0.5], soft=True)
    assert picker.gripper.force == 5.0


def test_the_gripper_may_not_idle_while_it_holds():
    picker = made([0.25, 0.5])
    assert picker.may_idle()
    picker.pick([0.25, 0.5])
    assert not picker.may_idle()


def test_a_failure_is_forgotten_with_the_next_run():
    picker = made([0.25, 0.5])
    picker.gripper.part = None
    picker.run()
    picker.gripper.part = [0.25, 0.5]
    assert picker.run()
    assert not picker.failed


def test_after_a_failure_the_gripper_is_open_and_the_arm_home():
    picker = made([0.25, 0.5])
    picker.gripper.part = None
    picker.run()
    assert not picker.gripper.closed
    assert picker.arm.position == [0.0, 0.0]
