import mission
from robot import Rover


def test_stops_before_the_wall():
    rover = Rover()
    mission.go_to_wall(rover)
    assert rover.distance() > 0.2


def test_turns_to_the_light():
    rover = Rover()
    mission.turn_to_light(rover)
    assert rover.heading == 90
