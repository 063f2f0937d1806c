def fill(arm, levels):
    for level in levels:
        arm.lift(level)
        arm.open()
        if arm.height() < 1:
            arm.close()
