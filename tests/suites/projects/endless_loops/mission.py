"""Go until the sensor says so."""


def go_to_wall(rover):
    while rover.distance() > 0.3:
        rover.forward(0.1)
    rover.stop()


def turn_to_light(rover):
    while not rover.sees_light():
        rover.turn(30)
