"""What the tests read to judge by."""


def is_inserted(arm):
    return arm.depth() < -4.0


def is_straight(arm):
    return abs(arm.angle) < 1


def peg_moved(arm):
    return arm.depth() != 0
