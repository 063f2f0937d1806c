"""Stack three boxes."""


def stack(arm, gripper, boxes=3):
    for layer in range(boxes):
        arm.home()
        gripper.close()
        arm.lift(0.3)
        arm.swing(90)
        arm.lift(0.1 * layer - 0.3)
        gripper.open()
        arm.lift(0.3)
    arm.home()
