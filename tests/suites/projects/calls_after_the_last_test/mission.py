def pick(arm):
    arm.lift(0.2)
    arm.turn(30.0)


def turn_back(arm):
    arm.turn(-30.0)


def place(arm):
    arm.lift(-0.15)


def lower(arm):
    arm.lift(-0.05)
    arm.turn(360.0)
