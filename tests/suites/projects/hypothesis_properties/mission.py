def approach(arm, distance):
    arm.forward(distance)
    arm.forward(0.05)
    arm.stop()
