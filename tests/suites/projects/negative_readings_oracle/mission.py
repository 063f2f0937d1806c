def insert_peg(arm, depth):
    arm.down(depth)
    for _ in range(3):
        if arm.force() > 8.0:
            arm.wiggle(2)
            arm.wiggle(-2)
            break
        arm.down(0.5)
