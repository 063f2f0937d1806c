from robot import Arm


def tour(queue, stations):
    places = []
    arm = Arm(places)
    for _ in range(stations):
        arm.rotate(90)
        arm.put()
    if arm.angle() >= 360:
        arm.rotate(-360)
    queue.put((places, arm.turn))
