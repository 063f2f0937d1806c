class Gripper:
    def __init__(self, robot):
        self.robot = robot
        self.state = 0
        self.log = []

    def set(self, state):
        self.state = state
        self.log.append((state, self.robot.angles[0]))

    def feels(self):
        return self.state == 1 and self.robot.angles[1] == 0.5


class Robot:
    def __init__(self):
        self.angles = [0.0, 0.0, 0.0]
        self.gripper = Gripper(self)

    def joints(self, angles):
        self.angles = list(angles)
