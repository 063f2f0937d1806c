"""From what tests share follows which of them judge together, in which order."""

from __future__ import annotations

from mutabot.border.footprint import Footprint, SharedFixture
from mutabot.campaign.baseline.sharing import Sharing


def fixture(instance: int, *, has_teardown: bool = False) -> SharedFixture:
    return SharedFixture("arm", "module", instance, has_teardown)


def sharing(**footprints: Footprint) -> Sharing:
    return Sharing.of(list(footprints.items()))


def test_tests_that_share_nothing_are_independent() -> None:
    found = sharing(a=Footprint(), b=Footprint(), c=Footprint())
    assert found.closure(["b"]) == ("b",)
    assert found.why_together(["a", "c"]) is None
    assert found.why_alone(["a"]) is None


def test_a_shared_fixture_ties_all_that_use_it_and_no_others() -> None:
    found = sharing(
        a=Footprint((fixture(1),)), b=Footprint(), c=Footprint((fixture(1),)), d=Footprint((fixture(2),))
    )
    assert found.closure(["a"]) == ("a", "c")
    assert found.closure(["c"]) == ("a", "c")  # what a did to the fixture comes before
    assert found.why_together(["d"]) is None


def test_ties_go_on_from_test_to_test() -> None:
    found = sharing(
        a=Footprint((fixture(1),)), b=Footprint((fixture(1), fixture(2))), c=Footprint((fixture(2),))
    )
    assert found.closure(["a"]) == ("a", "b", "c")


def test_what_is_left_behind_concerns_all_later_tests_and_none_before() -> None:
    found = sharing(a=Footprint(), b=Footprint(left=("robot.ARM",)), c=Footprint(), d=Footprint())
    assert found.closure(["b"]) == ("b", "c", "d")
    assert found.closure(["a"]) == ("a",)
    assert found.closure(["d"]) == ("b", "d")  # b comes before, c does not matter
    assert found.why_together(["b"]) == ("b", "it leaves something behind: robot.ARM")


def test_who_makes_a_robot_anew_does_not_find_the_old_one() -> None:
    new = Footprint(left=("link.cell",), replaced=("link.cell",))
    found = sharing(a=new, b=new, c=Footprint(), d=new)
    assert found.closure(["a"]) == ("a",)
    assert found.closure(["b"]) == ("b", "c")  # c finds what b has made
    assert found.why_together(["d"]) is None


def test_a_robot_that_was_there_before_and_is_moved_ties_those_that_find_it() -> None:
    moved = Footprint(left=("link.cell",))
    new = Footprint(left=("link.cell",), replaced=("link.cell",))
    found = sharing(a=moved, b=Footprint(), c=new)
    assert found.closure(["a"]) == ("a", "b")
    assert found.closure(["c"]) == ("c",)


def test_files_that_outlive_a_test_concern_all_later_ones_and_forbid_branches() -> None:
    found = sharing(a=Footprint(files=("writes /x",), outlives=True), b=Footprint())
    assert found.closure(["a"]) == ("a", "b")
    assert found.why_alone(["a"]) == ("a", "it writes /x")


def test_files_of_the_test_alone_forbid_only_branches() -> None:
    found = sharing(a=Footprint(files=("writes /tmp/own",)), b=Footprint())
    assert found.why_together(["a"]) is None
    assert found.why_alone(["a"]) == ("a", "it writes /tmp/own")


def test_a_shared_tear_down_forbids_branches_also_for_its_only_user() -> None:
    found = sharing(a=Footprint((fixture(1, has_teardown=True),)))
    assert found.why_together(["a"]) is None
    assert found.why_alone(["a"]) == ("a", "fixture arm (module) may fail when it is taken down")


def test_what_nobody_can_look_into_concerns_all_later_tests() -> None:
    found = sharing(a=Footprint(unseen=("pybullet",)), b=Footprint(unseen=("pybullet",)))
    assert found.closure(["a"]) == ("a", "b")
