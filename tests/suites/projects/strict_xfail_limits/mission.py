def approach(arm):
    arm.down(0.3)
    arm.down(0.3)
    return arm.height()


def withdraw(arm):
    arm.down(-0.2)
