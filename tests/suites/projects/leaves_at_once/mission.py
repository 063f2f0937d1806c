def pick(arm):
    arm.lift(0.2)
    arm.turn(30.0)


def place(arm):
    arm.lift(-0.2)
    arm.turn(-30.0)
