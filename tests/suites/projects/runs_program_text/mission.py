def main(arm):
    arm.lift(0.5)
    arm.turn(30)
    arm.lift(-0.25)
    return arm.x
