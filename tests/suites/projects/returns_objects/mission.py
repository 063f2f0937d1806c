from robot import Pose


def tour(arm):
    """Visit two stations; the answer is where the arm was."""
    first = arm.move(Pose(0.3, 0.0))
    second = arm.move(Pose(first.x, 0.4))
    for pose in arm.scan(0.1):
        if pose.y > 0.45:
            arm.tool(True)
    return [first, second, arm.where()]
