import mission
import pytest
from robot import Car, Truck


class VehicleTests:
    vehicle = None

    @pytest.fixture(scope="class")
    def car(self):
        return self.vehicle()

    def test_1_park(self, car):
        mission.park(car)

    def test_2_wheels_are_straight(self, car):
        assert car.wheel == 0

    def test_3_position(self, car):
        assert car.x == 1.0

    def test_4_leave(self, car):
        mission.leave(car)


class TestCar(VehicleTests):
    vehicle = Car


class TestTruck(VehicleTests):
    vehicle = Truck

    def test_5_out_again(self, car):
        assert car.x == 3.0
