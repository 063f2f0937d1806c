def stack(arm, heights):
    for height in heights:
        arm.lower(height)
        arm.grip(True)
        arm.lower(-height)
        arm.grip(closed=False)
    return arm.height()


def wave(arm, times):
    swing = arm.swing
    for _ in range(times):
        swing(30)
        swing(angle=-30)
