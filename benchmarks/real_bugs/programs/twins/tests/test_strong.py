"""How both arms do it."""

from robot import Arm, Panel

from program import Twins


def made(panel=None, **more):
    return Twins(Arm(**more), Arm((0.3, -0.2, 0.1), **more), panel or Panel())


def test_far_away_it_follows_in_steps():
    twins = made()
    twins.left.joints = [-20.0, 0.0, 3.0]
    assert not twins.follow()
    assert twins.right.joints == [5.0, 0.0, -3.0]
    assert not twins.follow()
    assert twins.right.joints == [10.0, 0.0, -3.0]


def test_it_steps_back_as_well():
    twins = made()
    twins.left.joints = [20.0, -20.0, 0.0]
    twins.follow()
    assert twins.right.joints == [-5.0, -5.0, 0.0]


def test_it_follows_within_its_limits():
    twins = made()
    twins.left.joints = [0.0, 120.0, 0.0]
    twins.right.joints = [0.0, 89.0, 0.0]
    assert not twins.follow()
    assert twins.right.joints == [0.0, 90.0, 0.0]


def test_each_joint_has_limits_of_its_own():
    twins = made()
    twins.left.joints = [-169.0, 0.0, 169.0]
    twins.right.joints = [168.0, 0.0, -168.0]
    twins.follow()
    assert twins.right.joints == [169.0, 0.0, -169.0]


def test_following_is_not_waited_for_but_the_start_is():
    twins = made()
    twins.start()
    twins.follow()
    assert [one[2] for one in twins.right.log if one[0] == "joints"] == [True, False]


def test_a_fragile_tray_is_held_softly_by_both():
    twins = made()
    twins.grip(fragile=True)
    assert twins.left.log == twins.right.log == [("close", 10.0)]


def test_other_trays_are_held_firmly():
    twins = made()
    twins.grip()
    assert twins.left.log == twins.right.log == [("close", 40.0)]


def test_hands_that_hold_nothing_open():
    twins = made(feels=False)
    twins.grip()
    assert twins.left.log[-1] == twins.right.log[-1] == "open"


def test_the_tray_stays_within_reach():
    twins = made()
    twins.grip()
    assert not twins.lift(0.75)
    assert twins.left.place == (0.3, 0.2, 0.1)


def test_both_arms_lift_at_once():
    twins = made()
    twins.grip()
    twins.lift(0.1)
    assert twins.left.log[-1][-1] is False
    assert twins.right.log[-1][-1] is True


def test_each_button_opens_its_own_hand():
    twins = made(Panel(right=True))
    twins.buttons()
    assert (twins.left.log, twins.right.log) == ([], ["open"])
    twins.panel = Panel(left=True)
    twins.buttons()
    assert (twins.left.log, twins.right.log) == (["open"], ["open"])


def test_without_buttons_the_tray_is_held_on():
    twins = made()
    twins.grip()
    twins.buttons()
    assert twins.holding


def test_they_halt_before_they_are_disabled():
    twins = made()
    twins.stop()
    assert twins.left.log == twins.right.log == ["halt", "disable"]


def test_after_a_stop_there_is_no_path():
    twins = made()
    twins.follow()
    kept = twins.path()
    twins.stop()
    assert twins.path() == []
    assert kept == [[0.0, 0.0, 0.0]]


def test_a_new_start_holds_nothing():
    twins = made()
    twins.grip()
    twins.start()
    assert not twins.holding
