def stack_cup(arm, cup):
    arm.above(cup)
    arm.down(0.2)
    arm.grasp()
    arm.down(-0.2)
