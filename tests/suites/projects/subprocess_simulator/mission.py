def dip(arm, times):
    for _ in range(times):
        arm.down(30)
        arm.down(-30)
    arm.drip(True)
    return arm.dipped()
