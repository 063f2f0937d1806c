import mission
import pytest
from robot import Arm, Gripper, World


class TestThreeBoxes:
    @pytest.fixture(scope="class")
    def world(self):
        world = World()
        mission.stack(Arm(world), Gripper(world))
        return world

    def test_gripper_is_empty(self, world):
        assert not world.holding

    def test_three_are_there(self, world):
        assert len(world.stacked) == 3

    def test_all_at_the_pallet(self, world):
        assert {angle for angle, _ in world.stacked} == {90}


class TestTwoBoxes:
    @pytest.fixture(scope="class", autouse=True)
    def stacked(self, request):
        request.cls.world = World()
        mission.stack(Arm(self.world), Gripper(self.world), boxes=2)

    def test_two_are_there(self):
        assert len(self.world.stacked) == 2

    def test_no_box_below_the_floor(self):
        assert all(height >= 0 for _, height in self.world.stacked)
