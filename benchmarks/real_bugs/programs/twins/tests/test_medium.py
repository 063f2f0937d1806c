"""What both arms do."""

from robot import Arm, Panel

from program import READY, Twins


def made(panel=None, left=True, right=True):
    return Twins(Arm(feels=left), Arm((0.3, -0.2, 0.1), feels=right), panel or Panel())


def test_they_start_ready():
    twins = made()
    twins.start()
    assert twins.left.joints == twins.right.joints == list(READY)


def test_the_right_arm_follows_in_the_mirror():
    twins = made()
    twins.left.joints = [3.0, 4.0, -2.0]
    assert twins.follow()
    assert twins.right.joints == [-3.0, 4.0, 2.0]


def test_nothing_is_lifted_that_is_not_held():
    assert not made().lift(0.1)


def test_the_tray_is_lifted():
    twins = made()
    twins.grip()
    twins.lift(0.25)
    assert twins.left.place == (0.3, 0.2, 0.35)
    assert twins.right.place == (0.3, -0.2, 0.35)


def test_one_hand_is_not_enough():
    assert not made(left=False).grip()
    assert not made(right=False).grip()


def test_a_button_opens_a_hand():
    twins = made(Panel(left=True))
    twins.grip()
    twins.buttons()
    assert "open" in twins.left.log
    assert not twins.holding


def test_they_stop():
    twins = made()
    twins.start()
    twins.stop()
    assert not twins.left.enabled
    assert not twins.right.enabled
