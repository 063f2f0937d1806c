"""A UR arm takes parts from a feeder and stacks them on a pallet."""

HOME = [0.1, -1.57, 1.57, -1.57, -1.57, 0.2]
DOWN = [0.0, 3.14, 0.0]
GRIPPER = 0
PART_HEIGHT = 0.03


def carry(robot, place, closed):
    """Go to a place from above, and close or open the gripper there."""
    x, y, z = place
    robot.movel([x, y, z + 0.10, *DOWN], acc=0.5, vel=0.3)
    robot.movel([x, y, z, *DOWN], acc=0.2, vel=0.1)
    robot.set_digital_out(GRIPPER, closed)
    robot.up(0.10)


def palletise(robot, feeder, pallet, count):
    robot.set_tcp((0, 0, 0.12, 0, 0, 0))
    for layer in range(count):
        carry(robot, feeder, True)
        carry(robot, (pallet[0], pallet[1], pallet[2] + layer * PART_HEIGHT), False)
    robot.movej(HOME, acc=0.5, vel=0.5)
    return robot.getl(wait=True)
